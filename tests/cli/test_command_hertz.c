/* `calibration hertz` and `calibration laws` from outside: closed forms forwards and back, searches on a small packing
 * whose answer must scale with its stresses, spheres by a stand-in for LAMMPS that answers by a formula. */
#include "tests/commands.h"
#include "pipeline/files/json.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

static const double pi = 3.141592653589793;

/* ---- closed form ---- */

/* The formulas of docs/calibration_hertz.md from the grains to the packing. */
static void packing_of(int dimensions, double young, double poisson, double d50, double porosity, double z, double p,
                       double *packing_young, double *packing_poisson)
{
    int plane = dimensions == 2;
    double r = d50 / 2, solid = (1 - porosity) * z, a = plane ? 1 : 2;
    double volume = plane ? 2 * pi * r * r / solid : 8 * pi * r * r * r / (3 * solid); /* S / N_c, V / N_c */
    double fn = (plane ? 1 : 1.5) * volume * p / r, shear = young / (2 * (1 + poisson));
    double kn = cbrt(3 * r * shear * shear * fn / ((1 - poisson) * (1 - poisson)));
    double ks = 2 * (1 - poisson) / (2 - poisson) * kn;
    *packing_young = (plane ? 8 : 20.0 / 3) * r * r / volume * kn * ks / (a * kn + 3 * ks);
    *packing_poisson = (kn - ks) / (a * kn + 3 * ks);
}

static void closed_forms_lead_back_to_the_grains(void **state)
{
    (void)state;
    for (int dimensions = 2; dimensions <= 3; dimensions++) {
        double young, poisson;
        packing_of(dimensions, 7e10, 0.31, 2e-3, 0.19, 4.1, 1e5, &young, &poisson);
        command_done("calibration hertz --dimensions %d --young %.17g --poisson %.17g --confinement 1e5 "
                     "--porosity 0.19 --coordination 4.1 --d50 2e-3 -o closed.json",
                     dimensions, young, poisson);
        cJSON *object = json_of("closed.json", "film.hertz/1");
        assert_string_equal(json_text_at(object, "method"), "closed form");
        check_near(json_at(object, "young_Pa") / 7e10, 1, 1e-10);
        check_near(json_at(object, "poisson"), 0.31, 1e-10);
        cJSON_Delete(object);
    }
}

static void wrong_words_are_refused(void **state)
{
    (void)state;
    command_fails(2, "give all of --young", "calibration hertz --young 1e9 -o no.json");
    command_fails(2, "--dimensions 4", "calibration hertz --dimensions 4 -o no.json");
    command_fails(2, "--search needs --young", "calibration hertz --search newton --scene s.json -o no.json");
    command_fails(2, "--search needs --young",
                  "calibration hertz --search newton --scene s.json --young 1e6 --poisson 0.1 --grain-poisson 0.2 "
                  "-o no.json");
    command_fails(2, "Give --scene", "calibration hertz --search adam --young 1e6 --poisson 0.1 -o no.json");
    command_fails(2, "give one of: newton, adam", "calibration hertz --search simplex -o no.json");
    command_fails(3, "outside 0 to 0.5",
                  "calibration hertz --young 1e9 --poisson 0.4 --confinement 1e5 --porosity 0.17 --coordination 4 "
                  "--d50 2e-3 -o no.json");
    assert_false(file_exists("no.json"));
}

/* ---- searches ---- */

static void write_scene(const char *path, const char *law, const char *simulation)
{
    char text[1000];
    snprintf(text, sizeof text,
             "{\"schema\": \"film.scene/1\", \"name\": \"forty discs\", \"grains\": {\"density_kg_m3\": 2600, "
             "\"length_m\": 0.5}, \"contact\": {%s, \"mu\": 0.5}, \"simulation\": {%s, "
             "\"friction_during_compression\": 0.1}}",
             law, simulation);
    file_write(path, text);
}

#define HERTZ "\"law\": \"hertz_pfc\", \"young_Pa\": 1e9, \"poisson\": 0.2"
#define GRADING "\"grading\": [[20, 0.008], [20, 0.012]]"
#define SEARCH "calibration hertz --search newton --young 4e6 --scene packing.json "

