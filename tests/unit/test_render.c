/* The virtual camera: what it draws lies where it was told to. Truth is the grain list and integrals over it, which
 * the tests take from the photo by moments and by quadrature, never through the code that paints. */
#include "tests/check.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <omp.h>

#include "simulation/render.h"

static const double PI = 3.14159265358979323846;

static void grains_make(struct photo_grains *grains, size_t count)
{
    static const char *const columns[] = {"x_px", "y_px", "radius_px", "angle", NULL};
    *grains = (struct photo_grains){0};
    check_done(table_alloc(&PHOTO_GRAINS, grains, count, columns));
}

static void grain_put(struct photo_grains *grains, size_t k, double x, double y, double radius, double angle)
{
    grains->x_px[k] = x;
    grains->y_px[k] = y;
    grains->radius_px[k] = radius;
    grains->angle[k] = angle;
}

static void grains_free(struct photo_grains *grains)
{
    table_free(&PHOTO_GRAINS, grains);
}

struct moments {
    double mass, x, y; /* of the light above the top-left pixel's level; centroid in px */
};

/* A pixel sum of a blurred picture equals its integral (Poisson: the blurred spectrum is nil at whole frequencies). */
static struct moments photo_moments(const struct photo *photo)
{
    struct moments m = {0};
    double floor_level = photo_row(photo, 0)[0];
    for (int y = 0; y < photo->height; y++)
        for (int x = 0; x < photo->width; x++) {
            double light = photo_row(photo, y)[x] - floor_level;
            m.mass += light;
            m.x += light * x;
            m.y += light * y;
        }
    m.x /= m.mass;
    m.y /= m.mass;
    return m;
}

static void test_edges_lie_where_told(void **state)
{
    (void)state;
    uint64_t seed = 1;
    double worst_centre = 0, worst_radius = 0, bias[3] = {0};
    struct optics optics = OPTICS_PLAIN;
    for (int trial = 0; trial < 100; trial++) {
        struct photo_grains grains;
        struct photo photo = {0};
        double x = 40 + check_uniform(&seed), y = 39 + check_uniform(&seed), radius = 14 + 16 * check_uniform(&seed);
        optics.psf = 0.5 + 0.7 * check_uniform(&seed);
        grains_make(&grains, 1);
        grain_put(&grains, 0, x, y, radius, 0);
        struct picture picture = {.width = 81, .height = 79, .grains = &grains};
        check_done(render_picture(&picture, &optics, &photo));
        struct moments m = photo_moments(&photo);
        double contrast = photo_row(&photo, 39)[40] - photo_row(&photo, 0)[0];
        double error[3] = {m.x - x, m.y - y, sqrt(m.mass / contrast / PI) - radius};
        for (int k = 0; k < 3; k++)
            bias[k] += error[k] / 100;
        worst_centre = fmax(worst_centre, fmax(fabs(error[0]), fabs(error[1])));
        worst_radius = fmax(worst_radius, fabs(error[2]));
        photo_free(&photo);
        grains_free(&grains);
    }
    print_message("worst centre %.2g px, worst radius %.2g px, bias %.1g %.1g %.1g px\n", worst_centre, worst_radius,
                  bias[0], bias[1], bias[2]);
    check_at_most(worst_centre, 0.0002);
    check_at_most(worst_radius, 0.0005);
}

/* Integral of the Gaussian of deviation s from minus infinity. */
static double step(double x, double s)
{
    return 0.5 * erfc(-x / (s * sqrt(2)));
}

/* Integral of step(): x step(x) + s^2 gauss(x). */
static double ramp(double x, double s)
{
    return x * step(x, s) + s * exp(-x * x / (2 * s * s)) / sqrt(2 * PI);
}

/* Share of a disc in the pixel at (x, y) from its centre, after a Gaussian: one integral in closed form, the other by
 * the midpoint rule over columns of the disc. */
