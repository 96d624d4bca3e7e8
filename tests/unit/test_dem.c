/* The mechanics of simulate: conservation, impacts against their closed forms, pairs against all pairs. */
#include "tests/check.h"

#include <math.h>
#include <stdlib.h>

#include "simulation/dem/dem_motion.h"

static const double PI = 3.141592653589793;
static const struct servo HELD = {0};

/* Discs of the given radius and density without walls or gravity. */
static void discs(struct dem *dem, size_t count, double radius, double mu)
{
    check_done(dem_alloc(dem, count));
    dem->law = (struct contact_law){.row = &linear_law, .kn = 1e6, .kt_over_kn = 0.8, .mu = mu};
    dem->mu = mu;
    dem->skin = 0.3 * radius;
    for (size_t k = 0; k < count; k++) {
        double r = dem->grains[k].radius = radius;
        dem->grains[k].mass = 500 * PI * r * r;
        dem->grains[k].inertia = 0.5 * dem->grains[k].mass * r * r;
    }
}

static void advance(struct dem *dem, double dt, long steps)
{
    struct stepping stepping = {.dt = dt};
    for (long k = 0; k < steps; k++)
        check_done(dem_step(dem, &HELD, &stepping));
}

static void momenta(const struct dem *dem, double sums[3], double sizes[3])
{
    for (int c = 0; c < 3; c++)
        sums[c] = sizes[c] = 0;
    for (size_t k = 0; k < dem->count; k++) {
        const struct dem_grain *g = &dem->grains[k];
        double part[3] = {g->mass * g->vx, g->mass * g->vy,
                          g->mass * (g->x * g->vy - g->y * g->vx) + g->inertia * g->spin};
        for (int c = 0; c < 3; c++)
            sums[c] += part[c], sizes[c] += fabs(part[c]);
    }
}

static double kinetic(const struct dem *dem)
{
    double energy = 0;
    for (size_t k = 0; k < dem->count; k++) {
        const struct dem_grain *g = &dem->grains[k];
        energy += 0.5 * g->mass * (g->vx * g->vx + g->vy * g->vy) + 0.5 * g->inertia * g->spin * g->spin;
    }
    return energy;
}

static void momentum_is_conserved(void **state)
{
    (void)state;
    struct dem dem;
    uint64_t random = 7;
    double before[3], after[3], sizes[3];
    discs(&dem, 36, 0.01, 0.4);
    dem.damping_ratio = 0.2;
    for (size_t k = 0; k < dem.count; k++) {
        struct dem_grain *g = &dem.grains[k];
        g->radius *= 0.6 + 0.4 * check_uniform(&random);
        g->x = 0.021 * (double)(k % 6), g->y = 0.021 * (double)(k / 6);
        g->vx = -4 * (g->x - 0.05) + check_normal(&random), g->vy = -4 * (g->y - 0.05) + check_normal(&random);
        g->spin = 20 * check_normal(&random);
    }
    double energy = kinetic(&dem);
    momenta(&dem, before, sizes);
    advance(&dem, 0.02 * dem_time_unit(&dem, dem.law.kn), 20000);
    momenta(&dem, after, sizes);
    assert_true(dem.searches > 1);
    check_at_most(kinetic(&dem), 0.7 * energy); /* they did collide */
    for (int c = 0; c < 3; c++)
        check_near(after[c], before[c], 1e-11 * sizes[c]);
    dem_free(&dem);
}

/* Two equal discs meet: relative normal velocity before and after. */
static double rebound(double restitution)
{
    struct dem dem;
    discs(&dem, 2, 0.01, 0);
    dem.damping_ratio = dem_damping_ratio(restitution);
    dem.grains[0].vx = 0.1, dem.grains[1].vx = -0.1;
    dem.grains[1].x = 0.0201;
    advance(&dem, 0.001 * dem_time_unit(&dem, dem.law.kn), 8000);
    double ratio = (dem.grains[1].vx - dem.grains[0].vx) / 0.2;
    assert_int_equal(dem.pairs[0].touching, 0);
    dem_free(&dem);
    return ratio;
}

static void restitution_is_as_specified(void **state)
{
    (void)state;
    static const double wanted[] = {1, 0.95, 0.7, 0.3, 0.14};
    for (size_t k = 0; k < sizeof wanted / sizeof *wanted; k++)
        check_near(rebound(wanted[k]), wanted[k], 2e-3);
}

