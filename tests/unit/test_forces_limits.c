/* The force methods at the limits of what can be balanced: each case with the status, the residual and, where a hand
 * can work them out, the forces that it must end with. */
#include "tests/unit/force_checks.h"

static void check_ending(const struct packing *packing, const struct force_options *options, enum force_method method,
                         int converged, double least, double most)
{
    struct forces forces;
    infer_and_check(packing, options, method, &forces);
    if (forces.converged != converged || forces.imbalance < least || forces.imbalance > most)
        fail_msg("%s: converged %d, residual %g; expected %d, %g to %g", forces.method, forces.converged,
                 forces.imbalance, converged, least, most);
    forces_free(&forces);
}

/* ---- grains that nothing needs ---- */

/* A square lattice with a chain of two discs hanging on it by one contact: the same forces, none on the chain. */
static void dangling_grains_change_nothing(void **state)
{
    (void)state;
    enum { SIDE = 4, GRAINS = SIDE * SIDE };
    const double r = 0.01;
    struct packing packing;
    discs_begin(&packing, GRAINS + 2);
    for (size_t k = 0; k < GRAINS; k++)
        disc_put(&packing, k, r * (1 + 2 * (double)(k % SIDE)), r * (1 + 2 * (double)(k / SIDE)), r);
    /* In the hole beside disc 0, on its diagonal. */
    const double one = r + 1.2 * r * sqrt(0.5), two = one + 0.3 * r * sqrt(0.5);
    disc_put(&packing, GRAINS, one, one, 0.2 * r);
    disc_put(&packing, GRAINS + 1, two, two, 0.1 * r);
    discs_box(&packing, 2 * r * SIDE, 2 * r * SIDE, 0);
    discs_load_wall(&packing, "right", -80, 0);
    discs_load_wall(&packing, "top", 0, -120);
    discs_touch(&packing, 1e-6 * r);
    for (int method = METHOD_CDM; method <= METHOD_MAP; method++) {
        struct force_options options = usual();
        struct forces forces;
        options.start = START_MEAN;
        options.tolerance = method == METHOD_CDM ? 1e-3 : 1e-6;
        infer_and_check(&packing, &options, (enum force_method)method, &forces);
        assert_true(forces.converged);
        size_t hanging = 0;
        for (size_t c = 0; c < packing.contacts.count; c++)
            if (packing.contacts.j[c] == GRAINS || packing.contacts.j[c] == GRAINS + 1) {
                assert_int_equal(forces.contact.status[c], STATUS_NOT_USED);
                check_near(forces.contact.fn[c], 0, 0);
                hanging++;
            }
        assert_int_equal(hanging, 2);
        forces_free(&forces);
    }
    packing_free(&packing);
}

/* One contact: straight below it holds a grain's weight of 3 N exactly; at 30 degrees it cannot, and nobody may say
 * that it can. */
static void one_contact_under_gravity(void **state)
{
    (void)state;
    for (int leaning = 0; leaning < 2; leaning++) {
        struct packing packing;
        const double a = leaning ? 0.5235987755982988 : 0, r = 0.1;
        discs_begin(&packing, 2);
        disc_put(&packing, 0, 0, 0, r);
        disc_put(&packing, 1, 2 * r * sin(a), 2 * r * cos(a), r);
        packing.grains.flags[0] = GRAIN_FIXED;
        packing.grains.load_y[1] = -3;
        discs_touch(&packing, 1e-9);
        assert_int_equal(packing.contacts.count, 1);
        for (int method = METHOD_CDM; method <= METHOD_MAP; method++) {
            struct force_options options = usual();
            struct forces forces;
            options.start = START_ZERO;
            infer_and_check(&packing, &options, (enum force_method)method, &forces);
            assert_int_equal(forces.converged, !leaning);
            if (leaning)
                check_at_most(0.1, forces.imbalance);
            else
                check_near(forces.contact.fn[0], 3, 3e-6);
            forces_free(&forces);
        }
        packing_free(&packing);
    }
}

/* ---- loads that no admissible forces balance ---- */

/* A wall is pulled outwards: contacts only push. */
static void a_pulled_wall(void **state)
{
    (void)state;
    struct packing packing;
    discs_square_lattice(&packing, 4, 4, 0.01, -80, 120);
    for (int method = METHOD_CDM; method <= METHOD_MAP; method++) {
        struct force_options options = usual();
        options.start = START_ZERO;
        options.iterations = method == METHOD_MAP ? 0 : 500;
        check_ending(&packing, &options, (enum force_method)method, 0, 0.5, 10);
    }
    packing_free(&packing);
}

/* A moment on the middle one of three discs in a row that is pressed by 30 N between a fixed disc and a frictionless
 * wall. The third disc has no partner for a friction force, so the first takes it all: mu R fn at most. */
