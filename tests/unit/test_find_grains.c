/* find_grains() in memory on photos that the test draws. */
#include "tests/check.h"
#include "tests/discs.h"
#include "findgrains/find_grains.h"
#include "pipeline/speak/error.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { ROOM = 200 };

struct score {
    size_t matched, extra, flagged;
    double centre, radius, bias;       /* px: RMS per coordinate, RMS, mean */
    double ratio_centre, ratio_radius; /* RMS of error / standard error */
};

static const struct scenery plain = {.void_grey = 1500, .blur = 1.05, .noise = 400, .seed = 3};

static struct find_options options_for(double low, double high)
{
    struct find_options options = FIND_OPTIONS_DEFAULT;
    options.radius_min_px = low;
    options.radius_max_px = high;
    return options;
}

static void paint_greys(struct disc *discs, size_t count, double low, double high)
{
    uint64_t seed = 11;
    for (size_t k = 0; k < count; k++)
        discs[k].grey = low + (high - low) * check_uniform(&seed);
}

static long nearest(const struct photo_grains *grains, const struct disc *disc)
{
    for (size_t k = 0; k < grains->count; k++)
        if (hypot(grains->x_px[k] - disc->x, grains->y_px[k] - disc->y) < 0.2 * disc->radius &&
            fabs(grains->radius_px[k] - disc->radius) < 0.1 * disc->radius)
            return (long)k;
    return -1;
}

static struct score compare(const struct photo_grains *grains, const struct disc *discs, size_t count)
{
    struct score score = {0};
    for (size_t k = 0; k < count; k++) {
        long row = nearest(grains, &discs[k]);
        if (row < 0)
            continue;
        double x = grains->x_px[row] - discs[k].x, y = grains->y_px[row] - discs[k].y;
        double r = grains->radius_px[row] - discs[k].radius;
        score.matched++;
        score.flagged += (grains->flags[row] & GRAIN_DISTRUST) != 0;
        score.centre += 0.5 * (x * x + y * y);
        score.radius += r * r;
        score.bias += r;
        score.ratio_centre += 0.5 * (pow(x / grains->s_x[row], 2) + pow(y / grains->s_y[row], 2));
        score.ratio_radius += pow(r / grains->s_radius[row], 2);
    }
    double n = (double)score.matched;
    score.extra = grains->count - score.matched;
    score.centre = sqrt(score.centre / n);
    score.radius = sqrt(score.radius / n);
    score.bias /= n;
    score.ratio_centre = sqrt(score.ratio_centre / n);
    score.ratio_radius = sqrt(score.ratio_radius / n);
    printf(
        "  %zu of %zu found, %zu extra, %zu flagged; RMS centre %.4f radius %.4f bias %+.4f px; error / standard error "
        "%.2f %.2f\n",
        score.matched, count, score.extra, score.flagged, score.centre, score.radius, score.bias, score.ratio_centre,
        score.ratio_radius);
    return score;
}

static struct score draw_and_find(int width, int height, const struct disc *discs, size_t count,
                                  const struct scenery *scenery, const struct find_options *options)
{
    struct photo photo;
    struct photo_grains grains = {0};
    check_done(discs_draw(width, height, discs, count, scenery, &photo));
    check_done(find_grains(&photo, options, &grains, NULL));
    struct score score = compare(&grains, discs, count);
    table_free(&PHOTO_GRAINS, &grains);
    photo_free(&photo);
    return score;
}

/* A packing in which every disc touches two others at least, rods of very different grey. */
static struct score packing(double dots, double noise, double low, double high)
{
    static const double radii[] = {22, 27, 33, 40};
    struct disc discs[ROOM];
    size_t count = discs_pack(560, 480, radii, 4, 6, 5, discs, ROOM);
    assert_true(count > 25);
    paint_greys(discs, count, low, high);
    struct scenery scenery = plain;
    scenery.dots = dots;
    scenery.noise = noise;
    struct find_options options = options_for(20, 44);
    struct score score = draw_and_find(560, 480, discs, count, &scenery, &options);
    assert_int_equal(score.matched, count);
    assert_int_equal(score.extra, 0);
    return score;
}

static void touching_grains(void **state)
{
    (void)state;
    struct score score = packing(0, 400, 16000, 40000);
    check_at_most(score.centre, 0.02);
    check_at_most(score.radius, 0.015);
    check_near(score.bias, 0, 0.004);
    assert_int_equal(score.flagged, 0);
}

static void specks(void **state)
{
    (void)state;
    struct score score = packing(0.2, 400, 20000, 36000);
    check_at_most(score.centre, 0.06);
    check_at_most(score.radius, 0.06);
}