/* An oblique impact of disc 1 on disc 0, equal and elastic; gives the relative velocity at the contact afterwards. */
static void oblique(double mu, double vn, double vt, double *un, double *ut, double *spin)
{
    struct dem dem;
    discs(&dem, 2, 0.01, mu);
    dem.law.kn = 1e10; /* so short that the normal does not turn meanwhile */
    dem.grains[1].x = 0.02 + 1e-9;
    dem.grains[1].vx = -vn, dem.grains[1].vy = vt;
    advance(&dem, 0.001 * dem_time_unit(&dem, dem.law.kn), 4000);
    double nx = dem.grains[1].x - dem.grains[0].x, ny = dem.grains[1].y - dem.grains[0].y, d = hypot(nx, ny);
    double vx = dem.grains[1].vx - dem.grains[0].vx, vy = dem.grains[1].vy - dem.grains[0].vy;
    *un = (vx * nx + vy * ny) / d;
    *ut = (vy * nx - vx * ny) / d - 0.01 * (dem.grains[0].spin + dem.grains[1].spin);
    *spin = dem.grains[0].spin;
    assert_int_equal(dem.pairs[0].touching, 0);
    dem_free(&dem);
}

/* Sliding all along (|ft| = mu fn): the tangential impulse
 * is mu times the normal one, m vn; sticking all along: the tangential spring swings with (3 kt / m*)^1/2 for the
 * time pi (m* / kn)^1/2 of the contact. */
static void oblique_impact_matches_the_closed_forms(void **state)
{
    (void)state;
    double vn = 0.002, un, ut, spin;
    oblique(0.1, vn, 5 * vn, &un, &ut, &spin);
    check_near(un, vn, 1e-3 * vn);
    check_near(ut, 5 * vn - 3 * 0.1 * 2 * vn, 2e-3 * vn); /* impulse J: dut = 3 J / m*, J = mu 2 vn m* */
    double mass = 500 * PI * 1e-4;
    check_near(spin, 0.1 * mass * vn * 0.01 / (0.5 * mass * 1e-4), 2e-3 * vn / 0.01);
    oblique(1e9, vn, 0.5 * vn, &un, &ut, &spin);
    check_near(un, vn, 1e-3 * vn);
    check_near(ut, 0.5 * vn * cos(PI * sqrt(3 * 0.8)), 2e-3 * vn);
}

static void a_wall_throws_a_disc_back(void **state)
{
    (void)state;
    struct dem dem;
    discs(&dem, 1, 0.01, 0);
    dem.damping_ratio = dem_damping_ratio(0.5);
    dem.box.given = 1;
    dem.box.size[BOX_WIDTH] = dem.box.size[BOX_HEIGHT] = 0.05;
    dem.grains[0].x = 0.025, dem.grains[0].y = 0.011, dem.grains[0].vy = -0.1;
    advance(&dem, 0.001 * dem_time_unit(&dem, dem.law.kn), 30000);
    check_near(dem.grains[0].vy, 0.05, 2e-4);
    check_near(dem.grains[0].x, 0.025, 0);
    dem_free(&dem);
}

/* The pairs in touch after a walk of random steps are those that all pairs give, and springs survive the searches. */
static void no_pair_is_overlooked(void **state)
{
    (void)state;
    struct dem dem;
    uint64_t random = 11;
    discs(&dem, 150, 0.01, 0.5);
    dem.box.given = 1;
    dem.box.size[BOX_WIDTH] = 0.24, dem.box.size[BOX_HEIGHT] = 0.2;
    for (size_t k = 0; k < dem.count; k++) {
        dem.grains[k].radius = 0.004 + 0.006 * check_uniform(&random);
        dem.grains[k].x = 0.24 * check_uniform(&random), dem.grains[k].y = 0.2 * check_uniform(&random);
    }
    for (int walk = 0; walk < 60; walk++) {
        check_done(dem_forces_static(&dem, 0));
        size_t touching = 0, expected = 0;
        for (size_t p = 0; p < dem.pair_count; p++)
            touching += (size_t)dem.pairs[p].touching;
        for (size_t i = 0; i < dem.count; i++) {
            const struct dem_grain *g = &dem.grains[i];
            for (size_t j = i + 1; j < dem.count; j++)
                expected += hypot(g->x - dem.grains[j].x, g->y - dem.grains[j].y) < g->radius + dem.grains[j].radius;
            expected += (size_t)((g->x < g->radius) + (g->y < g->radius) + (0.24 - g->x < g->radius) +
                                 (dem.box.size[BOX_HEIGHT] - g->y < g->radius));
        }
        assert_int_equal(touching, expected);
        for (size_t k = 0; k < dem.count; k++) {
            dem.grains[k].x += 0.0006 * check_normal(&random), dem.grains[k].y += 0.0006 * check_normal(&random);
        }
        dem.box.size[BOX_HEIGHT] -= 0.0003;
    }
    assert_in_range(dem.searches, 2, 60);
    dem_free(&dem);
}