/* The numbers of a search that must hang together whatever the packing. */
static void check_search(const cJSON *object, double young)
{
    double off = json_at(object, "packing_young_Pa") / young - 1;
    int probes = (int)json_at(object, "probes");
    check_near(json_at(object, "cost"), off * off, 1e-12);
    assert_true(json_at(object, "record.%d.young_Pa", probes - 1) > 0);
    assert_true(isnan(json_at(object, "record.%d.young_Pa", probes)));
    check_near(json_at(object, "record.0.young_Pa") / json_at(object, "start_young_Pa"), 1, 1e-12);
    check_near(json_at(object, "record.0.poisson"), 0.2, 1e-12);
    assert_true(json_is(object, "record.0.rested"));
    check_near(json_at(object, "record.0.porosity"), 0.18, 0.07); /* of a dense packing of discs */
    check_near(json_at(object, "record.0.z"), 4, 1);
}

/* Without a unit of its own a packing knows only ratios: with the pressure and the wanted E sixteen times as large, E*
 * is sixteen times as large, but for what the tolerance of rest (1e-7) leaves. */
static void a_search_scales_with_the_stresses(void **state)
{
    (void)state;
    double found[2];
    write_scene("packing.json", HERTZ, GRADING ", \"pressure_Pa\": 12000");
    write_scene("sixteen.json", HERTZ, GRADING ", \"pressure_Pa\": 192000");
    for (int k = 0; k < 2; k++) {
        command_done("calibration hertz --search newton --scene %s.json --young %g --grain-poisson 0.2 -o found.json",
                     k ? "sixteen" : "packing", k ? 6.4e7 : 4e6);
        cJSON *object = json_of("found.json", "film.hertz/1");
        assert_true(json_is(object, "reached"));
        check_near(json_at(object, "packing_young_Pa") / (k ? 6.4e7 : 4e6), 1, 0.01);
        check_near(json_at(object, "poisson"), 0.2, 1e-12);
        check_search(object, k ? 6.4e7 : 4e6);
        found[k] = json_at(object, "young_Pa");
        cJSON_Delete(object);
    }
    check_near(found[1] / found[0], 16, 1e-5);
    /* Adam comes to the same grains: both E within 1 %, and E goes with E*^(2/3). */
    command_done("calibration hertz --search adam --scene packing.json --young 4e6 --grain-poisson 0.2 -o adam.json");
    cJSON *object = json_of("adam.json", "film.hertz/1");
    assert_string_equal(json_text_at(object, "method"), "adam");
    check_near(json_at(object, "young_Pa") / found[0], 1, 0.03);
    cJSON_Delete(object);
}

/* Stopped and begun again: nothing is probed twice, and the answer has the same bytes. */
static void a_record_is_gone_on_with(void **state)
{
    (void)state;
    command_done(SEARCH "--grain-poisson 0.2 --record r.jsonl -o first.json");
    char *first = file_text("first.json"), *record = file_text("r.jsonl");
    cJSON *object = json_of("first.json", "film.hertz/1");
    assert_int_equal(text_count(record, "\n"), 1 + (int)json_at(object, "probes"));
    cJSON_Delete(object);
    for (int cut = 0; cut < 2; cut++) { /* as it is; in the middle of its last line */
        if (cut) {
            char *part = strndup(record, strlen(record) - 30);
            file_write("r.jsonl", part);
            free(part);
        }
        command_done(SEARCH "--grain-poisson 0.2 --record r.jsonl -o again.json");
        char *again = file_text("again.json"), *kept = file_text("r.jsonl");
        assert_string_equal(again, first);
        assert_string_equal(kept, record);
        free(again);
        free(kept);
    }
    command_fails(3, "r.jsonl: begun for another packing or another probe",
                  SEARCH "--grain-poisson 0.2 --strain 2e-5 --record r.jsonl -o no.json");
    *strstr(strchr(record, '\n'), "poisson") = 'q';
    file_write("r.jsonl", record);
    command_fails(3, "line 2: not a row", SEARCH "--grain-poisson 0.2 --record r.jsonl -o no.json");
    assert_false(file_exists("no.json"));
    free(first);
    free(record);
}

