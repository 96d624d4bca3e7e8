/* The lens from points of a rigidly moved plate, drawn through a known lens. */
#include "tests/check.h"
#include "tests/dots.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "calibration/commands/lens_picture.h"
#include "calibration/lens/lens_fit.h"
#include "calibration/lens/lens_map.h"
#include "calibration/lens/lens_plate.h"
#include "calibration/rods/scale.h"
#include "pipeline/speak/error.h"

enum { ACROSS = 24, DOWN = 18, COUNT = ACROSS * DOWN, PHOTOS = 5, WIDTH = 10320, HEIGHT = 7752 };

/* About 8 px at the corners, a centre off the middle, some tangential part. */
static const struct lens truth = {.centre = {5230, 3790}, .k = {-3.4e-11, 1.5e-19, 0}, .p = {2.5e-9, -1.5e-9, 0}};

static const double motions[PHOTOS][3] = {
    {900, -40, 0.01}, {-700, 600, -0.15}, {60, -800, 0.3}, {-900, -500, 0.02}, {500, 700, -0.5}};

struct points {
    struct lens_points points;
    struct vec reference[COUNT], seen[PHOTOS * COUNT];
    double sigma[PHOTOS * COUNT];
};

/* The plate moves in the space behind the lens: corrected positions move rigidly. */
static struct points *plate_make(size_t photos, double motion_scale, double noise)
{
    struct points *plate = malloc(sizeof *plate);
    uint64_t random = 5;
    for (int k = 0; k < COUNT; k++)
        plate->reference[k] = vec((k % ACROSS + 0.5) * WIDTH / ACROSS, (k / ACROSS + 0.5) * HEIGHT / DOWN);
    for (size_t p = 0; p < photos; p++)
        for (int k = 0; k < COUNT; k++) {
            const double *m = motions[p];
            double a = m[2] * motion_scale, c = cos(a), s = sin(a);
            struct vec arm = vec_sub(lens_corrected(&truth, plate->reference[k]), vec(5160, 3876));
            struct vec there = vec(5160 + m[0] * motion_scale + c * arm.x + s * arm.y,
                                   3876 + m[1] * motion_scale - s * arm.x + c * arm.y);
            struct vec seen = lens_seen(&truth, there);
            size_t i = p * COUNT + (size_t)k;
            int inside = seen.x >= 0 && seen.y >= 0 && seen.x < WIDTH && seen.y < HEIGHT;
            plate->seen[i] = vec(seen.x + noise * check_normal(&random), seen.y + noise * check_normal(&random));
            plate->sigma[i] = inside ? fmax(noise, 1e-6) : NAN;
        }
    plate->points = (struct lens_points){.count = COUNT,
                                         .photos = photos,
                                         .reference = plate->reference,
                                         .seen = plate->seen,
                                         .sigma = plate->sigma,
                                         .width = WIDTH,
                                         .height = HEIGHT};
    return plate;
}

static void test_eight_pixels_to_a_hundredth(void **state)
{
    (void)state;
    struct points *plate = plate_make(PHOTOS, 1, 0.003);
    struct lens_fitted fitted;
    const struct lens none = {.centre = {5160, 3876}};
    double before, largest;
    check_done(lens_fit(&plate->points, &fitted));
    lens_difference(&truth, &none, WIDTH, HEIGHT, &before);
    assert_true(before > 2);
    double rms = lens_difference(&fitted.lens, &truth, WIDTH, HEIGHT, &largest);
    print_message("before %.2f px at most; after RMS %.5f px, largest %.5f px, stated %.5f px\n", before, rms, largest,
                  fitted.s_map);
    check_at_most(rms, 0.01);
    check_at_most(rms, 4 * fitted.s_map);
    check_near(fitted.rms, 0.003, 0.0005);
    assert_int_equal(fitted.left_out, 0);
    free(plate);
}

static void test_exact_points_give_the_lens(void **state)
{
    (void)state;
    struct points *plate = plate_make(3, 1, 0);
    struct lens_fitted fitted;
    check_done(lens_fit(&plate->points, &fitted));
    check_at_most(lens_difference(&fitted.lens, &truth, WIDTH, HEIGHT, NULL), 1e-4);
    free(plate);
}

static void test_wrong_points_are_left_out(void **state)
{
    (void)state;
    struct points *plate = plate_make(PHOTOS, 1, 0.003);
    struct lens_fitted fitted;
    for (int k = 0; k < 60; k++)
        plate->seen[31 * k + 5].x += 0.5 + 0.1 * k;
    check_done(lens_fit(&plate->points, &fitted));
    check_at_most(lens_difference(&fitted.lens, &truth, WIDTH, HEIGHT, NULL), 0.01);
    assert_true(fitted.left_out >= 50 && fitted.left_out <= 62);
    free(plate);
}

static void refused(struct points *plate)
{
    struct lens_fitted fitted;
    assert_int_equal(lens_fit(&plate->points, &fitted), -1);
    assert_int_equal(error_status(), EXIT_INPUT);
    print_message("%s\n", error_message());
    free(plate);
}

static void test_what_cannot_be_determined_is_refused(void **state)
{
    (void)state;
    refused(plate_make(PHOTOS, 1e-3, 0.003)); /* hardly moved */
    refused(plate_make(1, 1, 0.003));
    struct points *plate = plate_make(PHOTOS, 1, 0.003);
    for (int k = 0; k < PHOTOS * COUNT; k++)
        if (k % 20)
            plate->sigma[k] = NAN;
    refused(plate);
}

