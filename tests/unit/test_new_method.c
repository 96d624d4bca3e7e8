/* How a force method is added (CONTRIBUTING.md): a whole one, from its mathematics to its row, that is run through the
 * same call as the others. And what the table holds for all of them. */
#include <stdlib.h>

#include "forces/questions/range.h"
#include "forces/questions/walk.h"
#include "pipeline/packing/method_order.h"
#include "pipeline/speak/error.h"
#include "tests/unit/force_checks.h"

/* ---- the method: all of what its file would hold ---- */

/* The same force on every contact, and no friction: the one whose virial is that of the loads,
 *
 *     sum over contacts of fn l = virial,   l the length of the branch,
 *
 * in working units; where the virial is not known, the network's estimate of <fn>, which is 1. */
static int mean_solve(const struct problem *problem, double *f, struct outcome *outcome)
{
    const struct network *network = problem->network;
    double length = 0;
    for (size_t c = 0; c < network->count; c++)
        length += network->contact[c].length;
    for (size_t c = 0; c < network->count; c++) {
        f[2 * c] = isfinite(network->virial) && length > 0 ? network->virial / length : 1;
        f[2 * c + 1] = 0;
    }
    outcome->iterations = 1;
    return 0;
}

static const struct method MEAN = {.name = "mean",
                                   .says = "the same force on every contact, which carries the loads in the mean",
                                   .candidates = CANDIDATES_NEVER,
                                   .margin = METHOD_MARGIN,
                                   .doubt = INFINITY,
                                   .solve = mean_solve};

/* ---- its test ---- */

/* A column of two discs in a box, of weights 2 N (above) and 3 N. */
static void column(struct packing *packing)
{
    discs_begin(packing, 2);
    disc_put(packing, 0, 0.5, 0.1, 0.1);
    disc_put(packing, 1, 0.5, 0.3, 0.1);
    discs_box(packing, 1, 1, 0);
    discs_load_wall(packing, "right", 0, 0); /* two walls are left to react, so that the loads tell the virial */
    discs_load_wall(packing, "top", 0, 0);
    packing->grains.load_y[0] = -3;
    packing->grains.load_y[1] = -2;
    discs_touch(packing, 1e-9);
}

static int mean_number; /* of its row */

/* The virial is 2 N times 0.2 m and 5 N times 0.1 m: 0.9 N m over branches of 0.3 m. The upper disc lacks 1 N. */
static void the_new_method_answers(void **state)
{
    (void)state;
    struct packing packing;
    struct forces forces;
    struct force_options options = usual();
    column(&packing);
    assert_int_equal(mean_number, METHOD_COUNT);
    assert_int_equal(method_find("mean", 4), mean_number);
    check_done(infer_forces(&packing, &options, (enum force_method)mean_number, &forces));
    assert_string_equal(forces.method, "mean");
    for (size_t c = 0; c < packing.contacts.count; c++)
        if (forces.contact.status[c] != STATUS_NOT_USED) {
            check_near(forces.contact.fn[c], 3, 1e-9);
            check_near(forces.contact.ft[c], 0, 0);
            assert_int_equal(forces.contact.status[c], STATUS_STICK);
        }
    check_near(forces.residual.residual_y[1], 1, 1e-9);
    check_near(forces.residual.residual_y[0], -3, 1e-9);
    assert_false(forces.converged || forces.infeasible);
    forces_free(&forces);
    packing_free(&packing);
}

/* What a method cannot do is refused by its name, and so is a method that there is not. */
static void what_it_cannot_is_refused(void **state)
{
    (void)state;
    struct packing packing;
    struct forces forces;
    struct force_options options = usual();
    const enum force_method mean = (enum force_method)mean_number, none = (enum force_method)(mean_number + 1);
    column(&packing);
    options.walk = 3;
    options.range = "all";
    check_done(infer_forces(&packing, &options, mean, &forces));
    for (int k = 0; k < 2; k++) {
        assert_int_equal(walk_forces(&packing, &options, k ? none : mean, &forces), -1);
        assert_non_null(strstr(error_message(), k ? "no force method of number" : "mean cannot walk"));
        assert_int_equal(range_forces(&packing, &options, k ? none : mean, &forces), -1);
        assert_non_null(strstr(error_message(), k ? "no force method of number" : "mean has no ranges"));
    }
    forces_free(&forces);
    assert_int_equal(infer_forces(&packing, &options, none, &forces), -1);
    assert_int_equal(infer_forces(&packing, &options, (enum force_method) - 1, &forces), -1);
    assert_int_equal(error_status(), EXIT_INPUT);
    packing_free(&packing);
}

/* What a row says it needs is asked for, before anything else is done. */
static void needs_are_asked_for(void **state)
{
    (void)state;
    static const char *const lacks[] = {"kn_N_per_m", "overlaps", "--previous"};
    static struct method needy[3];
    struct packing packing;
    struct forces forces;
    column(&packing);
    free(packing.contacts.overlap);
    packing.contacts.overlap = NULL;
    for (int k = 0; k < 3; k++) {
        struct force_options options = usual();
        static const char *const names[] = {"needy0", "needy1", "needy2"};
        needy[k] = MEAN, needy[k].name = names[k], needy[k].needs = 1u << k;
        options.law.kn = NAN;
        assert_int_equal(infer_forces(&packing, &options, (enum force_method)method_add(&needy[k]), &forces), -1);
        assert_non_null(strstr(error_message(), lacks[k]));
        assert_non_null(strstr(error_message(), names[k]));
    }
    packing_free(&packing);
}

/* Every row has a name that the file and the page know, a sentence, and a solution; a name stands there once. */
static void the_table_is_whole(void **state)
{
    (void)state;
    char *names = method_names();
    assert_non_null(names);
    assert_int_equal(strncmp(names, "cem,cdm,qsm,map,mean", 20), 0);
    free(names);
    char *help = method_help();
    assert_non_null(help);
    assert_int_equal(strncmp(help, "cem: measured motions", 21), 0);
    assert_non_null(
        strstr(help, " the one to use. mean: the same force on every contact, which carries the loads in the mean."));
    free(help);
    for (int k = 0; k < METHOD_COUNT; k++) {
        const struct method *row = method_row((enum force_method)k);
        assert_non_null(row);
        assert_true(row->name && strlen(row->name) < NAME_LENGTH && row->says && row->solve);
        assert_true(method_rank(row->name) < method_rank("dem"));
        assert_int_equal(method_find(row->name, strlen(row->name)), k);
        assert_int_equal(method_add(row), -1);
        assert_non_null(strstr(error_message(), "already"));
    }
    assert_int_equal(method_find("ma", 2), -1);
    assert_int_equal(method_find("mapp", 4), -1);
}

static int add_mean(void **state)
{
    (void)state;
    mean_number = method_add(&MEAN);
    return mean_number < 0;
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_new_method_answers),
        cmocka_unit_test(what_it_cannot_is_refused),
        cmocka_unit_test(needs_are_asked_for),
        cmocka_unit_test(the_table_is_whole),
    };
    return cmocka_run_group_tests(tests, add_mean, NULL);
}