/* What was found so far is written, and the reason is the error. */
static void what_is_out_of_reach_ends(void **state)
{
    (void)state;
    double packed[2];
    for (int anew = 0; anew < 2; anew++) {
        command_fails(3, "not reached after 1 probes: the best is E = ",
                      SEARCH "--grain-poisson 0.2 --most-probes 1 %s -o ended.json", anew ? "--anew" : "");
        cJSON *object = json_of("ended.json", "film.hertz/1");
        assert_false(json_is(object, "reached"));
        assert_true(json_at(object, "cost") >= 1e-4);
        check_search(object, 4e6);
        packed[anew] = json_at(object, "packing_young_Pa");
        cJSON_Delete(object);
    }
    check_near(packed[1] / packed[0], 1, 0.3); /* the same grains, compressed from loose for the probe */
    command_fails(3, "nu = -0.5 cannot be reached: with grains from 0 to 0.5",
                  SEARCH "--poisson -0.5 --most-probes 12 -o ended.json");
}

static void what_is_no_packing_is_refused(void **state)
{
    (void)state;
    write_scene("linear.json", "\"law\": \"linear\", \"kn_N_per_m\": 1e7", GRADING ", \"pressure_Pa\": 12000");
    write_scene("discs.json", HERTZ, "\"discs\": [{\"x_m\": 0, \"y_m\": 0, \"radius_m\": 0.01}]");
    command_fails(3, "linear.json: contact.law",
                  "calibration hertz --search newton --young 4e6 --grain-poisson 0.2 --scene linear.json -o no.json");
    for (int dimensions = 2; dimensions <= 3; dimensions++)
        command_fails(3, "by its grading and a pressure",
                      "calibration hertz --search newton --dimensions %d --young 4e6 --grain-poisson 0.2 "
                      "--scene discs.json -o no.json",
                      dimensions);
    assert_false(file_exists("no.json"));
}

/* ---- spheres, by a stand-in for LAMMPS ---- */

/* Packs to the porosity 0.38 with z = 5, and answers a probe as an isotropic solid of
 *     E = 300 P^(1/3) E*^(2/3) (1 - 0.2 nu*),    nu = 0.2 + 0.3 nu*
 * would: stress changes of a confined compression. No test of LAMMPS: bench_hertz runs the real one. */
static const char STAND_IN[] =
    "#!/bin/sh\n"
    "[ \"$1\" = -h ] && exit 0\n"
    "script=$2; shift 2\n"
    "while [ $# -gt 2 ]; do if [ \"$1\" = -var ]; then eval \"$2=$3\"; shift 3; else shift; fi; done\n"
    "cp \"$script\" ../../\n"
    "if [ -n \"$LMP_FAILS\" ]; then echo \"ERROR: Lost atoms: original 40 current 39\"; exit 1; fi\n"
    "if [ $script = in.pack ]; then\n"
    "    : >packed.restart\n"
    "    awk -v L=$L 'BEGIN { printf \"RESULT %.15g 5\\n\", 0.5 * L^3 / 0.62 }'\n"
    "else\n"
    "    [ -e packed.restart ] || exit 1\n"
    "    awk -v E=$E -v V=$V -v Q=$Q -v P=$P 'BEGIN { Y = 300 * P^(1/3) * E^(2/3) * (1 - 0.2 * V); n = 0.2 + 0.3 * V\n"
    "        s = Y * (1 - n) / ((1 + n) * (1 - 2 * n)) * Q; t = s * n / (1 - n)\n"
    "        printf \"RESULT %.15g %.15g %.15g %.15g 1e-5 5 42000\\n\", t, t, s, Q }'\n"
    "fi\n";

/* PATH with the stand-in before all else, and a folder for temporary files that must be empty in the end. */
static void install_stand_in(void)
{
    char here[200], path[2000];
    assert_non_null(realpath(".", here));
    assert_int_equal(mkdir("fake", 0777) | mkdir("temporary", 0777), 0);
    file_write("fake/lmp", STAND_IN);
    assert_int_equal(chmod("fake/lmp", 0755), 0);
    snprintf(path, sizeof path, "%s/fake:%s", here, getenv("PATH"));
    setenv("PATH", path, 1);
    snprintf(path, sizeof path, "%s/temporary", here);
    setenv("TMPDIR", path, 1);
}

