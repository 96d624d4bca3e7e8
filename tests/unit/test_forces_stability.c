/* Numerical stability of the force methods: each case with the status and the residual that it must end with. */
#include "tests/unit/force_checks.h"

static int keep_state(const struct packing *packing, const struct simulation_state *state, void *user)
{
    if (state->index == 0)
        copy_packing(packing, user);
    return 0;
}

/* An isotropic state of grains of these sizes, in equilibrium to `tolerance` of <fn>. */
static void draw_packing(const struct grade *grading, size_t grades, double kappa, double tolerance,
                         struct packing *packing)
{
    struct simulation simulation = SIMULATION_DEFAULT;
    simulation.grading = grading, simulation.grade_count = grades;
    simulation.law = (struct contact_law){.row = &linear_law, .kn = KN, .kt_over_kn = 1, .mu = 0.5};
    simulation.kappa = kappa;
    simulation.tolerance = tolerance;
    check_done(simulate(&simulation, keep_state, packing));
}

static int draw_usual(void **state)
{
    static struct packing packing; /* 120 grains, kappa = 300 */
    const struct grade grading[] = {{52, 8e-3}, {28, 12e-3}, {26, 14e-3}, {14, 20e-3}};
    draw_packing(grading, 4, 300, 1e-9, &packing);
    *state = &packing;
    return 0;
}

static int forget(void **state)
{
    packing_free(*state);
    return 0;
}

static double mean_truth(const struct packing *packing)
{
    double sum = 0, pushing = 0;
    for (size_t c = 0; c < packing->contacts.count; c++)
        if (packing->forces[0].contact.fn[c] > 0)
            sum += packing->forces[0].contact.fn[c], pushing++;
    return sum / pushing;
}

/* How a method must end: status, residual (over <fn>) and r(fn) with the truth. */
struct ending {
    int iterations, converged;
    double least, most, r; /* residual from .. to; r(fn) at least */
};

static void check_ending(const struct packing *packing, const struct force_options *usual_options,
                         enum force_method method, const struct ending *ending)
{
    struct force_options options = *usual_options;
    struct forces forces;
    options.start = START_OVERLAP;
    options.iterations = ending->iterations;
    infer_and_check(packing, &options, method, &forces);
    assert_int_equal(forces.converged, ending->converged);
    check_at_most(ending->least, forces.imbalance);
    check_at_most(forces.imbalance, ending->most);
    check_at_most(ending->r, r_fn(packing, &forces));
    forces_free(&forces);
}

static void check_endings(const struct packing *packing, const struct ending endings[METHOD_COUNT])
{
    struct force_options options = usual();
    for (int method = METHOD_CDM; method <= METHOD_MAP; method++)
        check_ending(packing, &options, (enum force_method)method, &endings[method]);
}

/* kappa = 1e6: overlaps of a few 1e-9 m on grains of 1e-2 m. */
static void nearly_rigid_grains(void **state)
{
    (void)state;
    struct packing packing = {0};
    const struct grade grading[] = {{12, 8e-3}, {8, 12e-3}, {6, 14e-3}, {3, 20e-3}};
    const struct ending endings[METHOD_COUNT] = {[METHOD_CDM] = {500, 0, 1e-6, 0.3, 0.95},
                                                 [METHOD_QSM] = {0, 1, 0, 1e-6, 0.998},
                                                 [METHOD_MAP] = {0, 1, 0, 1e-6, 0.99999}};
    draw_packing(grading, 4, 1e6, 1e-6, &packing);
    check_endings(&packing, endings);
    packing_free(&packing);
}

/* Radii 20:1: masses 400:1, inertias 160000:1; most small grains are rattlers, but not all. */
static void radii_of_twenty_to_one(void **state)
{
    (void)state;
    struct packing packing = {0};
    const struct grade grading[] = {{100, 1e-3}, {12, 6e-3}, {8, 20e-3}};
    const struct ending endings[METHOD_COUNT] = {[METHOD_CDM] = {500, 0, 1e-6, 1, 0.95},
                                                 [METHOD_QSM] = {0, 1, 0, 1e-6, 0.998},
                                                 [METHOD_MAP] = {0, 1, 0, 1e-6, 0.99999}};
    draw_packing(grading, 3, 300, 1e-8, &packing);
    size_t unequal = 0;
    for (size_t c = 0; c < packing.contacts.count; c++) {
        size_t i = (size_t)packing.contacts.i[c], j = (size_t)packing.contacts.j[c];
        double ratio = j < packing.grains.count ? packing.grains.radius[i] / packing.grains.radius[j] : 1;
        unequal += packing.forces[0].contact.fn[c] > 0 && fmax(ratio, 1 / ratio) > 19;
    }
    assert_true(unequal >= 10); /* contacts of the smallest with the largest that carry */
    check_endings(&packing, endings);
    packing_free(&packing);
}

/* Every grain that carries gets a load of 10 % of <fn> in a random direction, which the truth did not have: grains with
 * few weak contacts cannot stand it. No method may say that it converged; map's soft forces stay near the truth. */
