/* `calibration stiffness`, `rescale` and `friction` from outside: two rods under a press by a known law, a simulated
 * series with a known stiffness, rods that slide by an equilibrium the test solves, forces that end at a known mu. */
#include "tests/commands.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "pipeline/packing/packing_file.h"
#include "tests/pressed_rods.h"
#include "pipeline/files/json.h"

/* ---- stiffness ---- */

static const struct pressed_rods RODS = {.scale = 6e-5, .radius_px = 48, .seed = 11};

/* Exact tracks of the rods in rows 0 and 1; the photos of `lost` miss the second one. */
static void write_rods(const char *lost)
{
    for (int k = 0; k < ROD_PHOTOS; k++) {
        struct photo_grains tracks = {0};
        struct provenance provenance = PROVENANCE_DEFAULT;
        char path[40], name[16];
        snprintf(path, sizeof path, "%02d.tracks.hdf", k);
        snprintf(name, sizeof name, "%02d", k);
        check_done(pressed_place(&RODS, k, &tracks));
        tracks.flags[1] = strstr(lost, name) ? GRAIN_LOST : 0;
        provenance.stage = "tracker", provenance.coordinates = "corrected";
        provenance.index = k, provenance.time_s = 2 * k;
        struct state_writer *writer = state_create(path, &provenance);
        assert_non_null(writer);
        check_done(state_write(writer, "grains", &PHOTO_GRAINS, &tracks));
        check_done(state_commit(writer));
        table_free(&PHOTO_GRAINS, &tracks);
    }
}

/* Force over the photos' time, from a clock that is `ahead`; or over their index. */
static void write_record(const char *path, int by_index, double ahead)
{
    FILE *file = fopen(path, "w");
    assert_non_null(file);
    fprintf(file, "%s,force_N\n", by_index ? "index" : "time_s");
    for (int k = 0; k < ROD_PHOTOS; k++)
        fprintf(file, "%.17g,%.17g\n", by_index ? k : 2 * k + ahead, pressed_force(k));
    fclose(file);
}

static void check_law(const cJSON *object)
{
    const struct pressed_law *law = &PRESSED_LAW;
    assert_string_equal(json_text_at(object, "phases.0.kind"), "loading");
    assert_string_equal(json_text_at(object, "phases.1.kind"), "unloading");
    assert_string_equal(json_text_at(object, "phases.2.kind"), "reloading");
    check_near(json_at(object, "kn_N_per_m") / (0.5 * (law->k_high + law->again_high)), 1, 1e-6);
    check_near(json_at(object, "half_spread_N_per_m") / (0.5 * (law->again_high - law->k_high)), 1, 1e-4);
    check_near(json_at(object, "unloading_N_per_m") / law->k_back, 1, 1e-6);
    check_near(json_at(object, "phases.0.k_low_N_per_m") / law->k_low, 1, 1e-6);
    check_near(json_at(object, "phases.0.k_high_N_per_m") / law->k_high, 1, 1e-6);
    check_near(json_at(object, "phases.0.break_N"), law->at, 1e-3);
    check_near(json_at(object, "phases.2.break_N"), law->again_at, 1e-2);
    check_near(json_at(object, "phases.1.k_line_N_per_m") / law->k_back, 1, 1e-6);
    assert_true(isnan(json_at(object, "phases.1.break_N")) && isnan(json_at(object, "phases.3.points")));
    check_near(json_at(object, "phases.0.last_index"), ROD_UP - 1, 0);
    check_near(json_at(object, "phases.0.force_N.1"), 1000, 1e-9);
    for (int k = 0; k < ROD_PHOTOS; k++) {
        check_near(json_at(object, "points.%d.force_N", k), pressed_force(k), 1e-9);
        check_near(json_at(object, "points.%d.deflection_m", k), pressed_deflection(k), 1e-15);
    }
}

