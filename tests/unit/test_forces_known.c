/* Known answers of the force methods: systems small enough to be solved by hand. */
#include <stdlib.h>

#include "tests/unit/discs.h"

#include "forces/infer_forces.h"
#include "forces/methods/cdm.h"
#include "pipeline/speak/error.h"

static struct force_options options_with(double kn, double mu)
{
    struct force_options options = FORCE_OPTIONS_DEFAULT;
    options.law.kn = kn;
    options.law.mu = mu;
    options.tolerance = 1e-11;
    return options;
}

/* Thesis Fig. 2.11: discs 0 and 1 fixed, disc 2 rests on both, branches at 45 degrees, P = 1530 N downwards. */
static void three_discs(struct packing *packing)
{
    const double radius = 5.7e-3, half = 2 * radius * sqrt(0.5);
    discs_begin(packing, 3);
    disc_put(packing, 0, -half, 0, radius);
    disc_put(packing, 1, half, 0, radius);
    disc_put(packing, 2, 0, half, radius);
    packing->grains.flags[0] = packing->grains.flags[1] = GRAIN_FIXED;
    packing->grains.load_y[2] = -1530;
    discs_touch(packing, 1e-9);
    assert_int_equal(packing->contacts.count, 2);
}

static void check_three_discs(enum force_method method, double inertia, double fn, uint32_t status)
{
    struct packing packing;
    struct forces forces;
    struct force_options options = options_with(5e7, 0.5);
    options.start = START_ZERO;
    three_discs(&packing);
    packing.grains.inertia[2] = inertia * packing.grains.mass[2] * pow(packing.grains.radius[2], 2);
    check_done(infer_forces(&packing, &options, method, &forces));
    for (size_t c = 0; c < 2; c++) {
        check_near(forces.contact.fn[c], fn, 1e-6);
        check_near(fabs(forces.contact.ft[c]), 1530 / sqrt(2) - fn, 1e-6); /* thesis (2.54) */
        assert_int_equal(forces.contact.status[c], status);
    }
    /* Both tangential forces push disc 2 up: t points to the upper left on the left contact, to the lower left on the
     * right one. */
    assert_true(forces.contact.ft[0] > 0 && forces.contact.ft[1] < 0);
    assert_true(forces.converged);
    check_near(forces.residual.residual_y[2], 0, 1e-6);
    forces_free(&forces);
    packing_free(&packing);
}

/* Fully mobilised: fn (1 + mu) = P / sqrt 2, that is 721.25 and 360.62 N (thesis 2.2.3.2). */
static void qsm_solves_the_three_discs_from_zero(void **state)
{
    (void)state;
    check_three_discs(METHOD_QSM, 0.5, 1530 / sqrt(2) / 1.5, STATUS_SLIP);
}

/* The same 721.25 N is the thesis's answer of contact dynamics with three degrees of freedom. It holds for an inertia
 * of m R^2; for that of a solid disc, m R^2 / 2, the answer is that of one degree of freedom, 811.40 N. */
static void cdm_solves_the_three_discs_from_zero(void **state)
{
    (void)state;
    check_three_discs(METHOD_CDM, 1, 1530 / sqrt(2) / 1.5, STATUS_SLIP);
    check_three_discs(METHOD_CDM, 0.5, 1530 / sqrt(2) * 0.75, STATUS_STICK);
}

/* Thesis 2.2.2.2: only the vertical motion of disc 2, both contacts alike. Static line: fn + ft = P / (2 sin 45). */
static void cdm_in_one_degree_of_freedom(void **state)
{
    (void)state;
    const double p = 1530, w[3] = {1, 0, 3}, half = sqrt(0.5); /* in 1/m; solid disc: R^2 / I = 2 / m */
    double fn = 0, ft = 0;
    for (int k = 0; k < 200; k++) {
        double fy = 2 * half * (fn + ft) - p;
        cdm_contact(w, 0.5, half * fy, half * fy, 1, &fn, &ft);
    }
    check_near(ft / fn, 1.0 / 3, 1e-12);
    check_near(fn, 811.40, 0.0051); /* printed with two decimals, cut */
    check_near(fn + ft, p / (2 * half), 1e-9);
}