static double disc_share(double x, double y, double radius, double s)
{
    double sum = 0, h = 0.004, low = fmax(-radius, x - 6), high = fmin(radius, x + 6);
    int n = (int)ceil((high - low) / h);
    h = (high - low) / n;
    for (int k = 0; k < n; k++) {
        double u = low + (k + 0.5) * h, half = sqrt(fmax(radius * radius - u * u, 0));
        double across = step(x - u + 0.5, s) - step(x - u - 0.5, s);
        sum += h * across *
               (ramp(y + 0.5 + half, s) - ramp(y - 0.5 + half, s) - ramp(y + 0.5 - half, s) + ramp(y - 0.5 - half, s));
    }
    return sum;
}

static void test_point_spread_is_the_one_asked_for(void **state)
{
    (void)state;
    struct optics optics = OPTICS_PLAIN;
    double worst = 0, x = 20.31, y = 19.77, radius = 14.2;
    for (int trial = 0; trial < 3; trial++) {
        struct photo_grains grains;
        struct photo photo = {0};
        optics.psf = trial == 0 ? 0.4 : trial == 1 ? 0.7 : 1.5;
        grains_make(&grains, 1);
        grain_put(&grains, 0, x, y, radius, 0);
        struct picture picture = {.width = 41, .height = 41, .grains = &grains};
        check_done(render_picture(&picture, &optics, &photo));
        for (int row = 0; row < 41; row++)
            for (int column = 0; column < 41; column++) {
                double light = 0.05 + 0.45 * disc_share(column - x, row - y, radius, optics.psf);
                worst = fmax(worst, fabs(photo_row(&photo, row)[column] / 65535.0 - light));
            }
        photo_free(&photo);
        grains_free(&grains);
    }
    print_message("worst pixel %.2g of full scale\n", worst);
    check_at_most(worst, 5e-4); /* 0.1 % of the contrast: 0.001 to 0.004 px of edge, without a sign */
}

/* The paint's centre of light is fixed to the grain: offset(angle) = Q(angle) offset(0). */
static void test_paint_moves_rigidly(void **state)
{
    (void)state;
    uint64_t seed = 2;
    struct optics optics = OPTICS_DEFAULT;
    optics.bits = 16;
    optics.read_noise = optics.shot_noise = 0;
    optics.hollow.level = 0;
    optics.ring_spacing = 5;
    optics.ring_contrast = 0.2;
    double first[2] = {0}, worst = 0, mass = 0;
    for (int trial = 0; trial < 20; trial++) {
        struct photo_grains grains;
        struct photo photo = {0};
        double x = 40 + check_uniform(&seed), y = 40 + check_uniform(&seed);
        double angle = trial ? 6.28 * check_uniform(&seed) : 0;
        grains_make(&grains, 1);
        grain_put(&grains, 0, x, y, 30, angle);
        struct picture picture = {.width = 82, .height = 82, .grains = &grains};
        check_done(render_picture(&picture, &optics, &photo));
        struct moments m = photo_moments(&photo);
        if (!trial) {
            first[0] = m.x - x;
            first[1] = m.y - y;
            mass = m.mass;
        }
        double c = cos(angle), s = sin(angle); /* counter-clockwise as seen, y down */
        worst = fmax(worst, fabs(m.x - x - (c * first[0] + s * first[1])));
        worst = fmax(worst, fabs(m.y - y - (-s * first[0] + c * first[1])));
        check_near(m.mass / mass, 1, 2e-4);
        photo_free(&photo);
        grains_free(&grains);
    }
    print_message("offset of the paint %.3f px, worst error %.2g px\n", hypot(first[0], first[1]), worst);
    assert_true(hypot(first[0], first[1]) > 0.05); /* else the test could not fail */
    check_at_most(worst, 0.0002);
}

/* Sum of light (rho / 10)^m e^{i m phi} e^{-(rho / 9)^2} about (x, y): phi counter-clockwise as seen. */
static void angular_moment(const struct photo *photo, double x, double y, int m, double moment[2])
{
    moment[0] = moment[1] = 0;
    for (int row = 0; row < photo->height; row++)
        for (int column = 0; column < photo->width; column++) {
            double dx = column - x, dy = y - row, rho = hypot(dx, dy), phi = atan2(dy, dx);
            double weight = photo_row(photo, row)[column] * pow(rho / 10, m) * exp(-rho * rho / 81);
            moment[0] += weight * cos(m * phi);
            moment[1] += weight * sin(m * phi);
        }
}