/* The markers of each phase stand where force and deflection put them: one straight map for all. */
static void check_dots(const cJSON *object)
{
    static const char *const colours[] = {"rgb(0%,44.7", "rgb(83.5%,36.9", "rgb(0%,62%"};
    static const double begins[][2] = {{3.5, 0}, {-3.5, -3.5}, {0, -4.2}}; /* of a disc, a square, a triangle */
    char *svg = check_svg("rods.svg");
    double scale[2] = {0}, origin[2] = {0};
    for (int p = 0; p < 3; p++) {
        struct svg_point dots[ROD_PHOTOS + 1];
        int first = (int)json_at(object, "phases.%d.first_index", p);
        int last = (int)json_at(object, "phases.%d.last_index", p);
        assert_int_equal(svg_fills(svg, colours[p], dots, ROD_PHOTOS + 1), last - first + 1 + 1); /* with the key */
        for (int k = first; k <= last; k++) {
            double place[2] = {dots[k - first].x - begins[p][0], dots[k - first].y - begins[p][1]};
            double value[2] = {1e6 * pressed_deflection(k), pressed_force(k)};
            for (int a = 0; a < 2; a++) {
                if (p == 0 && k == 0)
                    origin[a] = place[a]; /* no force, no deflection */
                else if (p == 0 && k == ROD_UP - 1)
                    scale[a] = (place[a] - origin[a]) / value[a];
                else if (p > 0)
                    check_near(place[a], origin[a] + scale[a] * value[a], 0.02);
            }
        }
    }
    assert_true(scale[0] > 0 && scale[1] < 0);
    assert_int_equal(text_count(svg, ">loading<") + text_count(svg, ">unloading<") + text_count(svg, ">reloading<"), 3);
    assert_int_equal(text_count(svg, ">Two rods pressed together<"), 1);
    free(svg);
}

#define STIFFNESS "calibration stiffness --scene scene.json --record "

static void pressed_rods_give_their_law(void **state)
{
    (void)state;
    static const char *const records[] = {"index.csv", "time.csv", "late.csv --delay 3600"};
    file_write("scene.json", "{\"schema\": \"film.scene/1\", \"name\": \"two rods\", \"scale_m_per_px\": 6e-5}");
    write_rods("");
    write_record("index.csv", 1, 0);
    write_record("time.csv", 0, 0);
    write_record("late.csv", 0, 3600);
    for (int k = 0; k < 3; k++) {
        command_done(STIFFNESS "%s --rods 1,0 --force-error 0.01 --picture rods.svg -o rods.json ??.tracks.hdf",
                     records[k]);
        cJSON *object = json_of("rods.json", "film.stiffness/1");
        check_law(object);
        check_dots(object);
        cJSON_Delete(object);
    }
}

static void lost_photos_keep_their_rows(void **state)
{
    (void)state;
    write_rods("05 06 30");
    command_fails(4, "3 of 40 photos were not used", STIFFNESS "index.csv -o lost.json ??.tracks.hdf");
    cJSON *object = json_of("lost.json", "film.stiffness/1");
    assert_false(json_is(object, "points.5.used") || json_is(object, "points.30.used"));
    assert_true(json_is(object, "points.7.used") && isnan(json_at(object, "points.5.deflection_m")));
    check_near(json_at(object, "phases.0.points"), ROD_UP - 2, 0);
    check_near(json_at(object, "kn_N_per_m") / (0.5 * (PRESSED_LAW.k_high + PRESSED_LAW.again_high)), 1, 1e-6);
    cJSON_Delete(object);
    write_rods("");
}