/* Inside the range of thesis (2.53) every start that is in equilibrium is left alone. */
static void admissible_starts_stay(void **state)
{
    (void)state;
    struct packing packing;
    struct force_options options = options_with(5e7, 0.5);
    struct network network;
    struct network_options network_options = {.wall_mass = 100};
    three_discs(&packing);
    check_done(network_build(&packing, &options.law, &network_options, &network));
    const struct problem problem = {&packing, &network, &options};
    for (double mobilised = -1; mobilised <= 1; mobilised += 0.25) {
        double fn = 1530 / sqrt(2) / (1 + 0.5 * mobilised) / network.force, ft = 0.5 * mobilised * fn;
        double f[4] = {fn, ft, fn, -ft};
        struct outcome outcome;
        check_done(QSM_METHOD.solve(&problem, f, &outcome));
        check_near(f[0], fn, 1e-12);
        check_near(f[1], ft, 1e-12);
        check_done(CDM_METHOD.solve(&problem, f, &outcome));
        check_near(f[0], fn, 1e-12);
        options.start = START_PREVIOUS;
        check_done(MAP_METHOD.solve(&problem, f, &outcome));
        check_near(f[2], fn, 1e-9);
        check_near(f[3], -ft, 1e-9);
    }
    network_free(&network);
    packing_free(&packing);
}

/* The upper disc is pulled off the two lower ones: no pushing force balances that, and the proof is its motion upwards,
 * which opens both contacts and gains work from the load. */
static void pulled_off_is_infeasible(void **state)
{
    (void)state;
    struct packing packing;
    struct force_options options = options_with(5e7, 0.5);
    struct forces forces;
    three_discs(&packing);
    options.start = START_ZERO;
    for (int pulled = 0; pulled < 2; pulled++) {
        packing.grains.load_y[2] = pulled ? 1530 : -1530;
        for (int method = METHOD_CDM; method <= METHOD_MAP; method++) {
            check_done(infer_forces(&packing, &options, (enum force_method)method, &forces));
            assert_int_equal(forces.converged, !pulled);
            assert_int_equal(forces.infeasible, pulled);
            if (pulled) {
                assert_true(forces.ray.ray_y[2] > 0);
                check_near(forces.ray.ray_x[2] / forces.ray.ray_y[2], 0, 1e-6);
                check_near(forces.ray.ray_m[2] / forces.ray.ray_y[2], 0, 1e-6);
            }
            forces_free(&forces);
        }
    }
    packing_free(&packing);
}

/* mu = 0: one solution, fn = P / (2 sin 45). */
static void frictionless_discs_have_one_answer(void **state)
{
    (void)state;
    struct packing packing;
    three_discs(&packing);
    for (int method = METHOD_CDM; method <= METHOD_MAP; method++) {
        struct force_options options = options_with(5e7, 0);
        struct forces forces;
        check_done(infer_forces(&packing, &options, (enum force_method)method, &forces));
        check_near(forces.contact.fn[0], 1530 / sqrt(2), 1e-6);
        check_near(forces.contact.fn[1], 1530 / sqrt(2), 1e-6);
        check_near(forces.contact.ft[0], 0, 1e-9);
        forces_free(&forces);
    }
    packing_free(&packing);
}

/* Two discs on top of each other in a box, 3 N and 2 N of weight: 2 N between them, 5 N on the floor. */
static void column_under_gravity(void **state)
{
    (void)state;
    struct packing packing;
    discs_begin(&packing, 2);
    disc_put(&packing, 0, 0.5, 0.1, 0.1);
    disc_put(&packing, 1, 0.5, 0.3, 0.1);
    packing.grains.load_y[0] = -3, packing.grains.load_y[1] = -2;
    discs_box(&packing, 1, 1, 0);
    discs_touch(&packing, 1e-9);
    assert_int_equal(packing.contacts.count, 2);
    for (int method = METHOD_CDM; method <= METHOD_MAP; method++) {
        struct force_options options = options_with(1e6, 0.5);
        struct forces forces;
        options.start = START_ZERO;
        check_done(infer_forces(&packing, &options, (enum force_method)method, &forces));
        check_near(forces.contact.fn[0], 2, 1e-8); /* 0-1 */
        check_near(forces.contact.fn[1], 5, 1e-8); /* 0-floor */
        check_near(forces.contact.ft[0], 0, 1e-8);
        assert_true(forces.converged);
        forces_free(&forces);
    }
    packing_free(&packing);
}

