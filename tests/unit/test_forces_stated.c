/* Definitions that results of forces and of stress hold to: intervals and variances of draws and walks, inertia of
 * grains that come without one, forces scaled to the loads, the moment of a single heavy grain. */
#include <stdlib.h>

#include "tests/unit/discs.h"

#include "forces/infer_forces.h"
#include "forces/network/evidence.h"
#include "forces/questions/walk.h"
#include "pipeline/packing/stress.h"

static struct force_options options_with(double kn, double mu)
{
    struct force_options options = FORCE_OPTIONS_DEFAULT;
    options.law.kn = kn;
    options.law.mu = mu;
    return options;
}

/* Disc 2 rests on the fixed discs 0 and 1, branches at 45 degrees, P = 1530 N downwards (thesis Fig. 2.11). */
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
}

/* A grain without mass and inertia is a solid disc, I = m R^2 / 2: cdm answers 811.40 N as with them. */
static void grains_without_inertia_are_solid(void **state)
{
    (void)state;
    struct packing packing;
    struct forces forces;
    struct force_options options = options_with(5e7, 0.5);
    options.start = START_ZERO;
    options.tolerance = 1e-11;
    three_discs(&packing);
    free(packing.grains.mass);
    free(packing.grains.inertia);
    packing.grains.mass = packing.grains.inertia = NULL;
    check_done(infer_forces(&packing, &options, METHOD_CDM, &forces));
    for (size_t c = 0; c < 2; c++)
        check_near(forces.contact.fn[c], 1530 / sqrt(2) * 0.75, 1e-6);
    forces_free(&forces);
    packing_free(&packing);
}

/* A walk of one jump has two states a and b, d apart: standard deviation d / sqrt(2), quantiles of 5 and 95 % that are
 * 0.9 d apart, V = d^2 / 2 / <fn>^2 and R = d / <fn> in the mean over the contacts. */
static void a_walk_of_one_jump(void **state)
{
    (void)state;
    struct packing packing;
    struct forces forces;
    struct force_options options = options_with(5e7, 0.5);
    options.walk = 1;
    three_discs(&packing);
    check_done(infer_forces(&packing, &options, METHOD_QSM, &forces));
    check_done(walk_forces(&packing, &options, METHOD_QSM, &forces));
    check_near(forces.walk.states, 2, 0);
    double squares = 0, ranges = 0, mean = 0.5 * (forces.contact.fn[0] + forces.contact.fn[1]);
    for (size_t c = 0; c < 2; c++) {
        double d = (forces.contact.fn_max[c] - forces.contact.fn_min[c]) / 0.9;
        assert_true(d > 1e-3 * mean);
        check_near(forces.contact.s_fn[c], d / sqrt(2), 1e-9 * d);
        squares += d * d / 4, ranges += d / 2;
    }
    check_near(forces.walk.variance[0], squares / (mean * mean), 1e-9);
    check_near(forces.walk.range[0], ranges / mean, 1e-9);
    forces_free(&forces);
    packing_free(&packing);
}

/* The stated interval holds 90 % of a normal distribution: 1.645 standard deviations to each side, not below 0. */
static void intervals_of_draws(void **state)
{
    (void)state;
    struct packing packing;
    struct forces forces;
    struct force_options options = options_with(5e7, 0.5);
    options.samples = 10;
    three_discs(&packing);
    check_done(infer_forces(&packing, &options, METHOD_MAP, &forces));
    for (size_t c = 0; c < 2; c++) {
        double fn = forces.contact.fn[c], s = forces.contact.s_fn[c];
        assert_true(s > 0);
        check_near(forces.contact.fn_max[c], fn + 1.645 * s, 1e-3 * s);
        check_near(forces.contact.fn_min[c], fmax(0, fn - 1.645 * s), 1e-3 * s);
    }
    forces_free(&forces);
    packing_free(&packing);
}

/* What overlaps leave open is drawn towards the mean normal force, 1 in working units, with a standard deviation of
 * three times that (docs/forces.md), and towards no tangential force. */
static void forces_are_expected_at_their_mean(void **state)
{
    (void)state;
    struct packing packing;
    struct network network;
    struct evidence evidence;
    struct network_options network_options = {.wall_mass = 100};
    struct force_options options = options_with(5e7, 0.5);
    options.start = START_OVERLAP;
    three_discs(&packing);
    check_done(network_build(&packing, &options.law, &network_options, &network));
    double f[4] = {2, 0.1, 2, -0.1};
    check_done(evidence_build(&packing, &network, &options, f, &evidence));
    for (int c = 0; c < 2; c++) {
        check_near(evidence.prior[2 * c], 1, 0);
        check_near(evidence.variance[2 * c], 9, 0);
        check_near(evidence.prior[2 * c + 1], 0, 0);
    }
    evidence_free(&evidence);
    network_free(&network);
    packing_free(&packing);
}

/* Overlaps at a stiffness that is three times too large, scaled to the loads of the walls: 30 N at every contact of the
 * lattice, as without any balance being sought. */
static void overlaps_are_scaled_to_the_loads(void **state)
{
    (void)state;
    struct packing packing;
    struct forces forces;
    struct force_options options = options_with(3e6, 0.5);
    options.rescale = 1;
    options.start = START_OVERLAP;
    discs_square_lattice(&packing, 5, 4, 0.01, 120, 150);
    for (size_t c = 0; c < packing.contacts.count; c++)
        packing.contacts.overlap[c] = 30 / 1e6;
    check_done(infer_forces(&packing, &options, METHOD_CEM, &forces));
    for (size_t c = 0; c < packing.contacts.count; c++)
        check_near(forces.contact.fn[c], 30, 0.1);
    forces_free(&forces);
    packing_free(&packing);
}

/* One grain of 7 N at a quarter of the height, which the bottom bears: sum F_y y / A = 7 y / A, whatever the middle. */
static void stress_of_one_heavy_grain(void **state)
{
    (void)state;
    struct packing packing;
    double sigma[2][2];
    discs_begin(&packing, 1);
    disc_put(&packing, 0, 0.9, 0.5, 0.5);
    packing.grains.load_x[0] = 0;
    packing.grains.load_y[0] = -7;
    discs_box(&packing, 1.5, 2, 0);
    for (size_t w = 0; w < 4; w++)
        packing.walls.fx[w] = packing.walls.fy[w] = 0;
    packing.walls.fy[0] = NAN;
    stress_applied(&packing, 3, sigma);
    check_near(sigma[1][1], 7 * 0.5 / 3, 1e-12);
    check_near(sigma[0][0], 0, 1e-12);
    packing_free(&packing);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(grains_without_inertia_are_solid),
        cmocka_unit_test(a_walk_of_one_jump),
        cmocka_unit_test(intervals_of_draws),
        cmocka_unit_test(forces_are_expected_at_their_mean),
        cmocka_unit_test(overlaps_are_scaled_to_the_loads),
        cmocka_unit_test(stress_of_one_heavy_grain),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