static void wrong_presses_are_refused(void **state)
{
    (void)state;
    static const char *const records[][2] = {
        {"force,time\n0,1\n", "r.csv:1: the header is"},
        {"index,force_N\n0,1\n2;3\n", "r.csv:3: write two numbers, index,force_N"},
        {"time_s,force_N\n0,one\n", "r.csv:2: write two numbers, time_s,force_N"},
        {"index,force_N\n1,1\n1,2\n", "r.csv:3: 1 comes after 1"},
        {"index,force_N\n1,1\n", "r.csv: 1 row: a record needs two or more"},
        {"index,force_N\n100,1\n200,2\n", "photos 0 to 39, record 100 to 200"},
        {"index,force_N\n0,5\n39,5\n", ""},
        {"index,force_N\n0,1000\n39,0\n", ""},
    };
    for (size_t k = 0; k < sizeof records / sizeof *records; k++) {
        file_write("r.csv", records[k][0]);
        command_fails(3, records[k][1], STIFFNESS "r.csv -o no.json ??.tracks.hdf");
    }
    file_write("bare.json", "{\"schema\": \"film.scene/1\", \"name\": \"no scale\"}");
    command_fails(3, "missing.csv", STIFFNESS "missing.csv -o no.json ??.tracks.hdf");
    command_fails(3, "scale_m_per_px",
                  "calibration stiffness --scene bare.json --record index.csv -o no.json ??.tracks.hdf");
    command_fails(3, "rod 5: photo 0 has 2 grains", STIFFNESS "index.csv --rods 0,5 -o no.json ??.tracks.hdf");
    command_fails(3, "usable photo", STIFFNESS "index.csv -o no.json 00.tracks.hdf");
    command_fails(3, "missing.hdf", STIFFNESS "index.csv -o no.json missing.hdf");
    command_fails(2, "--rods 1,1", STIFFNESS "index.csv --rods 1,1 -o no.json ??.tracks.hdf");
    command_fails(2, "which photos?", STIFFNESS "index.csv -o no.json");
    command_fails(2, "with --record", "calibration stiffness --scene scene.json -o no.json 00.tracks.hdf");
    assert_false(file_exists("no.json"));
}

/* ---- rescale ---- */

static const double KN = 2.3e7, RATIO = 0.6;

static void write_series_scene(const char *path, const char *contact)
{
    char text[900];
    snprintf(
        text, sizeof text,
        "{\"schema\": \"film.scene/1\", \"name\": \"sixty discs\", \"grains\": {\"density_kg_m3\": 730}, \"contact\": "
        "{%s}, \"simulation\": {\"grading\": [[36, 0.008], [24, 0.012]], \"kappa\": 300, "
        "\"friction_during_compression\": 0.1, \"test\": \"biaxial_vertical\", \"steps\": [[6, 4e-4]]}}",
        contact);
    file_write(path, text);
}

#define LINEAR "\"law\": \"linear\", \"kn_N_per_m\": 2.3e7, \"kt_over_kn\": 0.6, \"mu\": 0.5"
#define RESCALE "calibration rescale --scene series.json -o rescaled.json "

/* The stress on the walls of the first state: their loads over the sides that they press on. */
static void wall_stress(double *sxx, double *syy)
{
    struct packing packing;
    check_done(packing_read("truth/0000.truth.hdf", &packing));
    const struct walls *w = &packing.walls;
    long right = walls_find(w, "right"), left = walls_find(w, "left"), top = walls_find(w, "top");
    long bottom = walls_find(w, "bottom");
    *sxx = -w->fx[right] / (w->y0[top] - w->y0[bottom]);
    *syy = -w->fy[top] / (w->x0[right] - w->x0[left]);
    packing_free(&packing);
}