static void square_lattice_in_a_box(void **state)
{
    (void)state;
    struct packing packing;
    const size_t nx = 5, ny = 4;
    discs_square_lattice(&packing, nx, ny, 0.01, 120, 150);
    assert_int_equal(packing.contacts.count, nx * (ny + 1) + ny * (nx + 1));
    for (int method = METHOD_CDM; method <= METHOD_MAP; method++) {
        struct force_options options = options_with(1e6, 0.5);
        struct forces forces;
        options.start = START_MEAN;
        options.tolerance = 1e-9;
        check_done(infer_forces(&packing, &options, (enum force_method)method, &forces));
        assert_true(forces.converged);
        /* 120 N over 0.08 m of height, 150 N over 0.1 m of width: 1500 N/m both */
        check_near(forces.stress[0][0], 1500, 1e-4);
        check_near(forces.stress[1][1], 1500, 1e-4);
        check_near(forces.stress[0][1], 0, 1e-4);
        for (size_t c = 0; c < forces.contact.count; c++)
            check_near(forces.contact.fn[c], 30, 1e-4);
        forces_free(&forces);
    }
    packing_free(&packing);
}

static void all_four_walls_loaded(void **state)
{
    (void)state;
    struct packing packing;
    struct network network;
    struct network_options network_options = {.wall_mass = 100};
    struct force_options options = options_with(1e6, 0.5);
    struct forces forces;
    discs_square_lattice(&packing, 3, 3, 0.01, 90, 60);
    discs_load_wall(&packing, "left", 90, 0);
    discs_load_wall(&packing, "bottom", 0, 63);
    check_done(network_build(&packing, &options.law, &network_options, &network));
    check_near(network.misfit[0], 0, 1e-12);
    check_near(network.misfit[1], 3, 1e-12);
    assert_true(network.wall_dof[walls_find(&packing.walls, "left")] < 0);
    assert_true(network.wall_dof[walls_find(&packing.walls, "bottom")] < 0);
    check_done(infer_forces(&packing, &options, METHOD_QSM, &forces));
    check_at_most(forces.imbalance, options.tolerance);
    assert_false(forces.converged); /* the grains are in balance, the loads are not: 3 N of 60 */
    assert_int_equal(forces.verdict, VERDICT_DOUBTFUL);
    check_near(forces.stress[1][1], 60 / 0.06, 1e-6);
    check_near(forces.misfit[1], 3, 1e-12);
    forces_free(&forces);
    discs_load_wall(&packing, "bottom", 0, NAN);
    check_done(infer_forces(&packing, &options, METHOD_QSM, &forces));
    assert_true(isnan(forces.misfit[0]) && isnan(forces.misfit[1]));
    assert_true(forces.converged);
    forces_free(&forces);
    network_free(&network);
    packing_free(&packing);
}

/* A grain pushed into the corner by (-10, -10) N rests on the convex corner disc, which is carried by the loads on the
 * left and the bottom wall. The contact stands twice in the table: duplicates share the force. */
