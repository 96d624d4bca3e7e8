/* IC-GN against analytic dots moved exactly: bias, rotation, gain and offset, noise against the Cramer-Rao bound. */
#include "tests/check.h"
#include "tests/dots.h"

#include "tracker/search/icgn.h"
#include "tracker/subset/interpolate.h"

static const double degree = 3.141592653589793 / 180;

struct trial {
    const double *sigma;
    double radius, gain, offset, noise, blur;
    struct motion truth, start;
    uint64_t key;
};

static struct photo draw(const struct dots *dots, double centre, struct motion motion, double gain, double offset,
                         double noise, double blur, uint64_t key)
{
    int side = (int)(2 * centre) + 1;
    struct canvas canvas = canvas_make(side, side, 0.8);
    canvas_add(&canvas, dots, centre + 0.37 + motion.u, centre - 0.21 + motion.v, motion.angle, blur);
    struct photo photo = canvas_photo(&canvas, gain, offset, noise, key);
    canvas_free(&canvas);
    return photo;
}

static struct fit run(const struct trial *trial)
{
    double centre = floor(1.25 * trial->radius) + 10;
    struct dots dots = dots_make(1.25 * trial->radius + 6, trial->sigma, trial->key);
    struct photo reference = draw(&dots, centre, (struct motion){0}, 1, 0, trial->noise, 0, 2 * trial->key);
    struct photo photo =
        draw(&dots, centre, trial->truth, trial->gain, trial->offset, trial->noise, trial->blur, 2 * trial->key + 1);
    struct shape shape = {.cx = centre + 0.37, .cy = centre - 0.21, .radius = trial->radius};
    struct icgn_options options = ICGN_DEFAULT;
    struct subset subset;
    struct patch patch = {0};
    struct fit fit;
    check_done(subset_build(&reference, &shape, NULL, &subset));
    assert_true(subset_usable(&subset));
    check_done(icgn_fit(&subset, &photo, trial->start, &options, &patch, &fit));
    subset_free(&subset);
    patch_free(&patch);
    free(reference.pixels);
    free(photo.pixels);
    dots_free(&dots);
    return fit;
}

static void test_sub_pixel_bias(void **state)
{
    (void)state;
    for (int k = 0; k < 10; k++) {
        struct motion truth = {k * 0.1, 0.73 - k * 0.07, 0};
        struct trial trial = {.sigma = DOTS_NORMAL,
                              .radius = 40,
                              .gain = 1,
                              .truth = truth,
                              .key = 5,
                              .start = {truth.u + 0.4, truth.v - 0.3, 0.2 * degree}};
        struct fit fit = run(&trial);
        assert_true(fit.converged);
        check_near(fit.motion.u, truth.u, 1e-3);
        check_near(fit.motion.v, truth.v, 1e-3);
        check_near(fit.motion.angle, 0, 5e-5);
    }
}

static void test_rotation_and_sign(void **state)
{
    (void)state;
    const double angles[] = {-170, -45, -3, 0.5, 10, 90};
    for (int k = 0; k < 6; k++) {
        struct motion truth = {1.3, -2.6, angles[k] * degree};
        struct trial trial = {.sigma = DOTS_NORMAL,
                              .radius = 40,
                              .gain = 1,
                              .truth = truth,
                              .key = 7,
                              .start = {1.0, -2.4, (angles[k] + 0.3) * degree}};
        struct fit fit = run(&trial);
        assert_true(fit.converged);
        check_near(fit.motion.u, truth.u, 1e-3);
        check_near(fit.motion.v, truth.v, 1e-3);
        check_near(fit.motion.angle, truth.angle, 5e-5);
        check_at_most(1 - fit.zncc, 1e-3);
    }
}

static void test_gain_and_offset_drop_out(void **state)
{
    (void)state;
    const double gains[] = {0.7, 1.15, 0.5}, offsets[] = {0.1, -0.1, 0.2};
    for (int k = 0; k < 3; k++) {
        struct trial trial = {.sigma = DOTS_NORMAL,
                              .radius = 40,
                              .gain = gains[k],
                              .offset = offsets[k],
                              .key = 9,
                              .truth = {0.3, 0.4, 2 * degree},
                              .start = {0, 0, 1.8 * degree}};
        struct fit fit = run(&trial);
        assert_true(fit.converged);
        check_near(fit.motion.u, 0.3, 1e-3);
        check_near(fit.motion.v, 0.4, 1e-3);
        check_near(fit.motion.angle, 2 * degree, 5e-5);
        check_near(fit.gain / gains[k], 1, 5e-3); /* the spline flattens the finest dots by 0.3 % */
    }
}

/* 240 noisy trials: the mean of (error / stated standard error)^2 is 1 within its own scatter, sqrt(2 / 720) = 0.053:
 * 4 sigma, and the bias of the stated error allowed is 10 %. */
