/* The virtual camera: what it draws lies where it was told to. Truth is the grain list and integrals over it, which
 * the tests take from the photo by moments and by quadrature, never through the code that paints. */
#include "tests/photo_sums.h"

#include <stdlib.h>
#include <string.h>

#include <omp.h>

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

/* A steel disc on the frame's corner, half over the frame, half over the void: whole, and where it was told to be. */
static void test_hinge_lies_on_its_corner(void **state)
{
    (void)state;
    struct optics optics = OPTICS_PLAIN; /* frame, void and outside have one level */
    struct photo_grains grains = {0};
    struct photo photo = {0};
    struct picture picture = {.width = 120,
                              .height = 100,
                              .grains = &grains,
                              .framed = 1,
                              .corners = {{40.3, 45.8}, {110, 44}, {112, 90}, {41, 92}},
                              .hinges = {{40.3, 45.8, 23.4}},
                              .hinge_count = 1};
    check_done(render_picture(&picture, &optics, &photo));
    struct moments m = photo_moments(&photo);
    check_near(m.x, 40.3, 0.0002);
    check_near(m.y, 45.8, 0.0002);
    check_near(sqrt(m.mass / (0.65 * 65535) / PI), 23.4, 0.0005);
    photo_free(&photo);
}

/* The frame's inner edge: light of a bright void between four lines, against the polygon's area and centroid. */
static void test_frame_is_cut_along_its_lines(void **state)
{
    (void)state;
    struct optics optics = OPTICS_PLAIN;
    struct photo_grains grains = {0};
    struct photo photo = {0};
    struct picture picture = {.width = 150,
                              .height = 140,
                              .grains = &grains,
                              .framed = 1,
                              .corners = {{20.3, 25.8}, {130, 22}, {127, 110}, {24, 117}}};
    optics.hollow.level = 33277 / 65535.0; /* whole counts: plateaus are not rounded */
    optics.frame.level = optics.outside.level = 3277 / 65535.0;
    check_done(render_picture(&picture, &optics, &photo));
    double area = 0, x = 0, y = 0;
    for (int k = 0; k < 4; k++) {
        struct vec a = picture.corners[k], b = picture.corners[(k + 1) % 4];
        double twice = a.x * b.y - a.y * b.x;
        area += twice / 2;
        x += twice * (a.x + b.x) / 6;
        y += twice * (a.y + b.y) / 6;
    }
    struct moments m = photo_moments(&photo);
    check_near(m.mass / 30000, area, 0.02); /* 390 px of edge: 0.00005 px */
    check_near(m.x, x / area, 0.0002);
    check_near(m.y, y / area, 0.0002);
    photo_free(&photo);
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
        cmocka_unit_test(test_hinge_lies_on_its_corner),
        cmocka_unit_test(test_frame_is_cut_along_its_lines),
        cmocka_unit_test(test_threads_do_not_change_a_pixel),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
