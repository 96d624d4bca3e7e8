/* `calibration settlement` from outside: tracks whose trend the test has drawn, the states of a simulated cyclic test,
 * and the loop that jumps over cycles beside the one that simulates them all. */
#include "tests/commands.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "pipeline/packing/packing_file.h"
#include "pipeline/files/json.h"

/* ---- tracked ---- */

enum { GRAINS_COUNT = 5, CYCLES = 6, PER_CYCLE = 2, PHOTOS = CYCLES * PER_CYCLE + 1, FIRST = 3 };
static const double SCALE = 2e-4; /* m/px */

/* px: what grain k makes of ln t in x and y (down), and how far it swings in the middle of a cycle. */
static const double LOG_X[] = {1.5, -0.7, 0, 2.2, 0.3}, LOG_Y[] = {4, 3.5, 2, -1, 6}, SWING[] = {0.5, 1, 0, 2, 0.25};
/* px: what every other cycle takes back. */
static const double WOBBLE = 0.3;

/* Where grain k is at the end of cycle t, or in the middle of the one before: the chord's middle, and the swing. */
static void place(int k, double t, double wobble, double *x, double *y)
{
    double whole = floor(t), way[2][2];
    for (int e = 0; e < 2; e++) {
        double end = whole + e, shake = wobble * (fmod(end, 2) ? 1 : -1);
        way[e][0] = 100 + 60 * k + LOG_X[k] * log(end) + shake;
        way[e][1] = 80 + 20 * k + LOG_Y[k] * log(end) + shake;
    }
    int middle = t > whole;
    *x = middle ? 0.5 * (way[0][0] + way[1][0]) + 0.6 * SWING[k] : way[0][0];
    *y = middle ? 0.5 * (way[0][1] + way[1][1]) - 0.8 * SWING[k] : way[0][1];
}

static void write_photo(const char *path, int photo, int grains, double wobble, int lost)
{
    static const char *const names[] = {"x_px", "y_px", "radius_px", "flags", NULL};
    struct photo_grains tracks = {0};
    struct provenance provenance = PROVENANCE_DEFAULT;
    check_done(table_alloc(&PHOTO_GRAINS, &tracks, (size_t)grains, names));
    for (int k = 0; k < grains; k++) {
        place(k, FIRST + (double)photo / PER_CYCLE, wobble, &tracks.x_px[k], &tracks.y_px[k]);
        tracks.radius_px[k] = 20;
        tracks.flags[k] = k == lost ? GRAIN_LOST : 0;
    }
    provenance.stage = "tracker", provenance.coordinates = "corrected", provenance.index = photo;
    struct state_writer *writer = state_create(path, &provenance);
    assert_non_null(writer);
    check_done(state_write(writer, "grains", &PHOTO_GRAINS, &tracks));
    check_done(state_commit(writer));
    table_free(&PHOTO_GRAINS, &tracks);
}

static void write_series(double wobble, int lost)
{
    for (int photo = 0; photo < PHOTOS; photo++) {
        char path[40];
        snprintf(path, sizeof path, "%02d.tracks.hdf", photo);
        write_photo(path, photo, GRAINS_COUNT, wobble, photo == 4 ? lost : -1);
    }
}

static double of_grain(const cJSON *object, int k, const char *key)
{
    return json_at(object, "grains.%d.%s", k, key);
}

#define SCENE "--scene scene.json --per-cycle 2 --first 3 "

/* a ln t is what the command fits: it must find every number again. */
static void a_drawn_trend_is_found(void **state)
{
    (void)state;
    const double last = FIRST + CYCLES, ahead = 30;
    file_write("scene.json", "{\"schema\": \"film.scene/1\", \"name\": \"cycles\", \"scale_m_per_px\": 2e-4}");
    write_series(0, -1);
    command_done("calibration settlement " SCENE "--ahead 30 -o log.json ??.tracks.hdf");
    cJSON *object = json_of("log.json", "film.settlement/1");
    assert_string_equal(json_text_at(object, "trend"), "log");
    check_near(json_at(object, "cycles"), CYCLES, 0);
    assert_true(isnan(json_at(object, "held_out_error"))); /* 30 cycles cannot be held out of 6 */
    for (int k = 0; k < GRAINS_COUNT; k++) {
        assert_true(json_is(object, "grains.%d.used", k));
        check_near(of_grain(object, k, "residual_x_m"), SCALE * LOG_X[k] * log(last / FIRST), 1e-15);
        check_near(of_grain(object, k, "residual_y_m"), -SCALE * LOG_Y[k] * log(last / FIRST), 1e-15);
        check_near(of_grain(object, k, "a_x_m"), SCALE * LOG_X[k], 1e-14);
        check_near(of_grain(object, k, "a_y_m"), -SCALE * LOG_Y[k], 1e-14);
        check_near(of_grain(object, k, "ahead_x_m"), SCALE * LOG_X[k] * log((last + ahead) / FIRST), 1e-14);
        check_near(of_grain(object, k, "ahead_y_m"), -SCALE * LOG_Y[k] * log((last + ahead) / FIRST), 1e-14);
        check_near(of_grain(object, k, "reversible_m"), SCALE * SWING[k], 1e-14);
        check_near(of_grain(object, k, "rms_m"), 0, 1e-15);
    }
    cJSON_Delete(object);
    command_done("calibration settlement " SCENE "--ahead 2 -o held.json ??.tracks.hdf");
    object = json_of("held.json", "film.settlement/1");
    check_near(json_at(object, "held_out_error"), 0, 1e-10);
    cJSON_Delete(object);
}

