/* All photos of a test together: what they must know, what they must not invent, what they say when it goes wrong. */
#include <omp.h>
#include <string.h>

#include "pipeline/speak/error.h"
#include "tests/bench/force_states.h"
#include "tests/bench/series_case.h"
#include "tests/check.h"

static struct states strained, elastic; /* 0, 0.5, 1 % of strain; 0, 2e-5, 4e-5 */

static int simulate_all(void **state)
{
    (void)state;
    if (states_simulate(70, 1000, 3, 2, 5e-3, &strained) < 0 || states_simulate(70, 1000, 3, 2, 2e-5, &elastic) < 0)
        return -1;
    return 0;
}

static int free_all(void **state)
{
    (void)state;
    states_free(&strained);
    states_free(&elastic);
    return 0;
}

/* The first `count` states, measured with the usual errors; the truth is borrowed. */
static void draw(const struct states *states, size_t count, const struct series_errors *errors, uint64_t seed,
                 struct series_case *series)
{
    memset(series, 0, sizeof *series);
    series->count = count;
    series->mean = states_mean_force(&states->state[0]);
    for (size_t s = 0; s < count; s++)
        series->truth[s] = states->state[s];
    assert_int_equal(series_case_draw(series, errors, seed), 0);
}

static void drop(struct series_case *series)
{
    for (size_t s = 0; s < series->count; s++)
        packing_free(&series->measured[s]);
}

static struct force_options usual(void)
{
    struct force_options options = FORCE_OPTIONS_DEFAULT;
    options.law.kn = 1.09e7, options.law.mu = 0.5;
    return options;
}

/* Forces of the first `count` measured states; the caller frees them. */
static int solve(const struct series_case *series, size_t count, const struct force_options *options,
                 const struct series_options *series_options, struct forces *forces, struct series_summary *summary)
{
    const struct packing *packings[SERIES_CASE_STATES];
    for (size_t s = 0; s < count; s++)
        packings[s] = &series->measured[s];
    return infer_series(packings, count, options, series_options, forces, summary);
}

static void free_forces(struct forces *forces, size_t count, struct series_summary *summary)
{
    for (size_t s = 0; s < count; s++)
        forces_free(&forces[s]);
    series_summary_free(summary);
}

static const struct series_errors USUAL = SERIES_ERRORS_USUAL;
static const struct series_options DEFAULT = SERIES_OPTIONS_DEFAULT;
static struct series_case series;

/* rms error of fn of each state alone (the offset known), and of all together. */
static void compare(const struct states *states, double *alone, double *together)
{
    struct series_errors known = USUAL;
    struct force_options options = usual();
    struct forces forces[3];
    struct series_summary summary;
    known.offset = 0;
    *alone = *together = 0;
    for (uint64_t seed = 1; seed <= 1; seed++) {
        draw(states, 3, &known, seed, &series);
        for (size_t s = 0; s < 3; s++) {
            const struct packing *packing = &series.measured[s];
            assert_int_equal(infer_series(&packing, 1, &options, &DEFAULT, &forces[s], &summary), 0);
            series_summary_free(&summary);
        }
        *alone += series_case_score(&series, forces).fn;
        free_forces(forces, 3, &summary);
        drop(&series);
        draw(states, 3, &USUAL, seed, &series);
        assert_int_equal(solve(&series, 3, &options, &DEFAULT, forces, &summary), 0);
        assert_true(summary.converged);
        *together += series_case_score(&series, forces).fn;
        free_forces(forces, 3, &summary);
        drop(&series);
    }
}

static void changes_of_the_network_tell(void **state)
{
    (void)state;
    double alone, together;
    compare(&strained, &alone, &together);
    assert_true(alone > 0.03);
    assert_true(together < 0.6 * alone);
}

/* Without changes, rows of other photos are consistent with equilibrium already: nothing can be learned. */
static void nothing_is_invented(void **state)
{
    (void)state;
    double alone, together;
    compare(&elastic, &alone, &together);
    assert_true(together > 0.8 * alone);
}