static void noise(void **state)
{
    (void)state;
    struct score score = packing(0, 1500, 20000, 36000);
    check_at_most(score.centre, 0.05);
    check_at_most(score.radius, 0.04);
}

static void one_grain(void **state)
{
    (void)state;
    struct disc disc = {.x = 101.4, .y = 92.7, .radius = 30.2, .grey = 30000};
    struct find_options options = options_for(20, 40);
    struct score score = draw_and_find(200, 180, &disc, 1, &plain, &options);
    assert_int_equal(score.matched, 1);
    assert_int_equal(score.extra, 0);
    check_at_most(score.centre, 0.02);
}

static void cut_grain_is_flagged(void **state)
{
    (void)state;
    struct disc discs[2] = {{.x = 15.3, .y = 90.2, .radius = 30, .grey = 30000},
                            {.x = 120.3, .y = 90.6, .radius = 30, .grey = 30000}};
    struct find_options options = options_for(20, 40);
    struct photo photo;
    struct photo_grains grains = {0};
    check_done(discs_draw(200, 180, discs, 2, &plain, &photo));
    check_done(find_grains(&photo, &options, &grains, NULL));
    assert_int_equal(grains.count, 2);
    long cut = nearest(&grains, &discs[0]), whole = nearest(&grains, &discs[1]);
    assert_true(cut >= 0 && whole >= 0);
    assert_true(grains.flags[cut] & GRAIN_CUT);
    assert_int_equal(grains.flags[whole], 0);
    check_near(grains.x_px[cut], discs[0].x, 0.1);
    table_free(&PHOTO_GRAINS, &grains);
    photo_free(&photo);
}

/* A bright disc outside the frame is none of the specimen's. */
static void frame_bounds_the_search(void **state)
{
    (void)state;
    struct disc discs[2] = {{.x = 60, .y = 90.2, .radius = 30, .grey = 30000},
                            {.x = 180.3, .y = 90.6, .radius = 30, .grey = 30000}};
    struct find_options options = options_for(20, 40);
    struct vec corners[4] = {{120, 20}, {280, 22}, {281, 170}, {119, 168}};
    options.has_frame = 1;
    memcpy(options.corners_px, corners, sizeof corners);
    options.corner_radius_px = 15;
    struct score score = draw_and_find(300, 190, discs, 2, &plain, &options);
    assert_int_equal(score.matched, 1);
    assert_int_equal(score.extra, 0);
}

static void no_grain_is_an_error(void **state)
{
    (void)state;
    const double greys[] = {0, 65535, 3000};
    const double noises[] = {0, 0, 300};
    struct find_options options = options_for(20, 40);
    for (int k = 0; k < 3; k++) {
        struct photo photo;
        struct photo_grains grains = {0};
        struct scenery scenery = {.void_grey = greys[k], .noise = noises[k], .seed = 9};
        check_done(discs_draw(200, 180, NULL, 0, &scenery, &photo));
        assert_int_equal(find_grains(&photo, &options, &grains, NULL), -1);
        assert_int_equal(error_status(), EXIT_INPUT);
        assert_non_null(strstr(error_message(), "no grain found"));
        assert_int_equal(grains.count, 0);
        photo_free(&photo);
    }
}

/* Discs somewhat beyond the range are found too, and flagged; those within it are not. */
static void radii_outside_the_range_are_flagged(void **state)
{
    (void)state;
    static const double radii[] = {20, 25, 29.5, 26};
    struct disc discs[ROOM];
    size_t count = discs_pack(400, 400, radii, 4, 6, 5, discs, ROOM), outside = 0;
    struct find_options options = options_for(22, 28);
    struct photo photo;
    struct photo_grains grains = {0};
    paint_greys(discs, count, 20000, 40000);
    check_done(discs_draw(400, 400, discs, count, &plain, &photo));
    check_done(find_grains(&photo, &options, &grains, NULL));
    for (size_t k = 0; k < grains.count; k++) {
        double margin = 3 * grains.s_radius[k], radius = grains.radius_px[k];
        int flagged = (grains.flags[k] & GRAIN_OUTSIDE_RANGE) != 0;
        assert_int_equal(flagged, radius < 22 - margin || radius > 28 + margin);
        outside += (size_t)flagged;
    }
    assert_true(outside > 0 && outside < grains.count);
    table_free(&PHOTO_GRAINS, &grains);
    photo_free(&photo);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(touching_grains),
        cmocka_unit_test(specks),
        cmocka_unit_test(noise),
        cmocka_unit_test(one_grain),
        cmocka_unit_test(cut_grain_is_flagged),
        cmocka_unit_test(frame_bounds_the_search),
        cmocka_unit_test(no_grain_is_an_error),
        cmocka_unit_test(radii_outside_the_range_are_flagged),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