static void a_simulated_series_gives_its_stiffness(void **state)
{
    (void)state;
    double sxx, syy;
    write_series_scene("series.json", LINEAR);
    command_done("simulate --quiet --scene series.json -o truth");
    wall_stress(&sxx, &syy);
    command_done(RESCALE "truth/*.truth.hdf");
    cJSON *object = json_of("rescaled.json", "film.rescale/1");
    check_near(json_at(object, "kn_N_per_m") / KN, 1, 0.03); /* tangential forces of the first state are not known */
    check_near(json_at(object, "kt_over_kn"), RATIO, 1e-12);
    assert_true(isnan(json_at(object, "s_kt_over_kn")));
    cJSON_Delete(object);

    /* The exact forces are scaled by 1. */
    command_done(RESCALE "--method dem --picture stress.svg truth/*.truth.hdf");
    object = json_of("rescaled.json", "film.rescale/1");
    check_near(json_at(object, "stress_ratio"), 1, 1e-5);
    check_near(json_at(object, "kn_N_per_m") / KN, 1, 1e-5);
    check_near(json_at(object, "rms_left_over"), 0, 1e-5);
    check_near(json_at(object, "states.0.measured.xx") / sxx, 1, 1e-6); /* rest to 1e-7 */
    check_near(json_at(object, "states.0.measured.yy") / syy, 1, 1e-6);
    check_near(json_at(object, "states.0.weber.yy") / syy, 1, 1e-5);
    check_near(json_at(object, "states.6.index"), 6, 0);
    cJSON_Delete(object);
    char *svg = check_svg("stress.svg");
    struct svg_point dots[10];
    assert_int_equal(svg_fills(svg, "rgb(0%,44.7", dots, 10), 7 + 1); /* with the key */
    assert_int_equal(svg_fills(svg, "rgb(83.5%,36.9", dots, 10), 7 + 1);
    assert_int_equal(svg_fills(svg, "rgb(0%,62%", dots, 10), 7 + 1);
    assert_int_equal(text_count(svg, ">xx<") + text_count(svg, ">yy<") + text_count(svg, ">xy<"), 3);
    free(svg);
}

static void the_tangential_stiffness_is_sought_too(void **state)
{
    (void)state;
    write_series_scene("unknown.json", "\"law\": \"linear\", \"mu\": 0.5");
    command_done("calibration rescale --scene unknown.json -o both.json --tangential --increments truth/*.truth.hdf");
    cJSON *object = json_of("both.json", "film.rescale/1");
    check_near(json_at(object, "kn_N_per_m") / KN, 1, 0.05);
    check_near(json_at(object, "kt_over_kn"), RATIO, 0.15);
    assert_true(json_at(object, "s_kt_over_kn") > 0);
    check_near(json_at(object, "states.0.measured.xx"), json_at(object, "states.0.measured.xx"), 0);
    cJSON_Delete(object);
}

static void series_without_an_answer_are_refused(void **state)
{
    (void)state;
    write_series_scene("hertz.json", "\"law\": \"hertz_pfc\", \"young_Pa\": 1e9, \"poisson\": 0.2, \"mu\": 0.5");
    file_write("bare.json", "{\"schema\": \"film.scene/1\", \"name\": \"no contact\"}");
    command_fails(2, "which series?", "calibration rescale --scene series.json -o no.json");
    command_fails(2, "--tangential needs contacts files",
                  "calibration rescale --scene series.json --method dem --tangential -o no.json truth/0000.truth.hdf");
    command_fails(3, "hertz.json: contact.law", "calibration rescale --scene hertz.json -o no.json truth/*.truth.hdf");
    command_fails(3, "contact.mu", "calibration rescale --scene bare.json -o no.json truth/*.truth.hdf");
    command_fails(3, "no forces of method 'qsm'",
                  "calibration rescale --scene series.json --method qsm -o no.json truth/*.truth.hdf");
    command_fails(3, "1 state: give two or more",
                  "calibration rescale --scene series.json --increments -o no.json truth/0000.truth.hdf");
    command_fails(3, "missing.hdf", "calibration rescale --scene series.json -o no.json missing.hdf");
    assert_false(file_exists("no.json"));
}

/* ---- friction ---- */

/* Rod C at sliding under P1 + P2 = W at the arms L: the normal force on the side of P2 is 1, the other one follows from
 * the horizontal balance, the weights from the vertical one and from the moments. */
