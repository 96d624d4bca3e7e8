/* Where the energy goes: nowhere without friction and dashpots; into heat that is accounted for with them. And the
 * same bits from one thread and from several. */
#include "tests/check.h"

#include <math.h>
#include <omp.h>
#include <stdlib.h>
#include <string.h>

#include "simulation/dem/dem_motion.h"

static const double PI = 3.141592653589793;
enum { DISCS = 30 };

/* Discs that fly about in a box, and the shortest period: of a pair of the smallest ones between two others. */
static double gas(struct dem *dem, struct contact_law law, size_t count, double speed)
{
    uint64_t random = 5;
    size_t columns = (size_t)ceil(sqrt((double)count));
    check_done(dem_alloc(dem, count));
    dem->law = law;
    dem->mu = law.mu, dem->mu_wall = law.mu_wall;
    dem->skin = 0.003;
    dem->box.given = 1;
    dem->box.size[BOX_WIDTH] = dem->box.size[BOX_HEIGHT] = 0.0205 * (double)columns;
    for (int f = 0; f < BOX_FREEDOMS; f++)
        dem->box.worked_size[f] = dem->box.size[f];
    for (size_t k = 0; k < count; k++) {
        struct dem_grain *g = &dem->grains[k];
        g->radius = 0.008 + 0.002 * check_uniform(&random);
        g->mass = 1000 * PI * g->radius * g->radius;
        g->inertia = 0.5 * g->mass * g->radius * g->radius;
        g->x = 0.0205 * ((double)(k % columns) + 0.5), g->y = 0.0205 * ((double)(k / columns) + 0.5);
        g->vx = speed * check_normal(&random), g->vy = speed * check_normal(&random);
        g->spin = speed / 0.01 * check_normal(&random);
    }
    return 2 * PI * sqrt(1000 * PI * 0.008 * 0.008 / (4 * 1e6));
}

/* Largest departure of kinetic + stored + lost - work from its first value, over the kinetic energy, in the time T;
 * velocities at full steps are means of those at half steps. */
static double drift(struct dem *dem, const struct servo *servo, double dt, double duration, double *lost)
{
    struct stepping stepping = {.dt = dt};
    struct dem_grain *before = malloc(dem->count * sizeof *before);
    double first = 0, kinetic = 0, largest = 0;
    for (long n = 0; (double)n * dt < duration; n++) {
        memcpy(before, dem->grains, dem->count * sizeof *before);
        check_done(dem_step(dem, servo, &stepping));
        struct dem_energy energy = dem_energy(dem);
        energy.kinetic = 0;
        for (size_t k = 0; k < dem->count; k++) {
            const struct dem_grain *g = &dem->grains[k], *b = &before[k];
            energy.kinetic += 0.125 * g->mass * (pow(g->vx + b->vx, 2) + pow(g->vy + b->vy, 2)) +
                              0.125 * g->inertia * pow(g->spin + b->spin, 2);
        }
        double sum = energy.kinetic + energy.stored + energy.lost - dem->box.work;
        if (n == 0)
            first = sum, kinetic = energy.kinetic;
        largest = fmax(largest, fabs(sum - first) / kinetic);
        *lost = energy.lost / kinetic;
    }
    free(before);
    return largest;
}

static double drift_between(struct contact_law law, const struct servo *servo, double corner_radius,
                            double steps_per_period, double *lost)
{
    struct dem dem;
    double period = gas(&dem, law, DISCS, 0.5);
    dem.box.corner_radius = corner_radius;
    double largest = drift(&dem, servo, period / steps_per_period, 60 * period, lost);
    assert_true(dem.searches > 1);
    dem_free(&dem);
    return largest;
}

static double drift_of(struct contact_law law, const struct servo *servo, double steps_per_period, double *lost)
{
    return drift_between(law, servo, 0, steps_per_period, lost);
}

static void nothing_is_lost_without_friction(void **state)
{
    (void)state;
    struct contact_law law = {.kn = 1e6, .kt_over_kn = 1};
    struct servo held = {0};
    double lost, coarse = drift_of(law, &held, 100, &lost), fine = drift_of(law, &held, 1000, &lost);
    print_message("drift %.2e at 1/100, %.2e at 1/1000 of the shortest period\n", coarse, fine);
    check_near(lost, 0, 1e-12);
    check_at_most(fine, 1e-6);
    check_near(log10(coarse / fine), 2, 0.5);
}

