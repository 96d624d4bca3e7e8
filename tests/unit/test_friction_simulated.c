/* Friction from simulations whose mu is known: the three-rod test, and where the forces of a sheared packing end. */
#include "tests/check.h"

#include <math.h>
#include <string.h>

#include "calibration/rods/friction.h"
#include "pipeline/speak/error.h"
#include "tests/kept_states.h"

static const double DEGREE = 0.017453292519943295;
static const double ARM = 0.03, FIXED_RADIUS = 0.03, RADIUS = 0.02, P1 = 3;

/* Does rod C stay, between the weights P1 and p2 at equal arms? */
static int stays(double alpha, double mu, double p2)
{
    double reach = FIXED_RADIUS + RADIUS, x = reach * sin(alpha), y = reach * cos(alpha);
    struct placed_disc discs[] = {{-x, 0, FIXED_RADIUS, 0, 0, 1, 0},
                                  {x, 0, FIXED_RADIUS, 0, 0, 1, 0},
                                  {0, y, RADIUS, 0, -(P1 + p2), 0, -(p2 - P1) * ARM}};
    struct simulation simulation = SIMULATION_DEFAULT;
    struct kept_states kept = {0};
    simulation.discs = discs;
    simulation.disc_count = 3;
    simulation.law = (struct contact_law){.row = &linear_law, .kn = 1e8, .kt_over_kn = 0.8, .mu = mu};
    simulation.max_steps = 20000;
    int status = simulate(&simulation, keep_state, &kept);
    assert_true(status >= 0);
    /* It stays when it rests and has turned by no more than its tangential springs. */
    int rests = status == 0 && fabs(kept.packing[0].grains.angle[2]) < 1e-3;
    kept_free(&kept);
    return rests;
}

static void three_rods_slide_at_their_mu(void **state)
{
    (void)state;
    static const double mus[] = {0.2, 0.4, 0.53}, alphas[] = {40, 45, 50};
    struct friction_test tests[3];
    for (int k = 0; k < 3; k++) {
        double low = P1, high = 20 * P1, alpha = alphas[k] * DEGREE;
        assert_true(stays(alpha, mus[k], low) && !stays(alpha, mus[k], high));
        while (high - low > 1e-4 * low) {
            double middle = 0.5 * (low + high);
            if (stays(alpha, mus[k], middle))
                low = middle;
            else
                high = middle;
        }
        tests[k] =
            (struct friction_test){.p1 = P1, .p2 = 0.5 * (low + high), .arm = ARM, .radius = RADIUS, .alpha = alpha};
        struct friction friction;
        check_done(friction_estimate(&tests[k], 1, &friction));
        print_message("mu %.2f, alpha %g degrees: found %.5f, %+.3f %%\n", mus[k], alphas[k], friction.mu,
                      100 * (friction.mu / mus[k] - 1));
        check_near(friction.mu / mus[k], 1, 0.01);
    }
}

static const struct grade GRADING[] = {{150, 8e-3}, {100, 12e-3}};
static const struct loading_steps STEPS[] = {{5, 4e-3}};

static void sheared_packing(struct kept_states *kept, double mu)
{
    struct simulation simulation = SIMULATION_DEFAULT;
    simulation.grading = GRADING;
    simulation.grade_count = 2;
    simulation.law = (struct contact_law){.row = &linear_law, .kn = 1e7, .kt_over_kn = 1, .mu = mu};
    simulation.kappa = 200;
    simulation.test = TEST_BIAXIAL_VERTICAL;
    simulation.steps = STEPS;
    simulation.step_count = 1;
    check_done(simulate(&simulation, keep_state, kept));
}

/* All contacts between grains of all states, with noise of that share of the mean force. */
static size_t gather(const struct kept_states *kept, double noise, double *fn, double *ft)
{
    uint64_t seed = 5;
    size_t n = 0;
    for (size_t k = 1; k < kept->count; k++) {
        const struct packing *packing = &kept->packing[k];
        double mean = 0;
        for (size_t c = 0; c < packing->contacts.count; c++)
            mean += packing->forces->contact.fn[c] / (double)packing->contacts.count;
        for (size_t c = 0; c < packing->contacts.count; c++) {
            if (packing->contacts.flags[c] & CONTACT_WALL)
                continue;
            fn[n] = packing->forces->contact.fn[c] + noise * mean * check_normal(&seed);
            ft[n++] = packing->forces->contact.ft[c] + noise * mean * check_normal(&seed);
        }
    }
    return n;
}

static void forces_end_at_mu(void **state)
{
    (void)state;
    static const double mus[] = {0.25, 0.5};
    for (int m = 0; m < 2; m++) {
        struct kept_states kept = {0};
        struct mobilised mobilised;
        double fn[8000], ft[8000];
        sheared_packing(&kept, mus[m]);
        size_t n = gather(&kept, 0, fn, ft);
        assert_in_range(n, 100, 8000);
        check_done(friction_mobilised(fn, ft, n, &mobilised));
        check_near(mobilised.mu / mus[m], 1, 1e-3);
        n = gather(&kept, 0.001, fn, ft);
        check_done(friction_mobilised(fn, ft, n, &mobilised));
        check_near(mobilised.mu / mus[m], 1, 0.03);
        kept_free(&kept);
    }
}

static void smooth_forces_end_nowhere(void **state)
{
    (void)state;
    double fn[2000], ft[2000];
    struct mobilised mobilised;
    uint64_t seed = 9;
    for (int k = 0; k < 2000; k++) {
        fn[k] = 1 + check_uniform(&seed);
        ft[k] = 0.2 * fn[k] * check_normal(&seed);
    }
    assert_int_equal(friction_mobilised(fn, ft, 2000, &mobilised), -1);
    assert_int_equal(error_status(), EXIT_INPUT);
    assert_int_equal(friction_mobilised(fn, ft, 0, &mobilised), -1);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(three_rods_slide_at_their_mu),
        cmocka_unit_test(forces_end_at_mu),
        cmocka_unit_test(smooth_forces_end_nowhere),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