static void one_photo_is_map(void **state)
{
    (void)state;
    struct force_options options = usual();
    struct forces one, map;
    struct series_summary summary;
    draw(&strained, 1, &USUAL, 1, &series);
    assert_int_equal(solve(&series, 1, &options, &DEFAULT, &one, &summary), 0);
    assert_int_equal(infer_forces(&series.measured[0], &options, METHOD_MAP, &map), 0);
    assert_string_equal(one.method, "series");
    assert_memory_equal(one.contact.fn, map.contact.fn, map.contact.count * sizeof(double));
    assert_memory_equal(one.contact.ft, map.contact.ft, map.contact.count * sizeof(double));
    forces_free(&map);
    free_forces(&one, 1, &summary);
    drop(&series);
}

/* Forces and spreads of the three states, each of them `times` times in the series, with so many threads. */
static void solve_with_threads(size_t times, int threads, struct forces *forces, struct series_summary *summary)
{
    enum { MOST = 64 };
    const struct packing *packings[MOST];
    struct force_options options = usual();
    struct series_options drawn = DEFAULT;
    drawn.samples = 2;
    for (size_t s = 0; s < 3 * times; s++)
        packings[s] = &series.measured[s % 3];
    omp_set_num_threads(threads);
    assert_int_equal(infer_series(packings, 3 * times, &options, &drawn, forces, summary), 0);
    omp_set_num_threads(omp_get_num_procs());
}

/* Few contacts are the work of one thread; more than 4000 are shared among all of them, state by state. Whatever is
 * left undone there, by a thread that does nothing, shows in the forces or in their spread. */
static void threads_change_nothing(void **state)
{
    (void)state;
    enum { TIMES = 14, STATES = 3 * TIMES };
    static struct forces forces[2][STATES];
    struct series_summary summary[2];
    size_t contacts = 0;
    draw(&strained, 3, &USUAL, 1, &series);
    for (int k = 0; k < 2; k++)
        solve_with_threads(TIMES, k ? 3 : 1, forces[k], &summary[k]);
    for (size_t s = 0; s < STATES; s++) {
        size_t bytes = forces[0][s].contact.count * sizeof(double);
        contacts += summary[0].photo[s].contacts;
        assert_memory_equal(forces[0][s].contact.fn, forces[1][s].contact.fn, bytes);
        assert_memory_equal(forces[0][s].contact.s_fn, forces[1][s].contact.s_fn, bytes);
    }
    assert_true(contacts > 4000);
    assert_memory_equal(&summary[0].misfit, &summary[1].misfit, sizeof(double));
    free_forces(forces[0], STATES, &summary[0]);
    free_forces(forces[1], STATES, &summary[1]);
    drop(&series);
}

/* kn 10 % wrong comes right where loads change; where they do not, the fit is refused with a reason. */
static void stiffness_is_found_or_refused(void **state)
{
    (void)state;
    struct force_options options = usual();
    struct series_options fit = DEFAULT;
    struct forces forces[3];
    struct series_summary summary;
    fit.fit_stiffness = 1;
    options.law.kn *= 1.1;
    draw(&strained, 3, &USUAL, 1, &series);
    assert_int_equal(solve(&series, 3, &options, &fit, forces, &summary), 0);
    assert_null(summary.refused);
    assert_true(fabs(summary.kn / 1.09e7 - 1) < 0.03);
    assert_true(summary.s_kn > 0 && summary.s_kn < 0.03 * 1.09e7);
    free_forces(forces, 3, &summary);
    drop(&series);
    draw(&elastic, 3, &USUAL, 1, &series);
    assert_int_equal(solve(&series, 3, &options, &fit, forces, &summary), 0);
    assert_non_null(summary.refused);
    assert_true(fabs(summary.kn - options.law.kn) < 1);
    free_forces(forces, 3, &summary);
    drop(&series);
}