/* A disc pressed on another keeps its friction force while the skin is searched anew. */
static void friction_survives_a_search(void **state)
{
    (void)state;
    struct dem dem;
    discs(&dem, 3, 0.01, 0.5);
    dem.grains[1].x = 0.0199;
    dem.grains[2].x = 0.06;
    check_done(dem_forces_static(&dem, 0));
    dem.grains[1].vy = 1e-3;
    check_done(dem_forces_static(&dem, 1e-2));
    double ft = dem.pairs[0].spring.ft;
    check_near(ft, -1e6 * 0.8 * 1e-5, 1e-9);
    size_t searches = dem.searches;
    dem.grains[1].vy = 0;
    dem.grains[2].x = 0.0395;
    check_done(dem_forces_static(&dem, 1e-2));
    assert_int_equal(dem.searches, searches + 1);
    assert_int_equal(dem.pair_count, 2);
    check_near(dem.pairs[0].spring.ft, ft, 0);
    dem_free(&dem);
}

/* A row of discs that overlap by x, held: linear, then Hertz, then linear again, with copies in between. */
static void the_law_changes_while_a_packing_runs(void **state)
{
    (void)state;
    struct dem dem, copy;
    const struct contact_law linear = {.row = &linear_law, .kn = 1e6, .kt_over_kn = 0.8};
    struct contact_law hertz = {.row = &hertz_mindlin_law, .kn = NAN, .mu = 0.4};
    contact_law_set_grains(&hertz, 1e9, 0.3);
    double x = 1e-5, modulus = 1e9 / (2 * (1 - 0.09)), by_hertz = 4.0 / 3 * modulus * sqrt(0.005) * pow(x, 1.5);
    discs(&dem, 12, 0.01, 0.4);
    for (size_t k = 0; k < dem.count; k++)
        dem.grains[k].x = (double)k * (0.02 - x), dem.grains[k].fixed = 1;
    for (int turn = 0; turn < 3; turn++) {
        const struct contact_law *law = turn == 1 ? &hertz : &linear;
        double force = turn == 1 ? by_hertz : 1e6 * x;
        check_done(turn ? dem_change_law(&dem, law) : dem_forces(&dem, 0));
        assert_true(isfinite(dem_energy(&dem).stored)); /* at once, not from the next forces on */
        check_done(dem_copy(&dem, &copy));
        check_done(dem_forces(&dem, 0));
        check_done(dem_forces(&copy, 0));
        assert_int_equal(dem.pair_count, 11);
        for (size_t p = 0; p < 11; p++) {
            check_near(dem.pairs[p].fn, force, 1e-9 * force);
            check_near(copy.pairs[p].fn, force, 1e-9 * force);
        }
        check_near(dem_energy(&dem).stored, 11 * force * x * (turn == 1 ? 0.4 : 0.5), 1e-9 * 11 * force * x);
        dem_free(&copy);
    }
    dem_free(&dem);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(momentum_is_conserved),
        cmocka_unit_test(restitution_is_as_specified),
        cmocka_unit_test(oblique_impact_matches_the_closed_forms),
        cmocka_unit_test(a_wall_throws_a_disc_back),
        cmocka_unit_test(no_pair_is_overlooked),
        cmocka_unit_test(friction_survives_a_search),
        cmocka_unit_test(the_law_changes_while_a_packing_runs),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
