/* `report compare`, `budget`, `export` and `verify` from outside, on nine discs whose every number is known by
 * construction: what they print and what they write. */
#include "tests/commands.h"
#include "tests/lattice.h"
#include "pipeline/files/json.h"

#include <stdio.h>

/* The number at the end of the line that begins with `text`. */
static double printed(const char *text)
{
    const char *line = strstr(command_out, text);
    assert_non_null(line);
    return strtod(line + strlen(text), NULL);
}

/* A: the true forces times 1.1, contact 5 lost, and the grain in the middle unbalanced by (30, 40) N. */
static void write_packings(void)
{
    struct packing p;
    lattice_make(&p, "dem");
    lattice_write(&p, "truth.hdf", 0);
    lattice_make(&p, "map");
    for (int c = 0; c < LATTICE_CONTACTS; c++)
        p.forces->contact.fn[c] *= 1.1;
    p.contacts.flags[5] = CONTACT_CANDIDATE;
    p.forces->contact.fn[5] = 0;
    p.forces->residual.residual_x[4] = 30, p.forces->residual.residual_y[4] = 40;
    lattice_write(&p, "0001.forces.hdf", 1);
    lattice_make(&p, "cem");
    forces_free(p.forces);
    p.force_count = 0;
    lattice_write(&p, "0001.contacts.hdf", 1);
}

/* Of the true forces and those times 1.1, but for contact 5, for which A says 0: by the sums of both. */
static double correlation(void)
{
    double a = 0, b = 0, aa = 0, bb = 0, ab = 0;
    for (int c = 0; c < LATTICE_CONTACTS; c++) {
        double true_fn = c < 12 ? LATTICE_V(c / 4) : LATTICE_H(c / 4 - 3), fn = c == 5 ? 0 : 1.1 * true_fn;
        a += fn, b += true_fn, aa += fn * fn, bb += true_fn * true_fn, ab += fn * true_fn;
    }
    return (24 * ab - a * b) / sqrt((24 * aa - a * a) * (24 * bb - b * b));
}

static void forces_are_compared(void **state)
{
    (void)state;
    const double lost = LATTICE_V(1), all = 4 * (450 + 330.0);
    command_done("report compare 0001.forces.hdf truth.hdf --json forces.json");
    assert_int_equal(strncmp(command_out, "A: 0001.forces.hdf\nB: truth.hdf\n", 32), 0);
    cJSON *object = json_of("forces.json", NULL);
    check_near(json_at(object, "found"), LATTICE_GRAINS, 0);
    check_near(json_at(object, "centre_rms_m"), 0, 0);
    check_near(json_at(object, "contacts_a"), LATTICE_CONTACTS - 1, 0);
    check_near(json_at(object, "contacts_b"), LATTICE_CONTACTS, 0);
    check_near(json_at(object, "contact_precision"), 1, 0);
    check_near(json_at(object, "contact_recall"), 23.0 / 24, 1e-12);
    check_near(json_at(object, "contact_f1"), 2 * 23.0 / 47, 1e-12);
    check_near(json_at(object, "r_fn"), correlation(), 1e-12);
    check_near(json_at(object, "dist_N"), (0.1 * (all - lost) + lost) / 24, 1e-9);
    check_near(json_at(object, "mean_fn_a_N"), 1.1 * (all - lost) / 23, 1e-9);
    check_near(json_at(object, "mean_fn_b_N"), all / 24, 1e-9);
    /* Weber: forces times branches over the area; the lost contact held up two radii of one column. */
    check_near(json_at(object, "stress_b_xx_N_per_m"), 330 / LATTICE_BOX, 1e-6);
    check_near(json_at(object, "stress_b_yy_N_per_m"), 450 / LATTICE_BOX, 1e-6);
    check_near(json_at(object, "stress_a_yy_N_per_m"), 1.1 * (450 / LATTICE_BOX - lost * 0.02 / 0.0036), 1e-6);
    check_near(json_at(object, "residual_max_over_fn") * json_at(object, "mean_fn_a_N"), 50, 1e-9);
    assert_true(cJSON_IsNull(cJSON_GetObjectItem(object, "r_ft"))); /* no force to correlate */
    check_near(printed("F1 "), 2 * 23.0 / 47, 5e-5);                /* four decimals for people */
    check_near(printed("<fn> of B, over loaded contacts "), all / 24, 1e-3);
    assert_non_null(strstr(command_out, "  -\n"));
    cJSON_Delete(object);
}

