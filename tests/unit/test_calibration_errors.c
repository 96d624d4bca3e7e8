/* What calibrations state about their own errors: the covariance of a lens against what repeated fits scatter by, and
 * against wrong statements about the noise; what a settlement trend leaves over. */
#include "tests/check.h"

#include <stdlib.h>

#include "calibration/lens/lens_fit.h"
#include "calibration/settlement/settlement.h"

enum { ACROSS = 10, DOWN = 8, COUNT = ACROSS * DOWN, PHOTOS = 4, WIDTH = 5000, HEIGHT = 4000, DRAWS = 60 };
#define NOISE 0.004 /* px */

static const struct lens truth = {.centre = {2540, 1980}, .k = {-1e-9, 2e-17, 0}, .p = {5e-8, -3e-8, 2e-8}};
static const double motions[PHOTOS][3] = {{400, -40, 0.01}, {-300, 300, -0.3}, {60, -400, 0.5}, {-400, -200, 0.9}};

/* Points of a plate that moves rigidly in the space behind the lens, seen with noise; stated: the error that the fit is
 * told. */
static struct lens_fitted fit_drawn(double noise, double stated, uint64_t seed)
{
    static struct vec reference[COUNT], seen[PHOTOS * COUNT];
    static double sigma[PHOTOS * COUNT];
    const struct vec middle = vec((WIDTH - 1) / 2.0, (HEIGHT - 1) / 2.0);
    for (int k = 0; k < COUNT; k++)
        reference[k] = vec((k % ACROSS + 0.5) * WIDTH / ACROSS, (k / ACROSS + 0.5) * HEIGHT / DOWN);
    for (int p = 0; p < PHOTOS; p++)
        for (int k = 0; k < COUNT; k++) {
            struct vec arm = vec_sub(lens_corrected(&truth, reference[k]), middle);
            struct vec at = lens_seen(
                &truth, vec_add(vec_add(middle, vec(motions[p][0], motions[p][1])), vec_rotate(arm, -motions[p][2])));
            int inside = at.x >= 0 && at.y >= 0 && at.x < WIDTH && at.y < HEIGHT, i = p * COUNT + k;
            seen[i] = vec_add(at, vec(noise * check_normal(&seed), noise * check_normal(&seed)));
            sigma[i] = inside ? stated : NAN;
        }
    const struct lens_points points = {COUNT, PHOTOS, reference, seen, sigma, WIDTH, HEIGHT};
    struct lens_fitted fitted;
    check_done(lens_fit(&points, &fitted));
    return fitted;
}

/* Errors that are stated three times too small are found out: chi^2 over its degrees of freedom, twice the points less
 * the unknowns, is 9, known to sqrt(2 / freedom) = 6 %. The same from errors stated 10 times too large, over 10. */
static void test_errors_do_not_hang_on_what_was_stated(void **state)
{
    (void)state;
    struct lens_fitted right = fit_drawn(NOISE, 10 * NOISE, 1), low = fit_drawn(NOISE, NOISE / 3, 1);
    check_near(low.s_map / (right.s_map / 10), 1, 0.1);
}

/* Standard deviations of the unknowns over drawn photos, known to 1 / sqrt(2 DRAWS) = 9 %, in the file's units. */
static void test_covariance_is_that_of_repeated_fits(void **state)
{
    (void)state;
    double sum[LENS_UNKNOWNS] = {0}, squares[LENS_UNKNOWNS] = {0};
    struct lens_fitted fitted = {0};
    for (int draw = 0; draw < DRAWS; draw++) {
        fitted = fit_drawn(NOISE, NOISE, 100 + (uint64_t)draw);
        const double q[LENS_UNKNOWNS] = {fitted.lens.centre.x, fitted.lens.centre.y, fitted.lens.k[0],
                                         fitted.lens.k[1],     fitted.lens.k[2],     fitted.lens.p[0],
                                         fitted.lens.p[1],     fitted.lens.p[2]};
        for (int a = 0; a < LENS_UNKNOWNS; a++) {
            sum[a] += q[a];
            squares[a] += q[a] * q[a];
        }
    }
    for (int a = 0; a < LENS_UNKNOWNS; a++) {
        double spread = sqrt((squares[a] - sum[a] * sum[a] / DRAWS) / (DRAWS - 1)), s = sqrt(fitted.covariance[a][a]);
        check_near(spread / s, 1, 0.3);
    }
}

/* Rises of 1, 3, 5 about a line of slope 3: what is left over is -2, -2, 0; rms sqrt(8 / 3), extremes -2 and 0. */
static void test_what_a_trend_leaves_over(void **state)
{
    (void)state;
    const double t[] = {1, 2, 3, 4}, u[] = {10, 11, 14, 19};
    struct trend trend;
    check_done(trend_fit(TREND_LINEAR, t, u, 3, &trend));
    check_near(trend.b, 3, 1e-12);
    check_near(trend.rms, sqrt(8.0 / 3), 1e-12);
    check_near(trend.low, -2, 1e-12);
    check_near(trend.high, 0, 1e-12);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_errors_do_not_hang_on_what_was_stated),
        cmocka_unit_test(test_covariance_is_that_of_repeated_fits),
        cmocka_unit_test(test_what_a_trend_leaves_over),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