/* Turned by any angle, every angular moment of the paint turns by m times that angle: the picture itself has turned. */
static void test_any_angle_turns_the_picture(void **state)
{
    (void)state;
    uint64_t seed = 8;
    struct optics optics = OPTICS_DEFAULT;
    optics.bits = 16;
    optics.read_noise = optics.shot_noise = 0;
    double first[7][2], worst = 0;
    for (int trial = 0; trial < 12; trial++) {
        struct photo_grains grains;
        struct photo photo = {0};
        double x = 40 + check_uniform(&seed), y = 40 + check_uniform(&seed),
               angle = trial ? 6.28 * check_uniform(&seed) : 0;
        grains_make(&grains, 1);
        grain_put(&grains, 0, x, y, 36, angle);
        struct picture picture = {.width = 82, .height = 82, .grains = &grains};
        check_done(render_picture(&picture, &optics, &photo));
        for (int m = 1; m < 7; m++) {
            double is[2], c = cos(m * angle), s = sin(m * angle);
            angular_moment(&photo, x, y, m, trial ? is : first[m]);
            if (!trial)
                continue;
            double *was = first[m];
            double error = hypot(is[0] - (c * was[0] - s * was[1]), is[1] - (s * was[0] + c * was[1]));
            worst = fmax(worst, error / hypot(was[0], was[1]) / m);
        }
        photo_free(&photo);
        grains_free(&grains);
    }
    print_message("worst error of an angular moment: as if turned by %.2g rad\n", worst);
    check_at_most(worst, 2e-4);
}

/* A quarter turn maps the pixels onto themselves. */
static void test_quarter_turn_gives_the_turned_photo(void **state)
{
    (void)state;
    struct optics optics = OPTICS_DEFAULT;
    optics.bits = 16;
    optics.read_noise = optics.shot_noise = 0;
    struct photo_grains grains;
    struct photo photo[2] = {{0}, {0}};
    int worst = 0;
    grains_make(&grains, 1);
    for (int turn = 0; turn < 2; turn++) {
        grain_put(&grains, 0, 40, 40, 33.3, turn * PI / 2);
        struct picture picture = {.width = 81, .height = 81, .grains = &grains};
        check_done(render_picture(&picture, &optics, &photo[turn]));
    }
    for (int y = 0; y < 81; y++)
        for (int x = 0; x < 81; x++) /* counter-clockwise: (dx, dy) goes to (dy, -dx) with y down */
            worst = (int)fmax(worst, abs(photo_row(&photo[0], y)[x] - photo_row(&photo[1], 80 - x)[y]));
    print_message("worst difference %d of 65535\n", worst);
    assert_true(worst <= 8);
    photo_free(&photo[0]);
    photo_free(&photo[1]);
    grains_free(&grains);
}

/* Three rods that touch hide exactly the sum of their faces: no light is lost or gained at the contacts. */
static void test_touching_faces_add_up(void **state)
{
    (void)state;
    struct optics optics = OPTICS_PLAIN;
    struct photo_grains grains;
    struct photo photo = {0};
    grains_make(&grains, 3);
    grain_put(&grains, 0, 30.2, 35.7, 20, 0);
    grain_put(&grains, 1, 30.2 + 35 * cos(0.4), 35.7 + 35 * sin(0.4), 15, 0);
    grain_put(&grains, 2, 30.2 + 38 * cos(1.5), 35.7 + 38 * sin(1.5), 18, 0);
    struct picture picture = {.width = 100, .height = 110, .grains = &grains};
    check_done(render_picture(&picture, &optics, &photo));
    double contrast = photo_row(&photo, 36)[30] - photo_row(&photo, 0)[0];
    check_near(photo_moments(&photo).mass / contrast, PI * (20 * 20 + 15 * 15 + 18 * 18), 0.2);
    photo_free(&photo);
    grains_free(&grains);
}