static void contacts_are_compared_without_forces(void **state)
{
    (void)state;
    command_done("report compare 0001.contacts.hdf truth.hdf --truth-method dem");
    check_near(printed("contacts in both "), LATTICE_CONTACTS, 0);
    assert_null(strstr(command_out, "Pearson"));
}

/* A is off by (0.3, -0.4) px and 0.1 px of radius; one circle is false, one grain missed, one flagged. */
static void circles_are_compared(void **state)
{
    (void)state;
    struct photo_grains g;
    lattice_photo(&g, 0, 0, 0);
    lattice_photo_write(&g, "0000.photo-truth.hdf", "simulate", 0);
    lattice_photo(&g, 0.3, -0.4, 0);
    for (int k = 0; k < LATTICE_GRAINS; k++)
        g.radius_px[k] += 0.1;
    g.x_px[3] = 1000, g.flags[7] = GRAIN_WEAK_EDGE;
    lattice_photo_write(&g, "0000.grains.hdf", "findgrains", 0);
    command_done("report compare --json circles.json 0000.grains.hdf 0000.photo-truth.hdf");
    cJSON *object = json_of("circles.json", NULL);
    check_near(json_at(object, "found"), 8, 0);
    check_near(json_at(object, "missed"), 1, 0);
    check_near(json_at(object, "false"), 1, 0);
    check_near(json_at(object, "compared"), 7, 0);
    check_near(json_at(object, "centre_rms_px"), 0.5 / sqrt(2), 1e-9);
    check_near(json_at(object, "radius_bias_px"), 0.1, 1e-9);
    cJSON_Delete(object);
}

/* All move by (3, -5) px and turn by 0.02; A says (3.06, -5) and 0.021. The reference by A's columns, or by --from-a.
 */
static void motions_are_compared(void **state)
{
    (void)state;
    struct photo_grains g;
    lattice_photo(&g, 3, -5, 0.02);
    lattice_photo_write(&g, "0001.photo-truth.hdf", "simulate", 1);
    for (int from = 0; from < 2; from++) {
        lattice_photo(&g, 3.06, -5, 0.021);
        for (int k = 0; k < LATTICE_GRAINS && from; k++)
            g.x_ref_px[k] = g.y_ref_px[k] = NAN;
        lattice_photo_write(&g, "0001.tracks.hdf", "tracker", 1);
        lattice_photo(&g, 0, 0, 0);
        lattice_photo_write(&g, "start.hdf", "tracker", 0);
        command_done("report compare --from 0000.photo-truth.hdf %s --json motion.json 0001.tracks.hdf "
                     "0001.photo-truth.hdf",
                     from ? "--from-a start.hdf" : "");
        cJSON *object = json_of("motion.json", NULL);
        check_near(json_at(object, "motion_compared"), LATTICE_GRAINS, 0);
        check_near(json_at(object, "displacement_bias_x_px"), 0.06, 1e-9);
        check_near(json_at(object, "displacement_bias_y_px"), 0, 1e-9);
        check_near(json_at(object, "rotation_rms_deg"), 0.001 * 180 / 3.141592653589793, 1e-9);
        check_near(json_at(object, "rotation_pull"), 1, 1e-9);
        cJSON_Delete(object);
    }
}

static void wrong_comparisons_are_refused(void **state)
{
    (void)state;
    command_fails(2, "give two state files", "report compare truth.hdf");
    command_fails(3, "one is in px, the other in m", "report compare 0000.grains.hdf truth.hdf");
    command_fails(3, "A has no forces of method 'qsm'", "report compare --method qsm 0001.forces.hdf truth.hdf");
    command_fails(3, "B has no forces of method 'qsm'", "report compare --truth-method qsm 0001.forces.hdf truth.hdf");
    command_fails(3, "missing.hdf", "report compare --from missing.hdf 0001.tracks.hdf 0001.photo-truth.hdf");
    command_fails(1, "no/out.json", "report compare 0001.forces.hdf truth.hdf --json no/out.json");
}