/* Hard cases end, with finite numbers and a figure of fit that tells. */
static void hard_cases_are_told(void **state)
{
    (void)state;
    struct force_options options = usual();
    struct series_errors errors = USUAL;
    struct forces forces[3];
    struct series_summary good, bad;
    draw(&strained, 3, &errors, 1, &series);
    assert_int_equal(solve(&series, 3, &options, &DEFAULT, forces, &good), 0);
    free_forces(forces, 3, &good);
    drop(&series);
    errors.body = 0.1;
    draw(&strained, 3, &errors, 1, &series);
    assert_int_equal(solve(&series, 3, &options, &DEFAULT, forces, &bad), 0);
    for (size_t s = 0; s < 3; s++)
        for (size_t c = 0; c < forces[s].contact.count; c++)
            assert_true(isfinite(forces[s].contact.fn[c]) && isfinite(forces[s].contact.ft[c]));
    assert_true(bad.misfit > 1.5 * good.misfit);
    free_forces(forces, 3, &bad);
    drop(&series);
    errors.body = 0;
    draw(&strained, 3, &errors, 1, &series);
    struct packing first = series.measured[1]; /* the same photo twice */
    series.measured[1] = series.measured[0];
    assert_int_equal(solve(&series, 3, &options, &DEFAULT, forces, &bad), 0);
    assert_true(bad.converged);
    free_forces(forces, 3, &bad);
    series.measured[1] = first;
    drop(&series);
}

/* A photo that was followed from another reference photo has constant errors of its own. */
static void another_reference_is_told(void **state)
{
    (void)state;
    struct force_options options = usual();
    struct forces forces[3];
    struct series_summary good, bad;
    draw(&strained, 3, &USUAL, 1, &series);
    assert_int_equal(solve(&series, 3, &options, &DEFAULT, forces, &good), 0);
    free_forces(forces, 3, &good);
    drop(&series);
    draw(&strained, 3, &USUAL, 501, &series);
    struct packing foreign = series.measured[2];
    memset(&series.measured[2], 0, sizeof foreign);
    drop(&series);
    draw(&strained, 2, &USUAL, 1, &series);
    series.measured[2] = foreign;
    assert_int_equal(solve(&series, 3, &options, &DEFAULT, forces, &bad), 0);
    assert_true(bad.misfit > 3 * good.misfit);
    free_forces(forces, 3, &bad);
    series.measured[2].grains.radius[5] *= 1.2; /* other rods altogether */
    assert_int_equal(solve(&series, 3, &options, &DEFAULT, forces, &bad), -1);
    assert_non_null(strstr(error_message(), "state 3 of the series: grain 5"));
    packing_free(&foreign);
    series.count = 2;
    drop(&series);
}

static void wrong_input_is_named(void **state)
{
    (void)state;
    struct force_options options = usual();
    struct forces forces[2];
    struct series_summary summary;
    draw(&strained, 2, &USUAL, 1, &series);
    series.measured[1].grains.count--;
    assert_int_equal(solve(&series, 2, &options, &DEFAULT, forces, &summary), -1);
    assert_int_equal(error_status(), EXIT_INPUT);
    assert_non_null(strstr(error_message(), "state 2"));
    series.measured[1].grains.count++;
    options.law.kn = NAN;
    assert_int_equal(solve(&series, 2, &options, &DEFAULT, forces, &summary), -1);
    assert_non_null(strstr(error_message(), "kn_N_per_m"));
    drop(&series);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(changes_of_the_network_tell),
        cmocka_unit_test(nothing_is_invented),
        cmocka_unit_test(one_photo_is_map),
        cmocka_unit_test(threads_change_nothing),
        cmocka_unit_test(stiffness_is_found_or_refused),
        cmocka_unit_test(hard_cases_are_told),
        cmocka_unit_test(another_reference_is_told),
        cmocka_unit_test(wrong_input_is_named),
    };
    return cmocka_run_group_tests(tests, simulate_all, free_all);
}