/* A wall that moves works on the grains; friction at grains and walls takes much of it. */
static void friction_is_accounted_for(void **state)
{
    (void)state;
    struct contact_law law = {.kn = 1e6, .kt_over_kn = 0.7, .mu = 0.3, .mu_wall = 0.2};
    struct servo servo = {.hold = {HOLD_RATE, HOLD_SIZE, HOLD_RATE}, .rate = {-0.05, 0, 0.3}};
    double lost, coarse = drift_of(law, &servo, 300, &lost), fine = drift_of(law, &servo, 3000, &lost);
    print_message("with friction: lost %.3f, does not close by %.2e at 1/300, %.2e at 1/3000\n", lost, coarse, fine);
    assert_true(lost > 0.05);
    check_at_most(fine, 1e-4);
    check_at_most(fine, 0.2 * coarse);
}

/* Discs in the corners that move with all freedoms of the box: their work counts too. */
static void corner_discs_work_too(void **state)
{
    (void)state;
    struct contact_law law = {.kn = 1e6, .kt_over_kn = 0.7, .mu = 0.3, .mu_wall = 0.2};
    struct servo servo = {.hold = {HOLD_RATE, HOLD_RATE, HOLD_RATE}, .rate = {-0.05, -0.05, 0.3}};
    double lost, coarse = drift_between(law, &servo, 0.0042, 300, &lost);
    double fine = drift_between(law, &servo, 0.0042, 3000, &lost);
    print_message("with corner discs: lost %.3f, does not close by %.2e at 1/300, %.2e at 1/3000\n", lost, coarse,
                  fine);
    check_at_most(fine, 1e-4);
    check_at_most(fine, 0.2 * coarse);
}

static void curved_laws_store_what_they_give_back(void **state)
{
    (void)state;
    static const struct law *const rows[] = {&hertz_mindlin_law, &pohrt_popov_law};
    for (size_t k = 0; k < 2; k++) {
        struct contact_law law = {
            .row = rows[k], .young = 1e8, .poisson = 0.3, .kt_over_kn = 1.4 / 1.7, .fractal = 2.2, .roughness = 1e-5};
        struct servo held = {0};
        double lost, largest = drift_of(law, &held, 1000, &lost);
        check_near(lost, 0, 1e-12);
        check_at_most(largest, 1e-4);
    }
}

static void threads_give_the_same_bits(void **state)
{
    (void)state;
    struct contact_law law = {.kn = 1e6, .kt_over_kn = 1, .mu = 0.3, .mu_wall = 0.2};
    struct servo servo = {
        .hold = {HOLD_STRESS, HOLD_STRESS, HOLD_SIZE}, .stress_x = 2e3, .stress_y = 2e3, .fastest = INFINITY};
    struct dem dem[3];
    int most = omp_get_max_threads();
    for (int run = 0; run < 3; run++) {
        double period = gas(&dem[run], law, 700, 0.1);
        dem[run].parallel_from = run ? 1 : 1000000;
        omp_set_num_threads(run == 2 ? 2 : 1);
        struct stepping stepping = {.dt = period / 50};
        for (int n = 0; n < 250; n++)
            check_done(dem_step(&dem[run], &servo, &stepping));
        struct patience patience = {1e-3, 100, 1e6};
        long steps = 0;
        assert_true(dem_relax(&dem[run], &servo, &patience, &steps) >= 0);
    }
    omp_set_num_threads(most);
    for (int run = 1; run < 3; run++) {
        assert_memory_equal(dem[run].grains, dem[0].grains, 700 * sizeof *dem[0].grains);
        assert_memory_equal(dem[run].box.size, dem[0].box.size, sizeof dem[0].box.size);
        assert_int_equal(dem[run].pair_count, dem[0].pair_count);
    }
    for (int run = 0; run < 3; run++)
        dem_free(&dem[run]);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(nothing_is_lost_without_friction),
        cmocka_unit_test(friction_is_accounted_for),
        cmocka_unit_test(corner_discs_work_too),
        cmocka_unit_test(curved_laws_store_what_they_give_back),
        cmocka_unit_test(threads_give_the_same_bits),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