static void test_scatter_is_the_stated_error(void **state)
{
    (void)state;
    const double noises[] = {0.01, 0.03};
    for (int n = 0; n < 2; n++) {
        double sum = 0;
        int count = 240;
        for (int k = 0; k < count; k++) {
            struct motion truth = {0.5 * (k % 3), 0.25 * (k % 4), (k % 5) * 0.3 * degree};
            struct trial trial = {.sigma = DOTS_NORMAL,
                                  .radius = 20,
                                  .gain = 1,
                                  .noise = noises[n],
                                  .truth = truth,
                                  .start = {truth.u + 0.2, truth.v - 0.2, truth.angle},
                                  .key = (uint64_t)(1000 * n + k + 1)};
            struct fit fit = run(&trial);
            assert_true(fit.converged);
            check_near(fit.noise / (noises[n] * DOTS_WHITE), 1, 0.15);
            sum += pow(fit.motion.u - truth.u, 2) / fit.covariance[0][0] +
                   pow(fit.motion.v - truth.v, 2) / fit.covariance[1][1] +
                   pow(fit.motion.angle - truth.angle, 2) / fit.covariance[2][2];
        }
        check_near(sqrt(sum / (3 * count)), 1, 0.1 + 4 * 0.053 / 2);
    }
}

/* Plain C, AVX2, AVX-512: the same motion to 1e-5 px. */
static void test_every_machine_gives_the_same(void **state)
{
    (void)state;
    const double angles[] = {0, 0.4, 30, 171};
    for (int k = 0; k < 4; k++) {
        struct motion truth = {1.3, -0.6, angles[k] * degree};
        struct trial trial = {.sigma = DOTS_NORMAL,
                              .radius = 33.3,
                              .gain = 0.9,
                              .noise = k % 2 ? 0.01 : 0.0005,
                              .truth = truth,
                              .start = {1.2, -0.4, truth.angle + 0.001},
                              .key = 31};
        struct fit fits[3];
        for (int level = INTERPOLATE_PLAIN; level <= (int)interpolate_machine(); level++) {
            interpolate_limit((enum interpolate_level)level);
            fits[level] = run(&trial);
            check_near(fits[level].motion.u, fits[0].motion.u, 1e-5);
            check_near(fits[level].motion.v, fits[0].motion.v, 1e-5);
            check_near(fits[level].motion.angle, fits[0].motion.angle, 1e-5 / trial.radius);
            check_near(fits[level].zncc, fits[0].zncc, 1e-6);
            assert_int_equal(fits[level].fine, k == 0); /* without noise and turn: the quintic spline too */
        }
        interpolate_limit(INTERPOLATE_AVX512);
    }
}

/* A photo out of focus: the Laplacian takes the difference up (docs/tracker.md). */
static void test_focus_drops_out(void **state)
{
    (void)state;
    struct trial trial = {.sigma = DOTS_NORMAL,
                          .radius = 40,
                          .gain = 1,
                          .blur = 0.7,
                          .key = 33,
                          .truth = {0.3, 0.6, 1 * degree},
                          .start = {0.1, 0.4, 0.9 * degree}};
    struct fit fit = run(&trial);
    assert_true(fit.converged);
    check_near(fit.motion.u, 0.3, 1e-3);
    check_near(fit.motion.v, 0.6, 1e-3);
    check_near(fit.motion.angle, 1 * degree, 5e-5);
}

/* What a change of focus leaves looks like noise of twice the size, but moves nothing: 160 trials, scatter of the
 * figure sqrt(2 / 480) / 2 = 0.032; 4 sigma and 10 %. */
static void test_stated_error_out_of_focus(void **state)
{
    (void)state;
    double sum = 0;
    const int count = 160;
    for (int k = 0; k < count; k++) {
        struct motion truth = {0.31 * (k % 3), 0.23 * (k % 4), 2 * degree};
        struct trial trial = {.sigma = DOTS_NORMAL,
                              .radius = 24,
                              .gain = 1,
                              .noise = 0.01,
                              .blur = 0.7,
                              .truth = truth,
                              .start = {truth.u + 0.2, truth.v - 0.2, truth.angle},
                              .key = (uint64_t)(70000 + k)};
        struct fit fit = run(&trial);
        assert_true(fit.converged);
        sum += pow(fit.motion.u - truth.u, 2) / fit.covariance[0][0] +
               pow(fit.motion.v - truth.v, 2) / fit.covariance[1][1] +
               pow(fit.motion.angle - truth.angle, 2) / fit.covariance[2][2];
    }
    print_message("error / stated %.3f\n", sqrt(sum / (3 * count)));
    check_near(sqrt(sum / (3 * count)), 1, 0.1 + 4 * 0.032);
}

static void test_flat_subset_is_not_usable(void **state)
{
    (void)state;
    struct canvas canvas = canvas_make(64, 64, 0.5);
    struct photo photo = canvas_photo(&canvas, 1, 0, 0, 0);
    struct shape shape = {.cx = 32, .cy = 32, .radius = 20};
    struct subset subset;
    check_done(subset_build(&photo, &shape, NULL, &subset));
    assert_false(subset_usable(&subset));
    subset_free(&subset);
    shape.cx = -100;
    check_done(subset_build(&photo, &shape, NULL, &subset));
    assert_false(subset_usable(&subset));
    assert_int_equal(subset.count, 0);
    subset_free(&subset);
    canvas_free(&canvas);
    free(photo.pixels);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_sub_pixel_bias),
        cmocka_unit_test(test_rotation_and_sign),
        cmocka_unit_test(test_gain_and_offset_drop_out),
        cmocka_unit_test(test_scatter_is_the_stated_error),
        cmocka_unit_test(test_every_machine_gives_the_same),
        cmocka_unit_test(test_focus_drops_out),
        cmocka_unit_test(test_stated_error_out_of_focus),
        cmocka_unit_test(test_flat_subset_is_not_usable),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
