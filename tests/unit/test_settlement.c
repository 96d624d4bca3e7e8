/* Settlement under cycles: trends with known answers, parting of grains, the loop against every cycle simulated. */
#include "tests/check.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "calibration/settlement/settle_loop.h"
#include "calibration/settlement/settle_series.h"
#include "pipeline/speak/error.h"
#include "simulation/dem/loading.h"
#include "simulation/dem/placement.h"

static void trends_find_their_numbers(void **state)
{
    (void)state;
    double t[31], u[31];
    struct trend trend;
    for (int p = 0; p <= 30; p++)
        t[p] = 12 + p, u[p] = 4 + 2e-3 * log((12.0 + p) / 12) - 5e-5 * p;
    check_done(trend_fit(TREND_LOGARITHMIC, t, u, 30, &trend));
    check_near(trend.a, 2e-3, 1e-12);
    check_near(trend.b, -5e-5, 1e-13);
    check_near(trend_ahead(&trend, 100), 2e-3 * log(142.0 / 42) - 5e-3, 1e-11);
    check_at_most(trend.rms, 1e-14);
    for (int p = 0; p <= 30; p++)
        u[p] = 1 - 3e-4 * p;
    check_done(trend_fit(TREND_LINEAR, t, u, 30, &trend));
    check_near(trend_ahead(&trend, 50), -0.015, 1e-14);

    for (int p = 0; p <= 30; p++) {
        t[p] += p > 15 ? 40 : 0; /* a gap, as a jump leaves */
        u[p] = 7 - 4e-4 * log(t[p]);
    }
    check_done(trend_fit(TREND_LOG, t, u, 30, &trend));
    check_near(trend.a, -4e-4, 1e-14);
    check_near(trend_ahead(&trend, 200), -4e-4 * log(282.0 / 82), 1e-13);
    check_at_most(trend.rms, 1e-14);

    /* What a line leaves over: 3 mm, 0, 4 mm, 0 after its beginning, hence sqrt(25 / 4) mm. */
    const double when[] = {1, 2, 3, 4, 5}, way[] = {0, 0.003, 0, 0.004, 0};
    check_done(trend_fit(TREND_LINEAR, when, way, 4, &trend));
    check_near(trend.rms, 1e-3 * sqrt(25.0 / 4), 1e-15);
    check_near(trend.low, 0, 0);
    check_near(trend.high, 0.004, 1e-15);

    assert_int_equal(trend_fit(TREND_LOGARITHMIC, t, u, 1, &trend), -1);
    t[0] = 0;
    assert_int_equal(trend_fit(TREND_LINEAR, t, u, 5, &trend), -1);
    assert_int_equal(error_status(), EXIT_INPUT);
}

/* |u - v| / |u| of vectors by hand: (3, 4) against (0, 0) is as far off as it is long, against (3, 3) by 1 of 5; with
 * the origin (3, 0) by 1 of 4. A number that is missing is left out. */
static void errors_are_norms(void **state)
{
    (void)state;
    const double u[] = {3, 4, NAN}, nothing[] = {0, 0, 0}, near[] = {3, 3, 1}, origin[] = {3, 0, 0};
    check_near(relative_error(u, nothing, NULL, 3), 1, 1e-15);
    check_near(relative_error(u, near, NULL, 3), 0.2, 1e-15);
    check_near(relative_error(u, near, origin, 3), 0.25, 1e-15);
}

/* The bound holds for uniform errors, and says k as its formula does. */
static void chernoff_bounds_the_mean(void **state)
{
    (void)state;
    double k;
    uint64_t seed = 3;
    check_done(chernoff_cycles(-1, 1, 0.2, 0.05, &k));
    check_near(k, ceil(4 / 0.08 * log(40)), 0);
    int missed = 0, draws = 4000;
    for (int d = 0; d < draws; d++) {
        double sum = 0;
        for (int c = 0; c < (int)k; c++)
            sum += 2 * check_uniform(&seed) - 1;
        missed += fabs(sum / k) >= 0.2;
    }
    assert_in_range(missed, 0, draws / 20);
    assert_int_equal(chernoff_cycles(-1, 1, 0, 0.05, &k), -1);
    assert_int_equal(chernoff_cycles(-1, 1, 0.1, 1, &k), -1);
}