static void spheres_are_sought_through_lammps(void **state)
{
    (void)state;
    const double nu = 0.35, p = 1e5, young = 300 * cbrt(p) * pow(2e10, 2.0 / 3) * (1 - 0.2 * nu);
    char *before = strdup(getenv("PATH")), *pack;
    install_stand_in();
    write_scene("spheres.json", HERTZ, GRADING ", \"pressure_Pa\": 1e5");
    for (int both = 0; both < 2; both++) {
        command_done("calibration hertz --search newton --dimensions 3 --scene spheres.json --young %.17g %s %.17g "
                     "--record spheres%d.jsonl -o spheres.json.out",
                     young, both ? "--poisson" : "--grain-poisson", both ? 0.2 + 0.3 * nu : nu, both);
        cJSON *object = json_of("spheres.json.out", "film.hertz/1");
        assert_true(json_is(object, "reached"));
        check_near(json_at(object, "young_Pa") / 2e10, 1, 0.03); /* E within 1 %, E* goes with E^1.5 */
        check_near(json_at(object, "poisson"), nu, both ? 0.02 : 1e-12);
        check_near(json_at(object, "packing_young_Pa") / young, 1, 0.01 * sqrt(2));
        check_near(json_at(object, "packing_poisson"), 0.2 + 0.3 * json_at(object, "poisson"), 1e-9);
        check_near(json_at(object, "record.0.z"), 5, 0);
        check_near(json_at(object, "record.0.steps"), 42000, 0);
        double solid = 20 * pi / 6 * (pow(0.008, 3) + pow(0.012, 3));
        check_near(json_at(object, "record.0.porosity"), 1 - solid / 1e-5, 1e-9); /* the probe's volume */
        cJSON_Delete(object);
    }
    pack = file_text("in.pack");
    assert_non_null(strstr(pack, "group g0 id 1:20\nset group g0 diameter 0.008 density 2600\n"));
    assert_non_null(strstr(pack, "group g1 id 21:40\nset group g1 diameter 0.012 density 2600\n"));
    free(pack);
    setenv("LMP_FAILS", "yes", 1);
    command_fails(1, "LAMMPS: ERROR: Lost atoms: original 40 current 39",
                  "calibration hertz --search newton --dimensions 3 --scene spheres.json --young 1e9 "
                  "--grain-poisson 0.2 -o no.json");
    unsetenv("LMP_FAILS");
    setenv("PATH", "/nonexistent", 1);
    command_fails(3, "install the package lammps",
                  "calibration hertz --search newton --dimensions 3 --scene spheres.json --young 1e9 "
                  "--grain-poisson 0.2 -o no.json");
    setenv("PATH", before, 1);
    unsetenv("TMPDIR");
    assert_int_equal(remove("temporary"), 0); /* nothing was left in it */
    assert_false(file_exists("no.json"));
    free(before);
}

/* ---- laws ---- */

#define ROUGH                                                                                                          \
    "\"law\": \"pohrt_popov_plastic\", \"young_Pa\": 6e10, \"poisson\": 0.25, \"fractal_dimension\": 2.13, "           \
    "\"roughness_m\": 2.61e-5"

static const char *const LAWS[] = {"hertz_pfc", "hertz_mindlin", "pohrt_popov", "pohrt_popov_plastic", "linear"};

static double at_step(const cJSON *object, int law, int step, const char *key)
{
    return json_at(object, "laws.%d.steps.%d.%s", law, step, key);
}

static double of_law(const cJSON *object, int law, const char *key)
{
    return json_at(object, "laws.%d.%s", law, key);
}