/* A drawn plate behind a drawn lens, photos as files: dots carried by the motion, then by the lens. */
static void test_drawn_plate(void **state)
{
    (void)state;
    enum { SMALL_W = 480, SMALL_H = 360, TAKEN = 4 };
    const struct lens lens = {.centre = {246, 175}, .k = {-6e-8, 0, 0}, .p = {4e-7, 0, 0}};
    const double poses[TAKEN][3] = {{0, 0, 0}, {45, -12, 0.1}, {-38, 30, -0.12}, {6, -40, 0.05}};
    char paths[TAKEN][200], *moved[TAKEN - 1];
    struct dots dots = dots_make(370, DOTS_NORMAL, 6000);
    for (int p = 0; p < TAKEN; p++) {
        struct canvas canvas = canvas_make(SMALL_W, SMALL_H, 0.8);
        double c = cos(poses[p][2]), s = sin(poses[p][2]);
        for (size_t k = 0; k < dots.count; k++) {
            struct vec there = vec(240 + poses[p][0] + c * dots.x[k] + s * dots.y[k],
                                   180 + poses[p][1] - s * dots.x[k] + c * dots.y[k]);
            if (fabs(there.x - 240) > 280 || fabs(there.y - 180) > 220)
                continue;
            struct vec seen = lens_seen(&lens, there);
            canvas_add_dot(&canvas, seen.x, seen.y, dots.sigma[k], dots.height[k], 0);
        }
        struct photo photo = canvas_photo(&canvas, 1, 0, 0.005, 6100 + (uint64_t)p);
        snprintf(paths[p], sizeof paths[p], "%s/lens_plate_%d.tif", FILM_BINARY_DIR, p);
        check_done(photo_write(paths[p], &photo));
        if (p)
            moved[p - 1] = paths[p];
        free(photo.pixels);
        canvas_free(&canvas);
    }
    const struct plate_options options = {.radius_px = 18, .search_px = 70, .search_deg = 10};
    const struct lens none = {.centre = {240, 180}};
    struct plate plate;
    struct lens_fitted fitted;
    double before, largest;
    check_done(plate_follow(paths[0], moved, TAKEN - 1, &options, &plate));
    check_done(lens_fit(&plate.points, &fitted));
    lens_difference(&lens, &none, SMALL_W, SMALL_H, &before);
    double rms = lens_difference(&fitted.lens, &lens, SMALL_W, SMALL_H, &largest);
    print_message(
        "before %.2f px at most; after RMS %.4f px, largest %.4f px, stated %.4f px; %zu points, RMS %.4f px, "
        "%zu left out\n",
        before, rms, largest, fitted.s_map, fitted.used, fitted.rms, fitted.left_out);
    assert_true(before > 0.5);
    check_at_most(rms, 0.01);
    check_at_most(rms, 4 * fitted.s_map);
    /* The residuals are those of the fit, and the picture shows each of them. */
    double square = 0;
    for (size_t m = 0; m < plate.points.photos * plate.points.count; m++)
        if (!isnan(plate.sigma[m])) {
            struct vec left = lens_residual(&plate.points, &fitted, m / plate.points.count, m % plate.points.count);
            if (vec_norm(left) < 10 * fitted.rms)
                square += vec_dot(left, left) / 2;
        }
    check_near(sqrt(square / (double)fitted.used) / fitted.rms, 1, 0.1);
    const char *picture = FILM_BINARY_DIR "/lens_plate.svg";
    check_done(lens_picture(picture, &plate.points, &fitted));
    FILE *file = fopen(picture, "r");
    assert_non_null(file);
    char line[400];
    size_t arrows = 0;
    while (fgets(line, sizeof line, file))
        arrows += strstr(line, "stroke:none;fill-rule:nonzero") != NULL; /* the dots at their beginnings */
    fclose(file);
    assert_true(arrows > 17 * 13 + plate.points.count / 2 && arrows <= 17 * 13 + plate.points.count);
    plate_free(&plate);
    dots_free(&dots);
}

/* 2000 times four sides of a frame with noisy marks: unbiased, and the scatter is the stated error. */
static void test_scale(void **state)
{
    (void)state;
    const double truth = 6e-5, noise = 0.5;
    const struct vec corners[5] = {{578, 1453}, {7260, 1510}, {7255, 7070}, {568, 7043}, {578, 1453}};
    uint64_t random = 99;
    double sum = 0, square = 0, stated = 0;
    enum { TRIALS = 2000 };
    for (int t = 0; t < TRIALS; t++) {
        struct known_length lengths[4];
        struct scale scale;
        for (int k = 0; k < 4; k++) {
            lengths[k] = (struct known_length){corners[k], corners[k + 1],
                                               truth * vec_norm(vec_sub(corners[k + 1], corners[k]))};
            lengths[k].a.x += noise * check_normal(&random);
            lengths[k].a.y += noise * check_normal(&random);
            lengths[k].b.x += noise * check_normal(&random);
            lengths[k].b.y += noise * check_normal(&random);
        }
        check_done(scale_estimate(lengths, 4, noise, &scale));
        sum += scale.m_per_px - truth;
        square += pow(scale.m_per_px - truth, 2);
        stated += scale.s_m_per_px / TRIALS;
    }
    check_near(sum / TRIALS, 0, 4 * sqrt(square / TRIALS / TRIALS));
    check_near(stated / sqrt(square / TRIALS), 1.15, 0.15); /* the larger of two estimates: on the careful side */
    struct known_length nothing = {{5, 5}, {5, 5}, 1};
    struct scale scale;
    assert_int_equal(scale_estimate(&nothing, 1, noise, &scale), -1);
    assert_int_equal(error_status(), EXIT_INPUT);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_eight_pixels_to_a_hundredth),
        cmocka_unit_test(test_exact_points_give_the_lens),
        cmocka_unit_test(test_wrong_points_are_left_out),
        cmocka_unit_test(test_drawn_plate),
        cmocka_unit_test(test_scale),
        cmocka_unit_test(test_what_cannot_be_determined_is_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