static void corner_disc_acts_in_its_walls(void **state)
{
    (void)state;
    struct packing packing;
    const double r = 0.01, radius = 0.02, half = (r + radius) * sqrt(0.5);
    discs_begin(&packing, 1);
    disc_put(&packing, 0, half, half, r);
    packing.grains.load_x[0] = packing.grains.load_y[0] = -10;
    discs_box(&packing, 2 * half, 2 * half, 1);
    memcpy(packing.walls.name[4], "bottom-left", 11);
    packing.walls.x0[4] = packing.walls.y0[4] = 0, packing.walls.radius[4] = radius;
    discs_load_wall(&packing, "left", 10, 0);
    discs_load_wall(&packing, "bottom", 0, 10);
    check_done(table_alloc(&CONTACTS, &packing.contacts, 2, TOUCH_COLUMNS));
    for (size_t c = 0; c < 2; c++)
        touch_put(&packing, c, 0, 1 + 4, vec(-sqrt(0.5), -sqrt(0.5)), vec(half - r * sqrt(0.5), half - r * sqrt(0.5)),
                  0);
    for (int method = METHOD_CDM; method <= METHOD_MAP; method++) {
        struct force_options options = options_with(1e6, 0.5);
        struct forces forces;
        options.start = START_ZERO;
        check_done(infer_forces(&packing, &options, (enum force_method)method, &forces));
        assert_true(forces.converged);
        check_near(forces.contact.fn[0] + forces.contact.fn[1], 10 * sqrt(2), 1e-8);
        forces_free(&forces);
    }
    packing_free(&packing);
}

/* Stiffness 1e6 N/m, two states: the motion between them moves the forces, slips at mu fn, opens at fn = 0. */
static void cem_follows_the_motions(void **state)
{
    (void)state;
    struct packing packing, before;
    struct forces forces;
    struct force_options options = options_with(1e6, 0.5);
    three_discs(&packing), three_discs(&before);
    check_done(table_add(&CONTACTS, &packing.contacts, "dun"));
    check_done(table_add(&CONTACTS, &packing.contacts, "dut"));
    before.forces = calloc(1, sizeof *before.forces), before.force_count = 1;
    check_done(table_alloc(&CONTACT_FORCES, &before.forces->contact, 2, NULL));
    strcpy(before.forces->method, "dem");
    before.forces->contact.fn[0] = 100, before.forces->contact.ft[0] = 20;
    before.forces->contact.fn[1] = 100, before.forces->contact.ft[1] = -20;
    packing.contacts.dun[0] = -50e-6, packing.contacts.dut[0] = 10e-6; /* closes by 50 N, ft falls by 10 N */
    packing.contacts.dun[1] = 20e-6, packing.contacts.dut[1] = 30e-6;  /* 80 N, -50 N: slips at -40 N */
    options.previous = &before;
    check_done(infer_forces(&packing, &options, METHOD_CEM, &forces));
    check_near(forces.contact.fn[0], 150, 1e-9);
    check_near(forces.contact.ft[0], 10, 1e-9);
    check_near(forces.contact.fn[1], 80, 1e-9);
    check_near(forces.contact.ft[1], -40, 1e-9);
    assert_int_equal(forces.contact.status[1], STATUS_SLIP);
    assert_false(forces.converged); /* nothing makes these forces balance 1530 N */
    forces_free(&forces);
    packing.contacts.dun[1] = 200e-6;
    check_done(infer_forces(&packing, &options, METHOD_CEM, &forces));
    check_near(forces.contact.fn[1], 0, 0);
    assert_int_equal(forces.contact.status[1], STATUS_OPEN);
    forces_free(&forces);
    packing_free(&packing);
    packing_free(&before);
}

static void three_discs_before(struct packing *before)
{
    three_discs(before);
    before->forces = calloc(1, sizeof *before->forces), before->force_count = 1;
    check_done(table_alloc(&CONTACT_FORCES, &before->forces->contact, 2, NULL));
    strcpy(before->forces->method, "cem");
    before->forces->contact.fn[0] = 100, before->forces->contact.ft[0] = 20;
    before->forces->contact.fn[1] = 100, before->forces->contact.ft[1] = -20;
}

/* Contact 0 follows its motion; of contact 1 something is not known: then its force is not either, nor the balance of
 * the grains there. */