static void a_moment_beyond_friction(void **state)
{
    (void)state;
    for (int beyond = 0; beyond < 2; beyond++) {
        struct packing packing;
        const double r = 0.01, mu = 0.5, fn = 30;
        discs_begin(&packing, 3);
        disc_put(&packing, 0, r, r, r), disc_put(&packing, 1, 3 * r, r, r), disc_put(&packing, 2, 5 * r, r, r);
        packing.grains.flags[0] = GRAIN_FIXED;
        discs_box(&packing, 6 * r, 2 * r, 0);
        discs_load_wall(&packing, "right", -fn, 0);
        packing.grains.load_m[1] = (beyond ? 2 : 0.25) * mu * r * fn;
        discs_touch(&packing, 1e-9);
        for (int method = METHOD_QSM; method <= METHOD_MAP; method++) {
            struct force_options options = usual();
            options.start = START_ZERO;
            options.iterations = method == METHOD_QSM ? 2000 : 0;
            if (beyond)
                check_ending(&packing, &options, (enum force_method)method, 0, 0.02, 2);
            else
                check_ending(&packing, &options, (enum force_method)method, 1, 0, 1e-6);
        }
        packing_free(&packing);
    }
}

/* ---- networks ---- */

/* 40 x 40 discs: 4839 contacts or so, thousands more unknowns than equations. */
static void hexagonal_crystal_of_thousands(void **state)
{
    (void)state;
    const size_t nx = 40, ny = 40;
    struct packing packing;
    discs_hexagonal(&packing, nx, ny);
    size_t unknowns = 0;
    for (size_t c = 0; c < packing.contacts.count; c++)
        unknowns += packing.contacts.j[c] < (int64_t)(nx * ny) ? 2 : 1;
    assert_true(unknowns - 3 * nx * ny - 2 > 4000); /* h */
    for (int method = METHOD_QSM; method <= METHOD_MAP; method++) {
        struct force_options options = usual();
        options.start = START_ZERO;
        check_ending(&packing, &options, (enum force_method)method, 1, 0, 1e-6);
    }
    packing_free(&packing);
}

/* Three discs in a row between two fixed ones, ever straighter: thrusts of 1 / bend of the load. */
static void arches_near_mechanisms(void **state)
{
    (void)state;
    static const double bends[] = {1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6};
    for (size_t b = 0; b < sizeof bends / sizeof *bends; b++) {
        struct packing packing;
        const double r = 0.01;
        discs_begin(&packing, 5);
        for (size_t k = 0; k < 5; k++)
            disc_put(&packing, k, 2 * r * (double)k, bends[b] * r * (double)(k * (4 - k)), r);
        packing.grains.flags[0] = packing.grains.flags[4] = GRAIN_FIXED;
        packing.grains.load_y[2] = -1e-3;
        discs_touch(&packing, 3 * bends[b] * bends[b] * r + 1e-9 * r);
        assert_int_equal(packing.contacts.count, 4);
        for (int method = METHOD_QSM; method <= METHOD_MAP; method++) {
            struct force_options options = usual();
            options.start = START_MEAN;
            check_ending(&packing, &options, (enum force_method)method, 1, 0, 1e-6);
        }
        packing_free(&packing);
    }
}

/* ---- parameters ---- */

/* Stiffness ratios and friction at their ends, on a frictional packing drawn here: nothing depends on them but the
 * choice among the admissible forces. */
static int keep_state(const struct packing *packing, const struct simulation_state *state, void *user)
{
    (void)state;
    copy_packing(packing, user);
    return 0;
}

static void parameters_at_their_ends(void **state)
{
    (void)state;
    static const struct {
        double kt_over_kn, mu;
        int qsm; /* does it converge within 4000 iterations? */
    } cases[] = {{1e-6, 0.5, 1}, {1e6, 0.5, 1}, {1, 1e3, 1}, {1, 10, 1}, {1, 0.5, 1}};
    struct packing packing = {0};
    struct simulation simulation = SIMULATION_DEFAULT;
    const struct grade grading[] = {{26, 8e-3}, {14, 12e-3}, {13, 14e-3}, {7, 20e-3}};
    simulation.grading = grading, simulation.grade_count = 4;
    simulation.law = (struct contact_law){.row = &linear_law, .kn = KN, .kt_over_kn = 1, .mu = 0.5};
    simulation.kappa = 500;
    simulation.tolerance = 1e-9;
    check_done(simulate(&simulation, keep_state, &packing));
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++)
        for (int method = METHOD_QSM; method <= METHOD_MAP; method++) {
            struct force_options options = usual();
            options.law.kt_over_kn = cases[k].kt_over_kn, options.law.mu = cases[k].mu;
            int converged = method == METHOD_MAP || cases[k].qsm;
            check_ending(&packing, &options, (enum force_method)method, converged, 0, converged ? 1e-6 : 1);
        }
    packing_free(&packing);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(dangling_grains_change_nothing),
        cmocka_unit_test(one_contact_under_gravity),
        cmocka_unit_test(a_pulled_wall),
        cmocka_unit_test(a_moment_beyond_friction),
        cmocka_unit_test(hexagonal_crystal_of_thousands),
        cmocka_unit_test(arches_near_mechanisms),
        cmocka_unit_test(parameters_at_their_ends),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