static void slide(double mu, double alpha, double arm, double radius, double *p1, double *p2)
{
    double s = sin(alpha), c = cos(alpha), other = (s - mu * c) / (s + mu * c);
    double weight = (1 + other) * c + mu * (1 - other) * s, difference = mu * (1 + other) * radius / arm;
    *p1 = 0.5 * (weight - difference);
    *p2 = 0.5 * (weight + difference);
}

static void sliding_rods_give_their_friction(void **state)
{
    (void)state;
    const double degree = 3.141592653589793 / 180, mu[2] = {0.35, 0.41};
    char words[2][200];
    for (int k = 0; k < 2; k++) {
        double p1, p2, alpha = k ? 50 : 40, arm = 0.03, radius = 0.02;
        slide(mu[k], alpha * degree, arm, radius, &p1, &p2);
        snprintf(words[k], sizeof words[k], "%.17g,%.17g,%g,%g,%g", p1, p2, arm, radius, alpha);
    }
    command_done("calibration friction %s -o mu.json", words[0]);
    assert_string_equal(command_err, "calibration friction: mu 0.35\n");
    cJSON *object = json_of("mu.json", "film.friction/1");
    check_near(json_at(object, "mu"), mu[0], 1e-12);
    check_near(json_at(object, "phi_rad"), atan(mu[0]), 1e-12);
    assert_true(isnan(json_at(object, "s_mu")));
    cJSON_Delete(object);
    command_done("calibration friction %s %s -o mu.json", words[0], words[1]);
    object = json_of("mu.json", "film.friction/1");
    double phi = 0.5 * (atan(mu[0]) + atan(mu[1])), s_phi = 0.5 * (atan(mu[1]) - atan(mu[0]));
    check_near(json_at(object, "tests"), 2, 0);
    check_near(json_at(object, "mu"), tan(phi), 1e-12);
    check_near(json_at(object, "s_phi_rad"), s_phi, 1e-9);
    check_near(json_at(object, "s_mu"), (1 + tan(phi) * tan(phi)) * s_phi, 1e-9);
    cJSON_Delete(object);
}

static void wrong_tests_are_refused(void **state)
{
    (void)state;
    command_fails(2, "which test?", "calibration friction -o no.json");
    command_fails(3, "test '3,7': give five numbers", "calibration friction 3,7 -o no.json");
    command_fails(3, "test 2: weights, arm and radius",
                  "calibration friction 3,7.4,0.03,0.02,45 3,7,0.03,0,45 -o no.json");
    command_fails(3, "alpha is 95 deg", "calibration friction 3,7.4,0.03,0.02,95 -o no.json");
    command_fails(3, "sin 2 phi would be", "calibration friction 1,9,0.09,0.02,45 -o no.json");
    command_fails(3, "a contact opened before the rod slid", "calibration friction 3,4,0.03,0.02,2 -o no.json");
    assert_false(file_exists("no.json"));
}

enum { CHAIN = 400, SLIDING = 80 };

/* A row of grains whose contacts have |ft| / fn even over 0 to `most`, thinning out to the end when `fades`, and every
 * fifth one at `most` exactly (not when it fades); the contact with the wall has its own friction. */