/* Three grains, four photos per cycle: a drift, a swing of known size, one grain lost in a photo. */
static void tracked_grains_are_split(void **state)
{
    (void)state;
    enum { CYCLES = 30, PER = 4, GRAINS = 3 };
    static double at[(CYCLES * PER + 1) * 2 * GRAINS];
    for (int s = 0; s <= CYCLES * PER; s++)
        for (int g = 0; g < GRAINS; g++) {
            double t = (double)s / PER, swing = (s % PER) ? 1e-4 * (g + 1) : 0;
            at[s * 2 * GRAINS + 2 * g] = g + 1e-4 * log(1 + t) * g;
            at[s * 2 * GRAINS + 2 * g + 1] = -1e-3 * log(1 + t) - 2e-5 * t + swing;
        }
    at[(2 * PER) * 2 * GRAINS + 2 * 2] = NAN;
    struct settle_series series = {GRAINS, CYCLES * PER + 1, at};
    struct settle_wanted wanted = {
        .trend = TREND_LOGARITHMIC, .per_cycle = PER, .first = 1, .ahead = 20, .error = 1e-6, .p = 0.05};
    struct settle_estimate estimate;
    check_done(settle_estimate(&series, &wanted, &estimate));
    assert_int_equal(estimate.cycles, CYCLES);
    assert_int_equal(estimate.unused, 1);
    assert_false(estimate.grain[2].used);
    for (int g = 0; g < 2; g++) {
        check_near(estimate.grain[g].residual[1], -1e-3 * log(1 + CYCLES) - 2e-5 * CYCLES, 1e-12);
        check_near(estimate.grain[g].ahead[1], -1e-3 * log(51) - 1e-3, 1e-9);
        check_near(estimate.grain[g].ahead[0], 1e-4 * log(51) * g, 1e-10);
        check_near(estimate.grain[g].reversible, 1e-4 * (g + 1), 5e-5); /* the drift within a cycle is curved */
    }
    check_at_most(estimate.held_out, 1e-6);
    assert_true(estimate.chernoff[0] <= estimate.chernoff[1]);
    settle_estimate_free(&estimate);
    series.states = PER;
    assert_int_equal(settle_estimate(&series, &wanted, &estimate), -1);
    series.states = 1;
    assert_int_equal(settle_estimate(&series, &wanted, &estimate), -1);
    assert_non_null(strstr(error_message(), "1 photo,"));
}

/* One grain learned linearly over cycles 0 to 4 and held out for one: it went 1 mm per cycle, in the last one 3 mm more
 * than that: 3 of the 7 mm that it went. */
static void what_was_held_out_is_judged_by_norms(void **state)
{
    (void)state;
    double at[] = {0, 0, 0, 1e-3, 0, 2e-3, 0, 3e-3, 0, 7e-3};
    struct settle_series series = {1, 5, at};
    struct settle_wanted wanted = {.trend = TREND_LINEAR, .per_cycle = 1, .first = 1, .ahead = 1, .error = NAN};
    struct settle_estimate estimate;
    check_done(settle_estimate(&series, &wanted, &estimate));
    check_near(estimate.held_out, 3.0 / 7, 1e-12);
    settle_estimate_free(&estimate);
}

static const struct grade GRADING[] = {{30, 8e-3}, {20, 12e-3}};
static const struct loading_steps NONE[] = {{1, 1}};

static struct simulation fifty(double kappa)
{
    struct simulation simulation = SIMULATION_DEFAULT;
    simulation.grading = GRADING;
    simulation.grade_count = 2;
    simulation.law = (struct contact_law){.row = &linear_law, .kn = 1e7, .kt_over_kn = 0.8, .mu = 0.5};
    simulation.kappa = kappa;
    simulation.test = TEST_CYCLIC;
    simulation.amplitude = 0.3;
    simulation.lateral_fixed = 1;
    simulation.steps = NONE;
    simulation.step_count = 1;
    simulation.tolerance = 1e-6;
    return simulation;
}

/* Grains off the walls displaced at random: overlaps far beyond those of equilibrium vanish, the energy only falls,
 * what touches a wall stays. */
static void overlapping_grains_are_parted(void **state)
{
    (void)state;
    static const struct law *const rows[] = {&linear_law, &hertz_mindlin_law, &pohrt_popov_plastic_law};
    for (int l = 0; l < 3; l++) {
        struct simulation simulation = fifty(5000);
        if (l) {
            simulation.kappa = NAN, simulation.pressure = 2000;
            simulation.law = (struct contact_law){rows[l], NAN, 1.5 / 1.75, 0.5, 0, 6e9, 0.25, 2.13, 1e-6};
        }
        struct loading loading = {.simulation = &simulation};
        struct unpress result;
        double history[UNPRESS_ITERATIONS], x[50], y[50];
        uint64_t seed = 4;
        check_done(placement(&simulation, &loading.dem));
        assert_true(loading_begin(&loading) >= 0);
        struct dem *dem = &loading.dem;
        int outer[50] = {0};
        for (size_t p = dem->first[dem->count]; p < dem->pair_count; p++)
            outer[dem->pairs[p].i] = 1;
        for (int k = 0; k < 50; k++) {
            if (!outer[k]) {
                dem->grains[k].x += 2e-4 * check_normal(&seed);
                dem->grains[k].y += 2e-4 * check_normal(&seed);
            }
            x[k] = dem->grains[k].x, y[k] = dem->grains[k].y;
        }
        check_done(unpress(dem, history, UNPRESS_ITERATIONS, &result));
        check_at_most(result.overlap[1], 0.1 * result.overlap[0]);
        check_at_most(result.energy[1], 0.01 * result.energy[0]);
        check_at_most(result.force[1], 0.01 * result.force[0]);
        assert_in_range(result.iterations, 2, UNPRESS_ITERATIONS);
        for (int k = 1; k < result.iterations; k++)
            assert_true(history[k] < history[k - 1]);
        for (size_t p = dem->first[dem->count]; p < dem->pair_count; p++) {
            int k = dem->pairs[p].i;
            if (outer[k] && dem->pairs[p].touching && dem->pairs[p].overlap > 1e-6) {
                check_near(dem->grains[k].x, x[k], 0);
                check_near(dem->grains[k].y, y[k], 0);
            }
        }
        dem_free(dem);
    }
}

