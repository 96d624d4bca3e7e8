#include "tests/check.h"

#include <math.h>

#include "calibration/rods/friction.h"
#include "calibration/hertz/hertz.h"
#include "pipeline/speak/error.h"

static const double degree = 0.017453292519943295;

/* The weight P2 at which rod C slides, from the equilibrium of C with |ft| = mu fn at both contacts. C turns towards
 * the heavier (right) side; contact A is at the left. Forces on C along x and y, moments about its centre:
 *   N_A (s + mu c) = N_B (s - mu c),  N_A (c - mu s) + N_B (c + mu s) = P1 + P2,  mu R (N_A + N_B) = (P2 - P1) L,
 * where friction on C points to the right at both contacts (they lie below its centre, which turns clockwise). */
static double sliding_weight(double p1, double arm, double radius, double alpha, double phi)
{
    double mu = tan(phi), s = sin(alpha), c = cos(alpha);
    double ratio = (s - mu * c) / (s + mu * c);          /* N_A / N_B */
    double sum = ratio * (c - mu * s) + c + mu * s;      /* (P2 + P1) / N_B */
    double difference = mu * radius / arm * (ratio + 1); /* (P2 - P1) / N_B */
    return p1 * (sum + difference) / (sum - difference);
}

static void friction_is_inverted_to_machine_precision(void **state)
{
    (void)state;
    double worst = 0;
    for (double phi = 2; phi < 40; phi += 3.5) {
        struct friction_test test = {.p1 = 3.0, .arm = 0.05, .radius = 0.02, .alpha = (phi + 8) * degree};
        double found;
        test.p2 = sliding_weight(test.p1, test.arm, test.radius, test.alpha, phi * degree);
        check_done(friction_angle(&test, &found));
        check_near(found / degree, phi, 1e-12 * 90);
        worst = fmax(worst, fabs(found / degree - phi));
    }
    print_message("phi from 2 to 37 degrees: largest error %.1e degrees\n", worst);
}

static void friction_refuses_what_the_formula_cannot_tell(void **state)
{
    (void)state;
    double phi;
    struct friction_test open = {.p1 = 1, .p2 = 2, .arm = 0.02, .radius = 0.02, .alpha = 5 * degree};
    struct friction_test impossible = {.p1 = 1, .p2 = 9, .arm = 0.2, .radius = 0.02, .alpha = 30 * degree};
    struct friction_test empty = {.p1 = NAN, .p2 = 2, .arm = 0.02, .radius = 0.02, .alpha = 30 * degree};
    assert_int_equal(friction_angle(&open, &phi), -1);
    assert_int_equal(friction_angle(&impossible, &phi), -1);
    assert_int_equal(friction_angle(&empty, &phi), -1);
    assert_int_equal(error_status(), EXIT_INPUT);
}

static void friction_error_is_that_of_the_mean(void **state)
{
    (void)state;
    double angles[] = {26, 28, 30};
    struct friction_test tests[3];
    struct friction friction;
    for (int k = 0; k < 3; k++) {
        tests[k] = (struct friction_test){.p1 = 3, .arm = 0.05, .radius = 0.02, .alpha = 45 * degree};
        tests[k].p2 = sliding_weight(3, 0.05, 0.02, 45 * degree, angles[k] * degree);
    }
    check_done(friction_estimate(tests, 3, &friction));
    check_near(friction.phi / degree, 28, 1e-9);
    check_near(friction.s_phi / degree, 2 / sqrt(3), 1e-6); /* standard deviation 2, three tests */
    check_near(friction.mu, tan(28 * degree), 1e-12);
    check_near(friction.s_mu, (1 + pow(tan(28 * degree), 2)) * 2 / sqrt(3) * degree, 1e-8);
}

static void hertz_round_trips(void **state)
{
    (void)state;
    for (int dimensions = 2; dimensions <= 3; dimensions++)
        for (double nu = 0; nu < 0.5; nu += 0.15) {
            struct hertz_packing packing = {.dimensions = dimensions, .radius = 1e-3, .confinement = 1e5};
            packing.volume_per_contact = hertz_volume_per_contact(dimensions, 1e-3, 0.18, 4.2);
            double shear = 2.9e10, kn, ks, young, poisson, grain_young, grain_poisson;
            hertz_stiffness(1e-3, shear, nu, hertz_mean_force(&packing), &kn, &ks);
            hertz_moduli(&packing, kn, ks, &young, &poisson);
            check_near(poisson, hertz_poisson(dimensions, nu), 1e-14);
            check_done(hertz_start(&packing, young, poisson, &grain_young, &grain_poisson));
            check_near(grain_young / (2 * (1 + nu) * shear), 1, 1e-12);
            check_near(grain_poisson, nu, 1e-13);
        }
}

/* The closed 2D moduli against quadrature over directions: f_i = sigma_ij A n_j with A = S / (r N_c); compliances from
 * the contact energies per area, C = (N_c / S) <f_n g_n / kn + f_t g_t / ks> for stresses f (axial), g (lateral). */
static void hertz_moduli_match_quadrature(void **state)
{
    (void)state;
    const int n = 20000;
    double r = 2e-3, kn = 3e7, ks = 2e7, s_per_contact = 1.7e-5, axial = 0, lateral = 0;
    double a = s_per_contact / r;
    for (int k = 0; k < n; k++) {
        double phi = 6.283185307179586 * (k + 0.5) / n, c = cos(phi), s = sin(phi);
        double fn = a * c * c, ft = -a * c * s, gn = a * s * s, gt = a * s * c;
        axial += (fn * fn / kn + ft * ft / ks) / n / s_per_contact;
        lateral += (fn * gn / kn + ft * gt / ks) / n / s_per_contact;
    }
    struct hertz_packing packing = {2, r, s_per_contact, 1e5};
    double young, poisson;
    hertz_moduli(&packing, kn, ks, &young, &poisson);
    check_near(1 / axial / young, 1, 1e-9);
    check_near(-lateral / axial, poisson, 1e-9);
}

static void hertz_refuses_unreachable_targets(void **state)
{
    (void)state;
    struct hertz_packing packing = {2, 1e-3, 1e-6, 1e5};
    double young, poisson;
    assert_int_equal(hertz_start(&packing, -1, 0.1, &young, &poisson), -1);
    assert_int_equal(hertz_start(&packing, 1e9, 0.4, &young, &poisson), -1);
    assert_int_equal(hertz_start(&packing, 1e9, -0.1, &young, &poisson), -1);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(friction_is_inverted_to_machine_precision),
        cmocka_unit_test(friction_refuses_what_the_formula_cannot_tell),
        cmocka_unit_test(friction_error_is_that_of_the_mean),
        cmocka_unit_test(hertz_round_trips),
        cmocka_unit_test(hertz_moduli_match_quadrature),
        cmocka_unit_test(hertz_refuses_unreachable_targets),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