static void cem_does_not_invent(void **state)
{
    (void)state;
    struct packing packing, before;
    struct forces forces;
    struct force_options options = options_with(1e6, 0.5);
    three_discs(&packing), three_discs_before(&before);
    check_done(table_add(&CONTACTS, &packing.contacts, "dun"));
    check_done(table_add(&CONTACTS, &packing.contacts, "dut"));
    double *const unknown[] = {&packing.contacts.dun[1], &before.forces->contact.fn[1], &packing.contacts.dut[1],
                               &before.forces->contact.ft[1]};
    options.previous = &before;
    for (int k = 0; k < 4; k++) {
        for (int c = 0; c < 2; c++)
            packing.contacts.dun[c] = -50e-6, packing.contacts.dut[c] = 10e-6;
        double known = *unknown[k];
        *unknown[k] = NAN;
        check_done(infer_forces(&packing, &options, METHOD_CEM, &forces));
        check_near(forces.contact.fn[0], 150, 1e-9);
        check_near(forces.contact.ft[0], 10, 1e-9);
        assert_int_equal(forces.contact.status[0], STATUS_STICK);
        if (k < 2)
            assert_true(isnan(forces.contact.fn[1]));
        else /* what is tangential says nothing of the normal force */
            check_near(forces.contact.fn[1], 150, 1e-9);
        assert_true(isnan(forces.contact.ft[1]));
        assert_int_equal(forces.contact.status[1], STATUS_NOT_USED);
        assert_false(forces.converged);
        assert_true(isnan(forces.imbalance));
        assert_true(forces_unbalanced_grains(&packing, &forces, 1e9) > 0);
        forces_free(&forces);
        *unknown[k] = known;
    }
    packing.contacts.flags[1] |= CONTACT_NEW; /* was near at most: no increment, which is known */
    packing.contacts.dun[1] = packing.contacts.dut[1] = NAN;
    check_done(infer_forces(&packing, &options, METHOD_CEM, &forces));
    check_near(forces.contact.fn[1], 100, 1e-9);
    check_near(forces.contact.ft[1], -20, 1e-9);
    forces_free(&forces);
    packing_free(&packing);
    packing_free(&before);
}

/* Without any motion the forces would be those of the state before; a start that is not known cannot be held. */
static void cem_needs_motions(void **state)
{
    (void)state;
    struct packing packing, before;
    struct forces forces;
    struct force_options options = options_with(1e6, 0.5);
    three_discs(&packing), three_discs_before(&before);
    options.previous = &before;
    for (int k = 0; k < 2; k++) {
        assert_int_equal(infer_forces(&packing, &options, METHOD_CEM, &forces), -1);
        assert_int_equal(error_status(), EXIT_INPUT);
        assert_non_null(strstr(error_message(), "--previous"));
        check_done(table_add(&CONTACTS, &packing.contacts, "dun")); /* all NaN */
    }
    before.forces->contact.ft[1] = NAN;
    options.start = START_PREVIOUS;
    check_done(infer_forces(&packing, &options, METHOD_QSM, &forces));
    forces_free(&forces);
    options.fix = FIX_NORMAL;
    assert_int_equal(infer_forces(&packing, &options, METHOD_QSM, &forces), -1);
    assert_int_equal(error_status(), EXIT_INPUT);
    packing_free(&packing);
    packing_free(&before);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(qsm_solves_the_three_discs_from_zero),
        cmocka_unit_test(cdm_solves_the_three_discs_from_zero),
        cmocka_unit_test(cdm_in_one_degree_of_freedom),
        cmocka_unit_test(pulled_off_is_infeasible),
        cmocka_unit_test(admissible_starts_stay),
        cmocka_unit_test(frictionless_discs_have_one_answer),
        cmocka_unit_test(column_under_gravity),
        cmocka_unit_test(square_lattice_in_a_box),
        cmocka_unit_test(all_four_walls_loaded),
        cmocka_unit_test(corner_disc_acts_in_its_walls),
        cmocka_unit_test(cem_follows_the_motions),
        cmocka_unit_test(cem_does_not_invent),
        cmocka_unit_test(cem_needs_motions),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