/* Every other cycle steps back: a line through the ends leaves over what ln t bends and the wobble; the bound follows
 * from the extremes of that. */
static void the_bound_follows_from_what_is_left(void **state)
{
    (void)state;
    const double error = 1e-5, probability = 0.01;
    double cycles[2 * GRAINS_COUNT], median = 0, largest = 0;
    write_series(WOBBLE, -1);
    command_done("calibration settlement " SCENE "--trend linear --error 1e-5 --probability 0.01 -o linear.json "
                 "??.tracks.hdf");
    for (int v = 0; v < 2 * GRAINS_COUNT; v++) {
        double u[CYCLES + 1], low = 0, high = 0, slope = (v % 2 ? LOG_Y : LOG_X)[v / 2];
        for (int c = 0; c <= CYCLES; c++)
            u[c] = SCALE * (slope * log(FIRST + c) + WOBBLE * ((FIRST + c) % 2 ? 1 : -1));
        for (int c = 1; c <= CYCLES; c++) {
            double rest = u[c] - u[0] - (u[CYCLES] - u[0]) * c / CYCLES;
            low = fmin(low, rest), high = fmax(high, rest);
        }
        cycles[v] = ceil(pow(high - low, 2) / (2 * error * error) * log(2 / probability));
    }
    for (int v = 0; v < 2 * GRAINS_COUNT; v++) {
        int below = 0;
        for (int w = 0; w < 2 * GRAINS_COUNT; w++)
            below += cycles[w] < cycles[v];
        median = below <= GRAINS_COUNT ? fmax(median, cycles[v]) : median;
        largest = fmax(largest, cycles[v]);
    }
    cJSON *object = json_of("linear.json", "film.settlement/1");
    check_near(json_at(object, "chernoff_cycles_median"), median, 1);
    check_near(json_at(object, "chernoff_cycles_largest"), largest, 1);
    assert_true(largest > median && median > 100);
    check_near(of_grain(object, 3, "b_x_m"), SCALE * LOG_X[3] * log(3) / CYCLES, 1e-15); /* 9 / 3, both ends odd */
    check_near(of_grain(object, 3, "a_x_m"), 0, 0);
    cJSON_Delete(object);
}

static void a_lost_grain_keeps_its_row(void **state)
{
    (void)state;
    write_series(0, 2);
    command_fails(4, "1 of 5 grains were lost at the end of a cycle",
                  "calibration settlement " SCENE "-o lost.json ??.tracks.hdf");
    command_done("calibration settlement " SCENE "--max-flagged 0.2 --trend logarithmic -o lost.json ??.tracks.hdf");
    cJSON *object = json_of("lost.json", "film.settlement/1");
    for (int k = 0; k < GRAINS_COUNT; k++)
        assert_int_equal(json_is(object, "grains.%d.used", k), k != 2);
    check_near(of_grain(object, 4, "a_y_m"), -SCALE * LOG_Y[4], 1e-12);
    check_near(of_grain(object, 4, "b_y_m"), 0, 1e-12);
    cJSON_Delete(object);
}

static void what_is_no_series_is_refused(void **state)
{
    (void)state;
    write_photo("four.tracks.hdf", 0, 4, 0, -1);
    file_write("bare.json", "{\"schema\": \"film.scene/1\", \"name\": \"no scale\"}");
    command_fails(2, "give the files of a cyclic test", "calibration settlement -o no.json");
    command_fails(2, "give one of: linear, logarithmic, log", "calibration settlement --trend cubic -o no.json");
    command_fails(2, "--probability 1", "calibration settlement --probability 1 -o no.json 00.tracks.hdf");
    command_fails(3, "00.tracks.hdf: a tracks file is in px", "calibration settlement -o no.json 00.tracks.hdf");
    command_fails(3, "1 photo, 2 per cycle", "calibration settlement " SCENE "-o no.json 00.tracks.hdf");
    command_fails(3, "four.tracks.hdf: 4 grains, 00.tracks.hdf has 5",
                  "calibration settlement " SCENE "-o no.json 00.tracks.hdf four.tracks.hdf");
    command_fails(3, "missing.hdf", "calibration settlement " SCENE "-o no.json 00.tracks.hdf missing.hdf");
    command_fails(3, "00.tracks.hdf: a tracks file is in px: give",
                  "calibration settlement --scene bare.json -o no.json ??.tracks.hdf");
    assert_false(file_exists("no.json"));
}