/* Overlaps are kept when the grains have been put 1e-3 of a radius elsewhere. */
static void contacts_are_carried_along(void **state)
{
    (void)state;
    struct simulation simulation = fifty(500);
    struct loading loading = {.simulation = &simulation};
    struct unpress result;
    uint64_t seed = 8;
    check_done(placement(&simulation, &loading.dem));
    assert_true(loading_begin(&loading) >= 0);
    struct dem *dem = &loading.dem;
    double before = 0, after = 0, largest = 0;
    size_t contacts = 0, again = 0;
    for (size_t p = 0; p < dem->pair_count; p++)
        if (dem->pairs[p].touching) {
            before += dem->pairs[p].fn, contacts++;
            largest = fmax(largest, dem->pairs[p].overlap);
        }
    for (size_t k = 0; k < dem->count; k++) {
        dem->grains[k].x += 4e-6 * check_normal(&seed);
        dem->grains[k].y += 4e-6 * check_normal(&seed);
    }
    check_done(carry_contacts(dem, &result));
    for (size_t p = 0; p < dem->pair_count; p++)
        if (dem->pairs[p].touching)
            after += dem->pairs[p].fn, again++;
    check_near(after / before, 1, 0.01);
    check_near((double)again, (double)contacts, 2);
    dem_free(dem);
}

static void the_loop_settles_like_every_cycle(void **state)
{
    (void)state;
    struct simulation simulation = fifty(300);
    struct settle_options options = SETTLE_DEFAULT, every;
    struct settle_result quick, full;
    options.initial = 8, options.train = 8, options.ahead = 8, options.cycles = 32;
    every = options;
    every.ahead = 0;
    check_done(settle_run(&simulation, &options, &quick));
    check_done(settle_run(&simulation, &every, &full));
    assert_int_equal(full.simulated, 32);
    assert_int_equal(quick.simulated, 24);
    assert_int_equal(quick.jumps, 1);
    const struct settle_jump *jump = &quick.jump[0];
    assert_int_equal(jump->cycle, 24);
    check_near(jump->before, quick.settlement[16], 0);
    check_near(jump->arrived, quick.settlement[24], 0);
    check_near(jump->arrived, jump->promised, 0.02 * fabs(jump->promised - jump->before));
    for (size_t c = 0; c <= 16; c++)
        check_near(quick.settlement[c], full.settlement[c], 0); /* the same until the jump */
    assert_true(isnan(quick.settlement[17]));
    check_at_most((double)quick.steps, 0.9 * (double)full.steps);
    check_at_most(relative_error(full.end, quick.end, NULL, 2 * full.grains), 0.02);
    assert_int_equal(quick.unrested, 0);
    settle_result_free(&quick);
    settle_result_free(&full);
}

static void loops_that_make_no_sense_are_refused(void **state)
{
    (void)state;
    struct simulation simulation = fifty(300);
    struct settle_options options = SETTLE_DEFAULT;
    struct settle_result result;
    options.cycles = 30;
    assert_int_equal(settle_run(&simulation, &options, &result), -1);
    assert_non_null(strstr(error_message(), "nothing is left to extrapolate"));
    options = (struct settle_options)SETTLE_DEFAULT;
    simulation.test = TEST_OEDOMETER;
    assert_int_equal(settle_run(&simulation, &options, &result), -1);
    assert_int_equal(error_status(), EXIT_INPUT);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(trends_find_their_numbers),
        cmocka_unit_test(errors_are_norms),
        cmocka_unit_test(chernoff_bounds_the_mean),
        cmocka_unit_test(tracked_grains_are_split),
        cmocka_unit_test(what_was_held_out_is_judged_by_norms),
        cmocka_unit_test(overlapping_grains_are_parted),
        cmocka_unit_test(contacts_are_carried_along),
        cmocka_unit_test(the_loop_settles_like_every_cycle),
        cmocka_unit_test(loops_that_make_no_sense_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
