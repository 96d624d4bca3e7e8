/* The search for grain parameters: on formulas with known answers, on a small packing, resumed, and on targets that
 * cannot be reached. */
#include "tests/check.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "calibration/hertz/hertz_probes.h"
#include "pipeline/speak/error.h"

/* A smooth stand-in for a packing: E = 40 E*^(2/3) (1 - 0.3 nu*), nu = 0.1 + 0.4 nu*. */
static int formula(struct hertz_trial *trials, size_t count, void *user)
{
    int *asked = user;
    for (size_t k = 0; k < count; k++) {
        trials[k].young = 40 * pow(trials[k].grain_young, 2.0 / 3) * (1 - 0.3 * trials[k].grain_poisson);
        trials[k].poisson = 0.1 + 0.4 * trials[k].grain_poisson;
        *asked += 1;
    }
    return 0;
}

static struct hertz_goal goal_of(enum hertz_method method, double poisson, int both)
{
    double truth = (poisson - 0.1) / 0.4;
    return (struct hertz_goal){.dimensions = 2,
                               .young = 40 * pow(1e12, 2.0 / 3) * (1 - 0.3 * truth),
                               .poisson = poisson,
                               .fit_poisson = both,
                               .grain_young = 0.75e12,
                               .grain_poisson = both ? 0.35 : truth,
                               .method = method,
                               .rate = HERTZ_RATE,
                               .first_step = HERTZ_FIRST_STEP,
                               .cost = HERTZ_COST,
                               .most_probes = HERTZ_MOST_PROBES};
}

static void young_alone(void **state)
{
    (void)state;
    struct hertz_found found;
    int asked = 0;
    struct hertz_goal goal = goal_of(HERTZ_NEWTON, 0.18, 0);
    check_done(hertz_search(&goal, formula, &asked, &found));
    assert_true(found.reached);
    assert_in_range(found.probes, 2, 2); /* the exponent 2/3 is exact */
    assert_int_equal(asked, found.probes);
    check_near(found.best.grain_young / 1e12, 1, 1e-9);
    goal.method = HERTZ_ADAM;
    asked = 0;
    check_done(hertz_search(&goal, formula, &asked, &found));
    assert_true(found.reached);
    assert_in_range(found.probes, 4, 16);
    check_near(found.best.young / goal.young, 1, 0.01);
    assert_int_equal(asked, found.probes);
}

static void young_and_poisson_together(void **state)
{
    (void)state;
    for (int method = HERTZ_NEWTON; method <= HERTZ_ADAM; method++) {
        struct hertz_found found;
        int asked = 0;
        struct hertz_goal goal = goal_of((enum hertz_method)method, 0.18, 1);
        goal.rate = 0.03, goal.most_probes = 120; /* Adam swings past at 0.1 */
        check_done(hertz_search(&goal, formula, &asked, &found));
        assert_true(found.reached);
        check_near(found.best.young / goal.young, 1, 0.015);
        check_near(found.best.poisson / goal.poisson, 1, 0.015);
        if (method == HERTZ_NEWTON) {
            assert_in_range(found.probes, 2, 6);
            check_near(found.best.grain_poisson, 0.2, 0.01);
        }
    }
}

static void a_target_out_of_reach_ends(void **state)
{
    (void)state;
    for (int method = HERTZ_NEWTON; method <= HERTZ_ADAM; method++) {
        struct hertz_found found;
        int asked = 0;
        struct hertz_goal goal = goal_of((enum hertz_method)method, 0.45, 1); /* nu* would be 0.875 */
        check_done(hertz_search(&goal, formula, &asked, &found));
        assert_false(found.reached);
        assert_in_range(found.probes, 2, HERTZ_MOST_PROBES);
        assert_int_equal(asked, found.probes);
        assert_true(found.poisson_high < 0.31);
        if (method == HERTZ_NEWTON)
            assert_true(found.at_bound);
    }
}

static int refuse(struct hertz_trial *trials, size_t count, void *user)
{
    (void)trials, (void)count, (void)user;
    return error_failed("no probe today");
}

static void a_failed_probe_ends_the_search(void **state)
{
    (void)state;
    struct hertz_found found;
    struct hertz_goal goal = goal_of(HERTZ_ADAM, 0.18, 0);
    assert_int_equal(hertz_search(&goal, refuse, NULL, &found), -1);
    assert_int_equal(error_status(), EXIT_FAILED);
}

/* ---- a packing of 60 discs, kappa about 300 ---- */

static const struct grade GRADING[] = {{30, 8e-3}, {30, 12e-3}};

static struct simulation sixty(void)
{
    struct simulation simulation = SIMULATION_DEFAULT;
    simulation.grading = GRADING;
    simulation.grade_count = 2;
    simulation.pressure = 6000;
    simulation.preparation_mu = 0.1;
    simulation.law = (struct contact_law){.row = &hertz_pfc_law, .kt_over_kn = 1, .mu = 0.5};
    return simulation;
}

/* Newton's answer is checked by a packing that is consolidated with it and probed by hand. */
static void a_packing_is_calibrated_and_resumed(void **state)
{
    (void)state;
    struct simulation simulation = sixty();
    struct probe_options probe = {2e-5, 1};
    struct hertz_goal goal = goal_of(HERTZ_NEWTON, 0.18, 0);
    struct hertz_probes probes;
    struct hertz_found found, again;
    char path[] = "/tmp/film_record_XXXXXX";
    int file = mkstemp(path);
    assert_true(file >= 0);
    close(file);
    goal.young = 2e6, goal.grain_poisson = 0.2;
    check_done(hertz_probes_open(&simulation, &probe, 0, path, &goal, &probes));
    check_done(hertz_search(&goal, hertz_probes_evaluate, &probes, &found));
    assert_true(found.reached);
    assert_in_range(found.probes, 1, 8);
    check_near(found.best.young / 2e6, 1, 0.01);
    struct contact_law law = simulation.law;
    law.young = found.best.grain_young, law.poisson = 0.2, law.kt_over_kn = 2 * 0.8 / 1.8;
    struct probe_packing adapted;
    struct probe_result result;
    check_done(probe_adapt(&probes.base, &law, &adapted));
    check_done(probe_run(&adapted, &probe, &result));
    assert_true(result.rested);
    check_near(result.young / 2e6, 1, 0.01);
    check_near(result.fabric.porosity, 0.18, 0.05);
    probe_packing_free(&adapted);
    hertz_probes_close(&probes);

    /* Again: everything comes from the record, with the same bits; the last line was cut off by a crash. */
    FILE *cut = fopen(path, "a");
    assert_non_null(cut);
    fputs("{\"grain_young\":12", cut);
    fclose(cut);
    check_done(hertz_probes_open(&simulation, &probe, 0, path, &goal, &probes));
    assert_int_equal(probes.record.resumed, found.probes);
    check_done(hertz_search(&goal, hertz_probes_evaluate, &probes, &again));
    assert_int_equal(probes.record.count, found.probes);
    assert_memory_equal(&found.best, &again.best, sizeof found.best);
    hertz_probes_close(&probes);

    /* Another probe: the record is refused. */
    probe.strain = 1e-5;
    assert_int_equal(hertz_probes_open(&simulation, &probe, 0, path, &goal, &probes), -1);
    assert_non_null(strstr(error_message(), "another packing or another probe"));
    unlink(path);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(young_alone),
        cmocka_unit_test(young_and_poisson_together),
        cmocka_unit_test(a_target_out_of_reach_ends),
        cmocka_unit_test(a_failed_probe_ends_the_search),
        cmocka_unit_test(a_packing_is_calibrated_and_resumed),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