static void noise_of_body_forces(void **state)
{
    struct packing packing;
    const struct ending endings[METHOD_COUNT] = {[METHOD_CDM] = {500, 0, 0.1, 1.5, 0.85},
                                                 [METHOD_QSM] = {500, 0, 0.05, 0.4, 0.8},
                                                 [METHOD_MAP] = {0, 0, 0.05, 0.4, 0.998}};
    uint64_t seed = 5;
    copy_packing(*state, &packing);
    struct grains *g = &packing.grains;
    const double noise = 0.1 * mean_truth(&packing);
    static const char *const names[] = {"load_x", "load_y", "load_m"};
    for (int k = 0; k < 3; k++)
        check_done(table_add(&GRAINS, g, names[k]));
    for (size_t k = 0; k < g->count; k++)
        g->load_x[k] = g->load_y[k] = g->load_m[k] = 0;
    for (size_t c = 0; c < packing.contacts.count; c++) {
        size_t ends[2] = {(size_t)packing.contacts.i[c], (size_t)packing.contacts.j[c]};
        for (int e = 0; e < 2 && packing.forces[0].contact.fn[c] > 0; e++)
            if (ends[e] < g->count && g->load_x[ends[e]] == 0)
                g->load_x[ends[e]] = noise * check_normal(&seed), g->load_y[ends[e]] = noise * check_normal(&seed);
    }
    check_endings(&packing, endings);
    packing_free(&packing);
}

/* A heavy wall takes the sweeps of contact dynamics with it: slow, and it says so. qsm and map know no masses. */
static void wall_mass_is_no_part_of_the_answer(void **state)
{
    static const double mass[] = {1, 100, 1e4, 1e8}, most[] = {0.01, 0.2, 1, 1};
    for (int m = 0; m < 4; m++) {
        struct force_options options = usual();
        const struct ending ending = {1000, 0, 1e-6, most[m], 0.95};
        options.wall_mass = mass[m];
        check_ending(*state, &options, METHOD_CDM, &ending);
    }
    for (int method = METHOD_QSM; method <= METHOD_MAP; method++) {
        struct force_options options = usual();
        struct forces reference, forces;
        infer_and_check(*state, &options, (enum force_method)method, &reference);
        for (int m = 0; m < 4; m++) {
            options.wall_mass = mass[m];
            infer_and_check(*state, &options, (enum force_method)method, &forces);
            for (size_t c = 0; c < forces.contact.count; c++)
                assert_true(forces.contact.fn[c] == reference.contact.fn[c]);
            forces_free(&forces);
        }
        forces_free(&reference);
    }
}

/* The strongest 3 % of the contacts are missing: no admissible forces balance the loads. */
static void strongest_contacts_lost(void **state)
{
    struct packing packing;
    const struct ending endings[METHOD_COUNT] = {
        [METHOD_CDM] = {500, 0, 1, 10, 0.5}, [METHOD_QSM] = {500, 0, 0.3, 4, 0.1}, [METHOD_MAP] = {0, 0, 0.5, 4, 0.5}};
    copy_packing(*state, &packing);
    const double *truth = packing.forces[0].contact.fn;
    for (size_t lost = 0; lost < packing.contacts.count * 3 / 100; lost++) {
        size_t strongest = 0;
        for (size_t c = 0; c < packing.contacts.count; c++)
            if (!(packing.contacts.flags[c] & CONTACT_NOT_FINITE) &&
                (packing.contacts.flags[strongest] & CONTACT_NOT_FINITE || truth[c] > truth[strongest]))
                strongest = c;
        packing.contacts.flags[strongest] |= CONTACT_NOT_FINITE;
    }
    check_endings(&packing, endings);
    packing_free(&packing);
}

/* Contacts after Hertz: the stiffness of each depends on its radii and its force. Overlaps alone give back the normal
 * forces of the virtual packing, and cem from them, without motion, leaves them as they are. */
static void nonlinear_law(void **state)
{
    (void)state;
    struct packing packing = {0};
    struct simulation simulation = SIMULATION_DEFAULT;
    struct force_options options = usual();
    const struct grade grading[] = {{30, 8e-3}, {16, 12e-3}, {14, 14e-3}};
    struct contact_law law = {.row = &hertz_mindlin_law, .kn = NAN, .mu = 0.5, .young = 1e9, .poisson = 0.3};
    law.kt_over_kn = 2 * (1 - law.poisson) / (2 - law.poisson);
    simulation.grading = grading, simulation.grade_count = 3;
    simulation.law = options.law = law;
    simulation.pressure = 60;
    simulation.tolerance = 1e-7;
    check_done(simulate(&simulation, keep_state, &packing));
    const double *truth = packing.forces[0].contact.fn;
    static const enum force_method methods[] = {METHOD_CEM, METHOD_MAP};
    for (int k = 0; k < 2; k++) {
        struct forces forces;
        options.start = START_OVERLAP;
        check_done(infer_forces(&packing, &options, methods[k], &forces));
        for (size_t c = 0; c < packing.contacts.count; c++)
            if (forces.contact.status[c] != STATUS_NOT_USED)
                check_near(forces.contact.fn[c], truth[c], (k ? 1e-2 : 1e-6) * mean_truth(&packing));
        assert_true(k == 0 || forces.converged);
        forces_free(&forces);
    }
    packing_free(&packing);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(nearly_rigid_grains),     cmocka_unit_test(radii_of_twenty_to_one),
        cmocka_unit_test(noise_of_body_forces),    cmocka_unit_test(wall_mass_is_no_part_of_the_answer),
        cmocka_unit_test(strongest_contacts_lost), cmocka_unit_test(nonlinear_law),
    };
    return cmocka_run_group_tests(tests, draw_usual, forget);
}