/* ---- simulated ---- */

enum { RUN = 8 }; /* cycles */

static const char CYCLIC[] =
    "{\"schema\": \"film.scene/1\", \"name\": \"cycles\", \"grains\": {\"density_kg_m3\": 730, \"length_m\": 0.06}, "
    "\"contact\": {\"law\": \"linear\", \"kn_N_per_m\": 1e7, \"kt_over_kn\": 0.8, \"mu\": 0.5}, \"simulation\": "
    "{\"grading\": [[14, 0.008], [10, 0.012]], \"kappa\": 500, \"friction_during_compression\": 0.3, \"test\": "
    "\"cyclic\", \"stress_amplitude\": 0.6, \"lateral\": \"fixed\", \"cycles\": [[8, 1]], \"tolerance\": 1e-6}}";

/* What `simulate` makes of the same scene, state by state: height of the box, and a grain's place. */
static double height[RUN + 1], grain_y[RUN + 1];

static void read_truth(void)
{
    for (int c = 0; c <= RUN; c++) {
        struct packing packing;
        char path[40];
        snprintf(path, sizeof path, "truth/%04d.truth.hdf", c);
        check_done(packing_read(path, &packing));
        long top = walls_find(&packing.walls, "top"), bottom = walls_find(&packing.walls, "bottom");
        assert_true(top >= 0 && bottom >= 0);
        height[c] = packing.walls.y0[top] - packing.walls.y0[bottom];
        grain_y[c] = packing.grains.y[7];
        packing_free(&packing);
    }
}

static double settled(int c)
{
    return height[0] - height[c];
}

static void the_states_of_a_simulation_are_read(void **state)
{
    (void)state;
    file_write("cyclic.json", CYCLIC);
    command_done("simulate --quiet --scene cyclic.json -o truth");
    read_truth();
    command_done("calibration settlement --max-flagged 1 --ahead 3 -o states.json truth/*.truth.hdf");
    cJSON *object = json_of("states.json", "film.settlement/1");
    check_near(json_at(object, "cycles"), RUN, 0);
    check_near(of_grain(object, 7, "residual_y_m"), grain_y[RUN] - grain_y[0], 1e-15);
    check_near(of_grain(object, 7, "reversible_m"), 0, 0); /* one file per cycle shows none */
    cJSON_Delete(object);
}

/* Height promised from the ends of cycles `from` to 4 for cycle 6: c + a ln t by least squares, or the mean step. */
static double promise(int linear)
{
    enum { FROM = 2, TO = 4 };
    double l = 0, u = 0, ll = 0, lu = 0;
    for (int c = FROM; c <= TO; c++)
        l += log(c) / 3, u += settled(c) / 3;
    for (int c = FROM; c <= TO; c++)
        ll += pow(log(c) - l, 2), lu += (log(c) - l) * (settled(c) - u);
    return settled(TO) + (linear ? settled(TO) - settled(FROM) : lu / ll * log(6.0 / TO));
}

/* Cycles 0 to 4 are simulated, 5 and 6 jumped over, 7 and 8 simulated. */
static void check_jump(const cJSON *run, int linear)
{
    static const int cycles[] = {0, 1, 2, 3, 4, 6, 7, 8};
    double before = json_at(run, "jumps.0.before_m"), promised = json_at(run, "jumps.0.promised_m");
    check_near(json_at(run, "simulated_cycles"), 6, 0);
    check_near(json_at(run, "height_m") / height[0], 1, 1e-12);
    for (int k = 0; k < 8; k++) {
        check_near(json_at(run, "cycle.%d", k), cycles[k], 0);
        if (k < 5)
            check_near(json_at(run, "settlement_m.%d", k), settled(k), 1e-12 * height[0]);
    }
    assert_true(isnan(json_at(run, "cycle.8")));
    check_near(json_at(run, "jumps.0.to_cycle"), 6, 0);
    assert_true(isnan(json_at(run, "jumps.1.to_cycle")));
    check_near(before, settled(4), 1e-12 * height[0]);
    check_near(promised, promise(linear), 1e-10 * height[0]);
    check_near(json_at(run, "jumps.0.arrived_m"), json_at(run, "settlement_m.5"), 0);
}