/* ---- budget ---- */

/* Round numbers: P L = 1e3 N/m, d = 0.01 m: <fn> = pi P L d / (z phi) = 10 N; kn 1e6: overlap 1e-5 m, a tenth of a px;
 * s of an overlap: sqrt(2 (0.03^2 + 0.04^2)) px. */
static void a_budget_is_counted(void **state)
{
    (void)state;
    static const char *const words[] = {"--scale 1e-4 --diameter 0.01 --length 0.01 --kn 1e6", "--scene budget.json"};
    file_write("budget.json", "{\"schema\": \"film.scene/1\", \"name\": \"b\", \"scale_m_per_px\": 1e-4, \"grains\": "
                              "{\"radius_px\": [40, 60], \"density_kg_m3\": 1, \"length_m\": 0.01}, \"contact\": "
                              "{\"law\": \"linear\", \"kn_N_per_m\": 1e6, \"mu\": 0.5}}");
    for (int k = 0; k < 2; k++) {
        command_done(
            "report budget --pressure 1e5 --coordination 3.14159265358979 --solid 1 --s-centre 0.03 --s-radius "
            "0.04 --s-motion 0.01 %s --json budget.out.json",
            words[k]);
        cJSON *object = json_of("budget.out.json", NULL);
        check_near(json_at(object, "diameter_px"), 100, 1e-9);
        check_near(json_at(object, "kappa"), 1000, 1e-9);
        check_near(json_at(object, "mean_fn_N"), 10, 1e-9);
        check_near(json_at(object, "mean_overlap_px"), 0.1, 1e-9);
        check_near(json_at(object, "overlap_force_error"), sqrt(0.5), 1e-9);
        check_near(json_at(object, "s_change_N"), 1e6 * 1e-4 * 0.01 * sqrt(2), 1e-9);
        check_near(json_at(object, "scale_for_10_percent"), 1e-4 * 0.1 / sqrt(0.5), 1e-12);
        check_near(printed("mean normal force, pi P L d / (z phi) "), 10, 1e-5);
        cJSON_Delete(object);
    }
}

static void an_unknown_budget_is_refused(void **state)
{
    (void)state;
    command_fails(2, "at which mean stress?", "report budget --kn 1e6");
    command_fails(2, "takes no files", "report budget --pressure 1e5 truth.hdf");
    command_fails(2, "--solid 2", "report budget --pressure 1e5 --solid 2");
    command_fails(3, "--scale is not known", "report budget --pressure 1e5");
    command_fails(3, "--kn is not known", "report budget --pressure 1e5 --scale 1e-4 --diameter 0.01 --length 0.01");
    command_fails(3, "missing.json", "report budget --pressure 1e5 --scene missing.json");
}

/* ---- export ---- */

static void texts_hold_the_discs(void **state)
{
    (void)state;
    static const struct {
        const char *words, *line;
        size_t lines;
    } cases[] = {
        {"--csv 0001.forces.hdf", "x [m],y [m],radius [m]", 1 + LATTICE_GRAINS},
        {"--csv --table walls 0001.forces.hdf", "\"right\",0.059999999999999998,0,", 1 + 4},
        {"--csv --table contacts 0001.forces.hdf", ",map_fn [N],map_ft [N]", 1 + LATTICE_CONTACTS},
        {"--csv 0000.grains.hdf", ",2,weak_edge\n", 1 + LATTICE_GRAINS},
        {"--xyz 0001.forces.hdf truth.hdf", "\n4 0.029999999999999999 0.029999999999999999 0 0.01 0 0\n",
         2 * (2 + LATTICE_GRAINS)},
        {"--xyz 0000.photo-truth.hdf", "\n0 100 -300 0 50 0 0\n", 2 + LATTICE_GRAINS},
        {"--lammps truth.hdf 0001.forces.hdf", "ITEM: TIMESTEP\n1\nITEM: NUMBER OF ATOMS\n9\n",
         2 * (9 + LATTICE_GRAINS)},
        {"--lammps-local --method dem truth.hdf", "ITEM: NUMBER OF ENTRIES\n12\n", 9 + 12},
        {"--lammps-local 0001.contacts.hdf", "ITEM: ENTRIES index batom1 batom2 overlap\n", 9 + 12},
        {"--conf truth.hdf", "#CORNERS\n0.000000000000000e+00 6.000000000000000e-02\n", 0},
        {"--dic start.hdf", "100 300 0 5.000000000000000e+01 0.000000000000000e+00", 1 + LATTICE_GRAINS},
        {"--series truth.hdf 0001.forces.hdf",
         "[{\"name\":\"truth.hdf\",\"time\":0},{\"name\":\"0001.forces.hdf\",\"time\":10}]", 1},
    };
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        command_done("report export %s -o out.txt", cases[k].words);
        char *text = file_text("out.txt");
        if (!strstr(text, cases[k].line))
            print_error("%s: no \"%s\" in\n%s\n", cases[k].words, cases[k].line, text);
        assert_non_null(strstr(text, cases[k].line));
        if (cases[k].lines)
            assert_int_equal(text_count(text, "\n"), cases[k].lines);
        free(text);
    }
}