/* Three steps per decade up, four back to half; every contact in one group; stress and modulus say the same. */
static void check_curve(const cJSON *object, int law)
{
    double last = 0, deviator = 0;
    for (int k = 0; k < 8; k++) {
        double strain = at_step(object, law, k, "strain");
        double expected = k < 4 ? 1e-5 * pow(10, k / 3.0) : 1e-4 * (1 - 0.125 * (k - 3));
        check_near(strain / expected, 1, 1e-9);
        if (k) /* the lateral stress is kept: what the axial one gains is the deviator's */
            check_near((at_step(object, law, k, "deviator_Pa") - deviator) /
                           (at_step(object, law, k, "E_Pa") * (strain - last)),
                       1, 0.05);
        last = strain, deviator = at_step(object, law, k, "deviator_Pa");
        double contacts = at_step(object, law, k, "loading") + at_step(object, law, k, "unloading") +
                          at_step(object, law, k, "reloading");
        check_near(contacts / (0.5 * 30 * of_law(object, law, "z")), 1, 0.4); /* contacts with walls count half in z */
    }
    assert_true(isnan(at_step(object, law, 8, "strain")));
    check_near(of_law(object, law, "E0_Pa"), at_step(object, law, 0, "E_Pa"), 0);
}

static void laws_are_compared(void **state)
{
    (void)state;
    write_scene("laws.json", ROUGH,
                "\"grading\": [[15, 0.024], [15, 0.04]], \"pressure_Pa\": 1.5e5, \"tolerance\": 1e-8");
    command_done("calibration laws --scene laws.json --first 1e-5 --last 1e-4 --max-flagged 1 --picture laws.svg "
                 "-o laws.out.json");
    cJSON *object = json_of("laws.out.json", "film.laws/1");
    for (int l = 0; l < 5; l++) {
        assert_string_equal(json_text_at(object, "laws.%d.law", l), LAWS[l]);
        check_curve(object, l);
    }
    /* Roughness makes softer; the linear law is as stiff as Hertz's contacts in the mean. */
    check_at_most(of_law(object, 2, "E0_Pa"), 0.8 * of_law(object, 1, "E0_Pa"));
    check_near(of_law(object, 4, "mean_contact_stiffness_N_per_m") /
                   of_law(object, 0, "mean_contact_stiffness_N_per_m"),
               1, 1e-9);
    cJSON_Delete(object);
    char *svg = check_svg("laws.svg");
    for (int l = 0; l < 5; l++) /* in two panels, and the plastic law in a title */
        assert_int_equal(text_count(svg, LAWS[l]), l == 3 ? 3 : l == 2 ? 5 : 2);
    assert_int_equal(text_count(svg, ">Tangent modulus<") + text_count(svg, ">Loading and unloading<"), 2);
    assert_int_equal(text_count(svg, "stroke-width:1.6;"), 2 * (5 + 5 + 3 + 3)); /* with the keys */
    free(svg);
}

static void laws_without_roughness_are_refused(void **state)
{
    (void)state;
    write_scene("smooth.json", HERTZ, GRADING ", \"pressure_Pa\": 12000");
    write_scene("few.json", ROUGH, "\"discs\": [{\"x_m\": 0, \"y_m\": 0, \"radius_m\": 0.01}]");
    command_fails(3, "smooth.json: contact.law", "calibration laws --scene smooth.json -o no.json");
    command_fails(3, "few.json: simulation", "calibration laws --scene few.json -o no.json");
    command_fails(3, "strains from 0.001 to 0.0001",
                  "calibration laws --scene laws.json --first 1e-3 --last 1e-4 -o no.json");
    command_fails(2, "--first 2", "calibration laws --scene laws.json --first 2 -o no.json");
    command_fails(2, "Give --scene", "calibration laws -o no.json");
    assert_false(file_exists("no.json"));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(closed_forms_lead_back_to_the_grains),
        cmocka_unit_test(wrong_words_are_refused),
        cmocka_unit_test(a_search_scales_with_the_stresses),
        cmocka_unit_test(a_record_is_gone_on_with),
        cmocka_unit_test(what_is_out_of_reach_ends),
        cmocka_unit_test(what_is_no_packing_is_refused),
        cmocka_unit_test(spheres_are_sought_through_lammps),
        cmocka_unit_test(laws_are_compared),
        cmocka_unit_test(laws_without_roughness_are_refused),
    };
    return cmocka_run_group_tests(tests, folder_enter, folder_leave);
}