static void cycles_are_jumped_over(void **state)
{
    (void)state;
    command_done("calibration settlement --quiet --max-flagged 1 --scene cyclic.json --initial 2 --train 2 --ahead 2 "
                 "--cycles 8 --full --picture loop.svg -o loop.json");
    cJSON *object = json_of("loop.json", "film.settlement/1"), *quick = cJSON_GetObjectItem(object, "extrapolated");
    cJSON *full = cJSON_GetObjectItem(object, "full");
    check_jump(quick, 0);
    check_near(json_at(full, "simulated_cycles"), RUN, 0);
    for (int c = 0; c <= RUN; c++)
        check_near(json_at(full, "settlement_m.%d", c), settled(c), 1e-12 * height[0]);
    check_near(json_at(object, "settlement_error"), json_at(quick, "settlement_m.7") / settled(RUN) - 1, 1e-9);
    check_near(json_at(object, "gained"), json_at(full, "steps") / json_at(quick, "steps") - 1, 1e-12);
    assert_true(json_at(object, "position_error") > 0);
    check_at_most(json_at(object, "position_error"), json_at(object, "displacement_error"));
    cJSON_Delete(object);
    char *svg = check_svg("loop.svg");
    struct svg_point dots[20]; /* settlement and coordination of 8 cycles, and the keys */
    assert_int_equal(svg_fills(svg, "rgb(0%,44.7", dots, 20), 2 * (8 + 1));
    assert_int_equal(text_count(svg, "stroke:rgb(83.5%,36.9%,0%)"), 2 * (1 + 1)); /* what was simulated */
    assert_int_equal(text_count(svg, ">every cycle simulated<"), 2);
    free(svg);
    command_done("calibration settlement --quiet --max-flagged 1 --scene cyclic.json --initial 2 --train 2 --ahead 2 "
                 "--cycles 8 --trend linear --free-contacts -o free.json");
    object = json_of("free.json", "film.settlement/1");
    check_jump(cJSON_GetObjectItem(object, "extrapolated"), 1);
    assert_null(cJSON_GetObjectItem(object, "full"));
    cJSON_Delete(object);
}

/* Four hundred cycles at the pace of the last two drive grains into each other: they are parted, once. */
static void a_jump_too_far_is_parted(void **state)
{
    (void)state;
    command_done("calibration settlement --quiet --max-flagged 1 --scene cyclic.json --initial 2 --train 2 --ahead 400 "
                 "--cycles 405 --trend linear --free-contacts -o far.json");
    cJSON *object = json_of("far.json", "film.settlement/1"), *run = cJSON_GetObjectItem(object, "extrapolated");
    check_near(json_at(run, "simulated_cycles"), 5, 0);
    check_near(json_at(run, "jumps.0.to_cycle"), 404, 0);
    check_near(json_at(run, "jumps.0.promised_m"), settled(4) + 200 * (settled(4) - settled(2)), 1e-8 * height[0]);
    check_near(json_at(run, "partings"), 1, 0);
    double before = json_at(run, "largest_overlap_before_parting_m");
    assert_true(before > 1e-4); /* at kappa 500 grains of 4 and 6 mm overlap by some 1e-5 m */
    check_at_most(json_at(run, "largest_overlap_after_parting_m"), before);
    check_near(json_at(run, "cycle.6"), 405, 0);
    cJSON_Delete(object);
}

static void loops_that_make_no_sense_are_refused(void **state)
{
    (void)state;
    char *still = strdup(CYCLIC);
    memcpy(strstr(still, "\"cyclic\", \"stress_amplitude\": 0.6, \"lateral\": \"fixed\", \"cycles\": [[8, 1]]"),
           "\"oedometer\", \"steps\": [[1, 1e-4]]                                                    ",
           strlen("\"cyclic\", \"stress_amplitude\": 0.6, \"lateral\": \"fixed\", \"cycles\": [[8, 1]]"));
    file_write("still.json", still);
    free(still);
    command_fails(3, "settlement needs simulation.test \"cyclic\"",
                  "calibration settlement --scene still.json -o no.json");
    command_fails(3, "2 + 2 cycles are simulated before the first jump, and there are 4 in all",
                  "calibration settlement --scene cyclic.json --initial 2 --train 2 --cycles 4 -o no.json");
    command_fails(3, "bare.json", "calibration settlement --scene bare.json -o no.json");
    command_fails(2, "--train 1", "calibration settlement --scene cyclic.json --train 1 -o no.json");
    assert_false(file_exists("no.json"));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_drawn_trend_is_found),
        cmocka_unit_test(the_bound_follows_from_what_is_left),
        cmocka_unit_test(a_lost_grain_keeps_its_row),
        cmocka_unit_test(what_is_no_series_is_refused),
        cmocka_unit_test(the_states_of_a_simulation_are_read),
        cmocka_unit_test(cycles_are_jumped_over),
        cmocka_unit_test(a_jump_too_far_is_parted),
        cmocka_unit_test(loops_that_make_no_sense_are_refused),
    };
    return cmocka_run_group_tests(tests, folder_enter, folder_leave);
}
