/* Every allocation of forces fails once: the call says so, or its result is that of the undisturbed one. */
#include <omp.h>
#include <stdlib.h>

#include "tests/failing_memory.h"
#include "tests/unit/discs.h"

#include "forces/infer_forces.h"
#include "forces/questions/buckling.h"
#include "forces/questions/range.h"
#include "forces/questions/walk.h"
#include "forces/series/series.h"
#include "pipeline/speak/error.h"

enum { STATES = 3 };
static struct packing packings[STATES];

/* Motions since the last state, which has forces. */
static void follow(struct packing *packing, struct packing *last)
{
    struct force_options options = FORCE_OPTIONS_DEFAULT;
    options.law.kn = 1e8, options.law.mu = 0.3;
    check_done(table_add(&CONTACTS, &packing->contacts, "dun"));
    check_done(table_add(&CONTACTS, &packing->contacts, "dut"));
    for (size_t c = 0; c < packing->contacts.count; c++)
        packing->contacts.dun[c] = packing->contacts.dut[c] = 1e-8 * (double)(c % 3);
    packing->contacts.dun[5] = NAN; /* only the state before tells that this contact is no new one */
    last->forces = calloc(1, sizeof *last->forces);
    last->force_count = 1;
    check_done(infer_forces(last, &options, METHOD_MAP, &last->forces[0]));
}

/* The same crystal three times, pressed ever more, with errors of places. */
static int draw(void **state)
{
    (void)state;
    static const char *const names[] = {"s_x_ref", "s_y_ref", "s_x", "s_y", "angle", "s_angle"};
    omp_set_num_threads(1); /* the order of allocations is the same in each run */
    for (int s = 0; s < STATES; s++) {
        struct packing *packing = &packings[s];
        discs_hexagonal(packing, 3, 3);
        for (size_t k = 0; k < sizeof names / sizeof *names; k++)
            check_done(table_add(&GRAINS, &packing->grains, names[k]));
        for (size_t k = 0; k < packing->grains.count; k++) {
            struct grains *g = &packing->grains;
            g->s_x_ref[k] = g->s_y_ref[k] = g->s_x[k] = g->s_y[k] = 1e-6;
            g->angle[k] = g->s_angle[k] = 0;
        }
        for (size_t c = 0; c < packing->contacts.count; c++)
            packing->contacts.overlap[c] = (5 + s + 0.1 * (double)(c % 7)) * 1e-6;
        discs_load_wall(packing, "right", -1000 - 100 * s, 0);
        discs_load_wall(packing, "top", 0, -1200 - 200 * s);
    }
    follow(&packings[0], &packings[2]);
    return 0;
}

static int forget(void **state)
{
    (void)state;
    for (int s = 0; s < STATES; s++)
        packing_free(&packings[s]);
    return 0;
}

static struct force_options options_with_all(void)
{
    struct force_options options = FORCE_OPTIONS_DEFAULT;
    options.law.kn = 1e8, options.law.mu = 0.3;
    options.samples = 2, options.walk = 2;
    options.range = "3";
    options.iterations = 20;
    options.colours = 1, options.block = 5;
    options.candidates = 1;
    return options;
}

static int same_forces(const struct forces *a, const struct forces *b)
{
    return same_columns(&CONTACT_FORCES, &a->contact, &b->contact) &&
           same_columns(&RESIDUALS, &a->residual, &b->residual) && same_columns(&RAYS, &a->ray, &b->ray) &&
           same_columns(&SOFTEST, &a->softest, &b->softest) && a->infeasible == b->infeasible &&
           !memcmp(a->stability, b->stability, sizeof a->stability) && !memcmp(&a->walk, &b->walk, sizeof a->walk) &&
           !memcmp(&a->imbalance, &b->imbalance, sizeof a->imbalance);
}

/* One method, and what else can be asked of it. */
static int everything(enum force_method method, struct forces *forces)
{
    struct force_options options = options_with_all();
    options.start = method == METHOD_CDM ? START_CEM : START_DEFAULT;
    options.previous = &packings[2];
    if (infer_forces(&packings[0], &options, method, forces))
        return -1;
    int status = method != METHOD_CEM && walk_forces(&packings[0], &options, method, forces);
    status = status || range_forces(&packings[0], &options, method, forces) ||
             stability_of_forces(&packings[0], &options, forces);
    if (status)
        forces_free(forces);
    return status ? -1 : 0;
}

static void every_allocation_of_a_method(void **state)
{
    (void)state;
    for (int method = METHOD_CEM; method < METHOD_COUNT; method++) {
        struct forces whole, forces;
        int failed = 1, refused = 0;
        check_done(everything((enum force_method)method, &whole));
        for (long left = 0; failed; left++) {
            atomic_store(&allocations_left, left);
            int status = everything((enum force_method)method, &forces);
            failed = allocation_failed();
            refused += status != 0;
            assert_true(status || same_forces(&forces, &whole));
            assert_true(failed || !status);
            assert_true(!status || error_status() == EXIT_FAILED);
            if (!status)
                forces_free(&forces);
            error_clear();
        }
        assert_true(refused > 40);
        forces_free(&whole);
    }
}

static int all_states(struct forces *forces, struct series_summary *summary)
{
    const struct packing *const states[STATES] = {&packings[0], &packings[1], &packings[2]};
    struct force_options options = options_with_all();
    struct series_options series_options = SERIES_OPTIONS_DEFAULT;
    series_options.samples = 2;
    return infer_series(states, STATES, &options, &series_options, forces, summary);
}

static void every_allocation_of_a_series(void **state)
{
    (void)state;
    struct forces whole[STATES], forces[STATES];
    struct series_summary first, summary;
    int failed = 1, refused = 0;
    check_done(all_states(whole, &first));
    for (long left = 0; failed; left++) {
        atomic_store(&allocations_left, left);
        int status = all_states(forces, &summary);
        failed = allocation_failed();
        refused += status != 0;
        for (int s = 0; s < STATES && !status; s++) {
            assert_true(same_forces(&forces[s], &whole[s]));
            forces_free(&forces[s]);
        }
        assert_true(failed || !status);
        assert_true(!status || error_status() == EXIT_FAILED);
        series_summary_free(&summary);
        error_clear();
    }
    assert_true(refused > 100);
    for (int s = 0; s < STATES; s++)
        forces_free(&whole[s]);
    series_summary_free(&first);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_allocation_of_a_method),
        cmocka_unit_test(every_allocation_of_a_series),
    };
    return cmocka_run_group_tests(tests, draw, forget);
}