static void wrong_exports_are_refused(void **state)
{
    (void)state;
    command_fails(2, "which format?", "report export truth.hdf -o no.txt");
    command_fails(2, "one format only", "report export --csv --xyz truth.hdf -o no.txt");
    command_fails(2, "give one of: grains, contacts, walls", "report export --csv --table rims truth.hdf -o no.txt");
    command_fails(2, "this format takes one state file", "report export --csv truth.hdf truth.hdf -o no.txt");
    command_fails(2, "give a state file", "report export --csv -o no.txt");
    command_fails(3, "0000.grains.hdf: is a photo-side file without a table 'walls'",
                  "report export --csv --table walls 0000.grains.hdf -o no.txt");
    command_fails(3, "0000.grains.hdf: is in px", "report export --lammps 0000.grains.hdf -o no.txt");
    command_fails(3, "0000.grains.hdf: is in px", "report export --conf 0000.grains.hdf -o no.txt");
    command_fails(3, "truth.hdf: has no reference positions", "report export --dic truth.hdf -o no.txt");
    command_fails(3, "truth.hdf: has no forces of method 'qsm'",
                  "report export --lammps-local --method qsm truth.hdf -o no.txt");
    command_fails(3, "missing.hdf", "report export --xyz truth.hdf missing.hdf -o no.txt");
    command_fails(3, "missing.hdf", "report export --series truth.hdf missing.hdf -o no.txt");
    command_fails(1, "no/out.csv", "report export --csv truth.hdf -o no/out.csv");
    assert_false(file_exists("no.txt"));
}

static void the_program_lists_its_commands(void **state)
{
    (void)state;
    static const char *const names[] = {"map", "film", "compare", "page", "export", "histogram", "verify", "budget"};
    for (size_t k = 0; k < sizeof names / sizeof *names; k++) {
        command_done("report --help");
        char line[40];
        snprintf(line, sizeof line, "\n  %s ", names[k]);
        assert_int_equal(text_count(command_out, line), 1);
        command_done("report %s --help", names[k]);
        assert_non_null(strstr(command_out, names[k]));
    }
    command_fails(2, "there is no such command", "report pages");
    command_fails(2, "which command?", "report");
    command_fails(2, "give the files to verify", "report verify --scene s.json");
    command_fails(3, "missing.json", "report verify --scene missing.json truth.hdf");
}

static int begin(void **state)
{
    if (folder_enter(state))
        return -1;
    write_packings();
    return 0;
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(forces_are_compared),           cmocka_unit_test(contacts_are_compared_without_forces),
        cmocka_unit_test(circles_are_compared),          cmocka_unit_test(motions_are_compared),
        cmocka_unit_test(wrong_comparisons_are_refused), cmocka_unit_test(a_budget_is_counted),
        cmocka_unit_test(an_unknown_budget_is_refused),  cmocka_unit_test(texts_hold_the_discs),
        cmocka_unit_test(wrong_exports_are_refused),     cmocka_unit_test(the_program_lists_its_commands),
    };
    return cmocka_run_group_tests(tests, begin, folder_leave);
}