/* The rim r(phi) = R + c cos 2(phi - angle) + s sin 2(phi - angle): area and second moments by integration. */
static void test_shapes_are_drawn_as_told(void **state)
{
    (void)state;
    struct optics optics = OPTICS_PLAIN;
    struct photo_grains grains;
    struct photo photo = {0};
    double radius = 30, c = 0.6, s = -0.35, angle = 0.7, area = 0, xx = 0, yy = 0, xy = 0;
    grains_make(&grains, 1);
    check_done(table_add(&PHOTO_GRAINS, &grains, "shape_c"));
    check_done(table_add(&PHOTO_GRAINS, &grains, "shape_s"));
    grain_put(&grains, 0, 40.3, 39.6, radius, angle);
    grains.shape_c[0] = c;
    grains.shape_s[0] = s;
    for (int k = 0; k < 10000; k++) {
        double phi = 2 * PI * (k + 0.5) / 10000, r = radius + c * cos(2 * (phi - angle)) + s * sin(2 * (phi - angle));
        area += r * r / 2 * 2 * PI / 10000;
        xx += pow(r, 4) / 4 * cos(phi) * cos(phi) * 2 * PI / 10000;
        yy += pow(r, 4) / 4 * sin(phi) * sin(phi) * 2 * PI / 10000;
        xy += pow(r, 4) / 4 * cos(phi) * sin(phi) * 2 * PI / 10000;
    }
    struct picture picture = {.width = 81, .height = 81, .grains = &grains};
    check_done(render_picture(&picture, &optics, &photo));
    double sum[4] = {0}, contrast = photo_row(&photo, 40)[40] - photo_row(&photo, 0)[0];
    for (int y = 0; y < 81; y++)
        for (int x = 0; x < 81; x++) {
            double share = (photo_row(&photo, y)[x] - photo_row(&photo, 0)[0]) / contrast;
            sum[0] += share;
            sum[1] += share * ((x - 40.3) * (x - 40.3) - (y - 39.6) * (y - 39.6));
            sum[2] += share * (x - 40.3) * (39.6 - y);
        }
    check_near(sum[0], area, 0.2);                                                /* 0.001 px of radius */
    check_near((sum[1] - (xx - yy)) / (radius * radius * radius * PI), 0, 0.001); /* px of c and s */
    check_near((2 * sum[2] - 2 * xy) / (radius * radius * radius * PI), 0, 0.001);
    photo_free(&photo);
    grains_free(&grains);
}

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

static void test_threads_do_not_change_a_pixel(void **state)
{
    (void)state;
    struct optics optics = OPTICS_DEFAULT;
    struct photo_grains grains;
    struct photo photo[2] = {{0}, {0}};
    grains_make(&grains, 3);
    grain_put(&grains, 0, 60, 70, 40, 1);
    grain_put(&grains, 1, 130, 70, 30, 2);
    grain_put(&grains, 2, NAN, NAN, 30, 2); /* a grain without a place is not drawn */
    struct picture picture = {.width = 181,
                              .height = 150,
                              .grains = &grains,
                              .framed = 1,
                              .corners = {{10, 12}, {170, 10}, {172, 140}, {8, 138}},
                              .hinges = {{10, 12, 9}},
                              .hinge_count = 1};
    int threads = omp_get_max_threads();
    for (int run = 0; run < 2; run++) {
        omp_set_num_threads(run ? 3 : 1);
        check_done(render_picture(&picture, &optics, &photo[run]));
    }
    omp_set_num_threads(threads);
    assert_memory_equal(photo[0].pixels, photo[1].pixels, 2 * 181 * 150);
    photo_free(&photo[0]);
    photo_free(&photo[1]);
    grains_free(&grains);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_edges_lie_where_told),
        cmocka_unit_test(test_point_spread_is_the_one_asked_for),
        cmocka_unit_test(test_paint_moves_rigidly),
        cmocka_unit_test(test_any_angle_turns_the_picture),
        cmocka_unit_test(test_quarter_turn_gives_the_turned_photo),
        cmocka_unit_test(test_touching_faces_add_up),
        cmocka_unit_test(test_shapes_are_drawn_as_told),
        cmocka_unit_test(test_noise_is_the_one_asked_for),
        cmocka_unit_test(test_flank_is_the_swept_strip),
        cmocka_unit_test(test_lines_are_as_wide_as_told),
        cmocka_unit_test(test_paint_covers_the_share_asked_for),
        cmocka_unit_test(test_steps_and_saturation),
        cmocka_unit_test(test_threads_do_not_change_a_pixel),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