static void write_chain(const char *path, double most, int fades, double mu)
{
    struct packing p = {.length_m = NAN};
    struct provenance provenance = PROVENANCE_DEFAULT;
    check_done(table_alloc(&GRAINS, &p.grains, CHAIN + 1, NULL) || table_alloc(&WALLS, &p.walls, 1, NULL) ||
               table_alloc(&CONTACTS, &p.contacts, CHAIN + 1, NULL));
    p.forces = calloc(1, sizeof *p.forces), p.force_count = 1;
    assert_non_null(p.forces);
    strcpy(p.forces->method, "map");
    p.forces->mu = mu;
    check_done(table_alloc(&CONTACT_FORCES, &p.forces->contact, CHAIN + 1, NULL));
    for (int k = 0; k <= CHAIN; k++) {
        int wall = k == CHAIN;
        double even = (k + 0.5) / CHAIN, ratio = fades ? most * (1 - sqrt(1 - even)) : k % 5 ? most * even : most;
        p.grains.x[k] = 0.02 * k, p.grains.y[k] = 0, p.grains.radius[k] = 0.01;
        p.grains.mass[k] = p.grains.inertia[k] = 1;
        p.contacts.i[k] = k, p.contacts.j[k] = k + 1;
        p.contacts.nx[k] = 1, p.contacts.ny[k] = 0, p.contacts.x[k] = 0.02 * k + 0.01, p.contacts.y[k] = 0;
        p.contacts.overlap[k] = 1e-5, p.contacts.flags[k] = wall ? CONTACT_WALL : 0;
        p.forces->contact.fn[k] = 100;
        p.forces->contact.ft[k] = wall ? 300 : (k % 2 ? -100 : 100) * ratio;
    }
    strcpy(p.walls.name[0], "right");
    p.walls.x0[0] = p.walls.x1[0] = 0.02 * CHAIN + 0.01, p.walls.y0[0] = -1, p.walls.y1[0] = 1, p.walls.radius[0] = 0;
    provenance.stage = "forces", provenance.coordinates = "si";
    check_done(packing_write(path, &p, &provenance));
    packing_free(&p);
}

static void forces_end_at_their_friction(void **state)
{
    (void)state;
    write_chain("sliding.hdf", 0.37, 0, 2);
    write_chain("known.hdf", 0.37, 0, 0.37);
    write_chain("fading.hdf", 2, 1, 4);
    command_done("calibration friction --forces map sliding.hdf sliding.hdf -o forces.json");
    cJSON *object = json_of("forces.json", "film.friction/1");
    check_near(json_at(object, "mu"), 0.37, 1e-15);
    check_near(json_at(object, "contacts"), 2 * CHAIN, 0); /* without the walls' */
    assert_true(json_at(object, "sliding") >= 2 * SLIDING);
    check_near(json_at(object, "s_mu"), json_at(object, "width") / json_at(object, "sliding"), 1e-12);
    /* A share of 4/5 is even over 0 to mu, the rest is at mu. */
    check_near(json_at(object, "quantiles_10_50_90_95_99.0"), 0.37 * 0.1 / 0.8, 0.005);
    check_near(json_at(object, "quantiles_10_50_90_95_99.1"), 0.37 * 0.5 / 0.8, 0.005);
    check_near(json_at(object, "quantiles_10_50_90_95_99.2"), 0.37, 1e-15);
    cJSON_Delete(object);
    command_fails(3, "inferred with mu = 0.37", "calibration friction --forces map known.hdf -o no.json");
    command_fails(3, "400 contacts, and |ft| / fn ends nowhere sharply",
                  "calibration friction --forces map fading.hdf -o no.json");
    command_fails(3, "sliding.hdf: no forces of method 'qsm'",
                  "calibration friction --forces qsm sliding.hdf -o no.json");
    command_fails(3, "missing.hdf", "calibration friction --forces map missing.hdf -o no.json");
    assert_false(file_exists("no.json"));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(pressed_rods_give_their_law),
        cmocka_unit_test(lost_photos_keep_their_rows),
        cmocka_unit_test(wrong_presses_are_refused),
        cmocka_unit_test(a_simulated_series_gives_its_stiffness),
        cmocka_unit_test(the_tangential_stiffness_is_sought_too),
        cmocka_unit_test(series_without_an_answer_are_refused),
        cmocka_unit_test(sliding_rods_give_their_friction),
        cmocka_unit_test(wrong_tests_are_refused),
        cmocka_unit_test(forces_end_at_their_friction),
    };
    return cmocka_run_group_tests(tests, folder_enter, folder_leave);
}
