/* How far forces can differ at all: exact ranges and random walks against systems solved by hand, and each against the
 * other on a virtual packing. */
#include "forces/questions/range.h"
#include "forces/questions/walk.h"
#include "pipeline/speak/error.h"
#include "tests/unit/force_checks.h"

/* Thesis Fig. 2.11: discs 0 and 1 fixed, disc 2 on both, branches at `angle` to the vertical, P downwards. */
static void three_discs(double angle, struct packing *packing)
{
    const double radius = 5.7e-3, across = 2 * radius * sin(angle), up = 2 * radius * cos(angle);
    discs_begin(packing, 3);
    disc_put(packing, 0, -across, 0, radius);
    disc_put(packing, 1, across, 0, radius);
    disc_put(packing, 2, 0, up, radius);
    packing->grains.flags[0] = packing->grains.flags[1] = GRAIN_FIXED;
    packing->grains.load_y[2] = -1530;
    discs_touch(packing, 1e-9);
    assert_int_equal(packing->contacts.count, 2);
}

static void infer_ranges(const struct packing *packing, double mu, const char *range, struct forces *forces)
{
    struct force_options options = usual();
    options.law.mu = mu;
    options.start = START_MEAN;
    options.range = range;
    infer_and_check(packing, &options, METHOD_MAP, forces);
    check_done(range_forces(packing, &options, METHOD_MAP, forces));
}

/* On the static line the moment balance makes |ft| equal on both sides, fn cos a + ft sin a = P / 2, so fn lies between
 * P / 2 / (cos a + mu sin a) and P / 2 / (cos a - mu sin a), or has no upper limit when mu tan a >= 1. */
static void range_of_three_discs(void **state)
{
    (void)state;
    static const double degrees[] = {35, 45, 60, 60}, mus[] = {0.5, 0.5, 0.3, 0.6};
    for (int k = 0; k < 4; k++) {
        struct packing packing;
        struct forces forces;
        double a = degrees[k] * 3.141592653589793 / 180, mu = mus[k];
        three_discs(a, &packing);
        infer_ranges(&packing, mu, "0-1", &forces);
        for (size_t c = 0; c < 2; c++) {
            check_near(forces.contact.fn_low[c], 765 / (cos(a) + mu * sin(a)), 1e-2);
            if (mu * tan(a) < 1)
                check_near(forces.contact.fn_high[c], 765 / (cos(a) - mu * sin(a)), 1e-2);
            else
                assert_true(isinf(forces.contact.fn_high[c]));
        }
        forces_free(&forces);
        packing_free(&packing);
    }
}

/* A column of two discs carries its weight and nothing else: 2 N between them, 5 N on the floor, whatever is asked. */
static void one_answer_has_no_range(void **state)
{
    (void)state;
    struct packing packing;
    struct forces forces;
    discs_begin(&packing, 2);
    disc_put(&packing, 0, 0.5, 0.1, 0.1);
    disc_put(&packing, 1, 0.5, 0.3, 0.1);
    discs_box(&packing, 1, 1, 0);
    packing.grains.load_y[0] = -3;
    packing.grains.load_y[1] = -2;
    discs_touch(&packing, 1e-9);
    infer_ranges(&packing, 0.5, "all", &forces);
    for (size_t c = 0; c < packing.contacts.count; c++) {
        double expected = packing.contacts.j[c] == 1 ? 2 : 5;
        if (forces.contact.status[c] == STATUS_NOT_USED)
            continue;
        check_near(forces.contact.fn_low[c], expected, 1e-4);
        check_near(forces.contact.fn_high[c], expected, 1e-4);
    }
    forces_free(&forces);
    packing_free(&packing);
}

static void only_what_is_asked(void **state)
{
    (void)state;
    static const char *const wrong[] = {"2", "1-0", "x", "0,", "0-", "-1", "0 1"};
    struct packing packing;
    struct forces forces;
    three_discs(0.7, &packing);
    infer_ranges(&packing, 0.5, "1", &forces);
    assert_true(isnan(forces.contact.fn_low[0]) && isfinite(forces.contact.fn_low[1]));
    for (size_t k = 0; k < sizeof wrong / sizeof *wrong; k++) {
        struct force_options options = usual();
        options.range = wrong[k];
        assert_int_equal(range_forces(&packing, &options, METHOD_MAP, &forces), -1);
        assert_int_equal(error_status(), EXIT_INPUT);
        error_clear();
    }
    forces_free(&forces);
    packing_free(&packing);
}

/* ---- on a packing ---- */

static int keep_state(const struct packing *packing, const struct simulation_state *state, void *user)
{
    (void)state;
    copy_packing(packing, user);
    return 0;
}

static int draw(void **state)
{
    static struct packing packing; /* 30 grains, kappa = 100 */
    struct simulation simulation = SIMULATION_DEFAULT;
    const struct grade grading[] = {{13, 8e-3}, {7, 12e-3}, {6, 14e-3}, {4, 20e-3}};
    simulation.grading = grading, simulation.grade_count = 4;
    simulation.law = (struct contact_law){.row = &linear_law, .kn = KN, .kt_over_kn = 1, .mu = 0.5};
    simulation.kappa = 100;
    simulation.tolerance = 1e-9;
    *state = &packing;
    return simulate(&simulation, keep_state, &packing);
}

static int forget(void **state)
{
    packing_free(*state);
    return 0;
}

/* Everything admissible lies in the range: the truth, and every state of the walks of cdm, qsm and map. */
static void ranges_hold_walks_and_truth(void **state)
{
    const struct packing *packing = *state;
    struct forces bounds, walked;
    double mean = 0, wide = 0;
    const struct contact_forces *truth = &packing->forces[0].contact;
    infer_ranges(packing, 0.5, "all", &bounds);
    for (size_t c = 0; c < truth->count; c++)
        mean += truth->fn[c] / (double)truth->count;
    for (int method = METHOD_CDM; method <= METHOD_MAP; method++) {
        struct force_options options = usual();
        options.start = START_ZERO;
        options.tolerance = 1e-5;
        options.walk = 20;
        infer_and_check(packing, &options, (enum force_method)method, &walked);
        check_done(walk_forces(packing, &options, (enum force_method)method, &walked));
        assert_true(walked.walk.states >= 5);
        check_at_most(0.05, walked.walk.variance[0]);
        check_at_most(0.3, walked.walk.range[0]);
        for (size_t c = 0; c < truth->count; c++) {
            if (walked.contact.status[c] == STATUS_NOT_USED)
                continue;
            check_at_most(bounds.contact.fn_low[c], walked.contact.fn_min[c] + 1e-3 * mean);
            check_at_most(walked.contact.fn_max[c], bounds.contact.fn_high[c] + 1e-3 * mean);
            check_at_most(bounds.contact.fn_low[c], truth->fn[c] + 1e-3 * mean);
            check_at_most(truth->fn[c], bounds.contact.fn_high[c] + 1e-3 * mean);
            wide += (bounds.contact.fn_high[c] - bounds.contact.fn_low[c]) / mean / (double)truth->count;
        }
        forces_free(&walked);
    }
    check_at_most(0.5, wide / 3); /* kappa = 100: far from determined */
    forces_free(&bounds);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(range_of_three_discs),
        cmocka_unit_test(one_answer_has_no_range),
        cmocka_unit_test(only_what_is_asked),
        cmocka_unit_test_setup_teardown(ranges_hold_walks_and_truth, draw, forget),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
