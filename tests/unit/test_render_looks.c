/* The virtual camera: noise, steps, paint, flanks and lines are those asked for. */
#include "tests/photo_sums.h"

static void test_noise_is_the_one_asked_for(void **state)
{
    (void)state;
    struct optics optics = OPTICS_PLAIN;
    struct photo_grains grains = {0};
    struct photo photo = {0};
    optics.read_noise = 0.006;
    optics.shot_noise = 0.02;
    optics.hollow.level = 0.36;
    double expected = sqrt(0.006 * 0.006 + 0.02 * 0.02 * 0.36), mean = 0, square = 0, beside = 0;
    struct picture picture = {.width = 300, .height = 200, .grains = &grains};
    check_done(render_picture(&picture, &optics, &photo));
    for (int at = 0; at < 60000; at++) {
        double error = photo.pixels[at] / 65535.0 - 0.36;
        mean += error / 60000;
        square += error * error / 60000;
        beside += at ? error * (photo.pixels[at - 1] / 65535.0 - 0.36) / 60000 : 0;
    }
    check_near(mean, 0, 4 * expected / sqrt(60000));
    check_near(sqrt(square) / expected, 1, 4 / sqrt(120000));
    check_near(beside / square, 0, 4 / sqrt(60000));
    photo_free(&photo);
}

/* A lens darkens the corners by the share asked for, with the square of the distance from the middle. */
static void test_shading_is_the_one_asked_for(void **state)
{
    (void)state;
    struct optics optics = OPTICS_PLAIN;
    struct photo_grains grains = {0};
    struct photo photo = {0};
    optics.hollow.level = 0.5;
    optics.shading = 0.4;
    struct picture picture = {.width = 301, .height = 201, .grains = &grains};
    check_done(render_picture(&picture, &optics, &photo));
    check_near(photo_row(&photo, 0)[0] / 65535.0, 0.5 * (1 - 0.4), 1e-4);
    check_near(photo_row(&photo, 100)[150] / 65535.0, 0.5, 1e-4);
    check_near(photo_row(&photo, 100)[0] / 65535.0, 0.5 * (1 - 0.4 * 150 * 150 / (150.0 * 150 + 100 * 100)), 1e-4);
    photo_free(&photo);
}

/* Light of one plain grain at (40.3, 39.6), radius 24, with these optics; share of the grain's level per px. */
static double light_above_void(const struct optics *optics)
{
    struct photo_grains grains;
    struct photo photo = {0};
    grains_make(&grains, 1);
    grain_put(&grains, 0, 40.3, 39.6, 24, 0);
    struct picture picture = {.width = 200, .height = 80, .grains = &grains};
    check_done(render_picture(&picture, optics, &photo));
    struct moments m = photo_moments(&photo);
    photo_free(&photo);
    grains_free(&grains);
    return m.mass / 65535;
}

/* What shows of a rod's flank: the strip that the disc sweeps towards the photo's middle, summed on a fine grid. */
static void test_flank_is_the_swept_strip(void **state)
{
    (void)state;
    struct optics optics = OPTICS_PLAIN;
    optics.hollow.level = 0;
    double face = light_above_void(&optics), strip = 0, h = 0.05;
    optics.parallax = 0.1;
    optics.flank_level = 0.3;
    double sx = 0.1 * (99.5 - 40.3), sy = 0.1 * (39.5 - 39.6), length = hypot(sx, sy);
    for (double y = -40; y < 40; y += h)
        for (double x = -40; x < 60; x += h) {
            double along = fmin(fmax((x * sx + y * sy) / length, 0), length), beyond = hypot(x, y) - 24;
            double ex = x - along * sx / length, ey = y - along * sy / length;
            if (beyond > 0 && hypot(ex, ey) < 24)
                strip += h * h * 0.3 * pow(1 - fmin(beyond / length, 1), 2);
        }
    assert_true(strip > 20);
    check_near((light_above_void(&optics) - face) / strip, 1, 0.01);
}

/* A pencil line takes light in proportion to its width, and only where a share of the rods has one. */
static void test_lines_are_as_wide_as_told(void **state)
{
    (void)state;
    struct optics optics = OPTICS_PLAIN;
    double whole = light_above_void(&optics), loss[2];
    optics.line_share = 1;
    optics.line_level = 0.1;
    for (int k = 0; k < 2; k++) {
        optics.line_width = 1 + k;
        loss[k] = whole - light_above_void(&optics);
    }
    assert_true(loss[0] > 0.4 * 10); /* a chord of at least 0.7 of the radius, 0.4 of full scale deep */
    check_at_most(loss[0], 0.4 * 48);
    check_near(loss[1] / loss[0], 2, 0.01);
}

/* Share of the area that thrown paint covers: 1 - exp(-density area), as asked; down to its own level, rim included. */
static void test_paint_covers_the_share_asked_for(void **state)
{
    (void)state;
    struct optics optics = OPTICS_PLAIN;
    double dark = 0, whole = 0;
    optics.hollow.level = 0;
    for (int trial = 0; trial < 40; trial++) {
        optics.seed = (uint64_t)trial;
        optics.grain.paint_count = 0;
        whole += light_above_void(&optics);
        optics.grain.paint[0] = (struct paint){1, 3, 0.3, 0, 0};
        optics.grain.paint_count = 1;
        dark += whole > 0 ? light_above_void(&optics) : 0;
    }
    /* About 40 x 1809 px2 / 13.6 px2 per dot = 5300 dots' worth: the share's deviation is 0.006. */
    check_near(1 - dark / whole, 0.3, 0.02);
}

static void test_steps_and_saturation(void **state)
{
    (void)state;
    struct optics optics = OPTICS_DEFAULT;
    struct photo_grains grains;
    struct photo photo = {0};
    int at_end = 0;
    optics.exposure = 3;
    grains_make(&grains, 1);
    grain_put(&grains, 0, 40, 40, 30, 0);
    struct picture picture = {.width = 81, .height = 81, .grains = &grains};
    check_done(render_picture(&picture, &optics, &photo));
    for (int at = 0; at < 81 * 81; at++) {
        assert_int_equal(photo.pixels[at] % 16, 0); /* 12-bit steps */
        at_end += photo.pixels[at] == 4095 * 16;
    }
    assert_true(at_end > 500);
    photo_free(&photo);
    grains_free(&grains);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_shading_is_the_one_asked_for),     cmocka_unit_test(test_noise_is_the_one_asked_for),
        cmocka_unit_test(test_flank_is_the_swept_strip),         cmocka_unit_test(test_lines_are_as_wide_as_told),
        cmocka_unit_test(test_paint_covers_the_share_asked_for), cmocka_unit_test(test_steps_and_saturation),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
