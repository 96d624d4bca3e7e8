/* Two rods pressed together: fits on known curves, on drawn and tracked photos, and everything that is refused. */
#include "tests/check.h"

#include <string.h>

#include "calibration/rods/stiffness.h"
#include "pipeline/speak/error.h"
#include "tests/pressed_rods.h"

/* The law's points with noise of known size. */
static void make_points(struct press_point points[ROD_PHOTOS], double s, uint64_t seed)
{
    for (int k = 0; k < ROD_PHOTOS; k++)
        points[k] = (struct press_point){.index = k,
                                         .time = k,
                                         .force = pressed_force(k),
                                         .deflection = pressed_deflection(k) + s * check_normal(&seed),
                                         .s = s,
                                         .used = 1};
}

static void check_law(const struct stiffness *stiffness, double share, double force)
{
    const struct pressed_law *law = &PRESSED_LAW;
    assert_int_equal(stiffness->phase_count, 3);
    const struct press_fit *first = &stiffness->phase[0], *back = &stiffness->phase[1], *again = &stiffness->phase[2];
    assert_int_equal(first->kind, PRESS_LOADING);
    assert_int_equal(back->kind, PRESS_UNLOADING);
    assert_int_equal(again->kind, PRESS_RELOADING);
    check_near(first->k_high / law->k_high, 1, share);
    check_near(first->k_low / law->k_low, 1, share);
    check_near(first->break_force, law->at, force);
    check_near(again->k_high / law->again_high, 1, share);
    check_near(again->break_force, law->again_at, 8 * force); /* a break of 27 %, not 108 % */
    check_near(back->k_line / law->k_back, 1, share);
    assert_true(isnan(back->break_force));
    check_near(stiffness->unloading, back->k_line, 0);
    check_near(stiffness->kn / (0.5 * (law->k_high + law->again_high)), 1, share);
}

static void exact_points_give_the_law_back(void **state)
{
    (void)state;
    struct press_point points[ROD_PHOTOS];
    struct press_options options = PRESS_DEFAULT;
    struct stiffness stiffness;
    make_points(points, 0, 1);
    check_done(stiffness_fit(points, ROD_PHOTOS, &options, &stiffness));
    check_law(&stiffness, 1e-6, 1e-3);
    stiffness_free(&stiffness);
}

/* Errors over many draws: neither too small nor too large. */
static void stated_errors_are_the_scatter(void **state)
{
    (void)state;
    enum { DRAWS = 400 };
    double sum = 0, squares = 0, break_squares = 0, unload = 0;
    struct press_options options = PRESS_DEFAULT;
    for (uint64_t draw = 0; draw < DRAWS; draw++) {
        struct press_point points[ROD_PHOTOS];
        struct stiffness stiffness;
        make_points(points, 3e-7, 100 + draw);
        check_done(stiffness_fit(points, ROD_PHOTOS, &options, &stiffness));
        double truth = 0.5 * (PRESSED_LAW.k_high + PRESSED_LAW.again_high);
        double z = (stiffness.phase[0].k_high - PRESSED_LAW.k_high) / stiffness.phase[0].s_high;
        double b = (stiffness.phase[0].break_force - PRESSED_LAW.at) / stiffness.phase[0].s_break;
        double u = (stiffness.unloading - PRESSED_LAW.k_back) / stiffness.s_unloading;
        sum += (stiffness.kn - truth) / truth / DRAWS;
        squares += z * z / DRAWS, break_squares += b * b / DRAWS, unload += u * u / DRAWS;
        stiffness_free(&stiffness);
    }
    check_near(sum, 0, 1e-3);
    check_near(squares, 1, 0.3);
    check_near(break_squares, 1, 0.4);
    check_near(unload, 1, 0.3);
}

static void a_power_law_is_found(void **state)
{
    (void)state;
    struct press_point points[30];
    struct press_options options = PRESS_DEFAULT;
    struct stiffness stiffness;
    for (int k = 0; k < 30; k++) {
        double force = 900.0 * k / 29;
        points[k] = (struct press_point){
            .index = k, .force = force, .deflection = 3e-6 + pow(force / 2e9, 2.0 / 3), .s = 1e-8, .used = 1};
    }
    check_done(stiffness_fit(points, 30, &options, &stiffness));
    check_near(stiffness.phase[0].power_n, 1.5, 1e-5);
    check_near(stiffness.phase[0].power_c / 2e9, 1, 1e-4);
    check_at_most(stiffness.phase[0].rms_power, 1e-3 * stiffness.phase[0].rms_bilinear);
    stiffness_free(&stiffness);
}

static void one_slope_has_no_break(void **state)
{
    (void)state;
    struct press_options options = PRESS_DEFAULT;
    int breaks = 0;
    for (uint64_t draw = 0; draw < 200; draw++) {
        struct press_point points[20];
        struct stiffness stiffness;
        uint64_t seed = 7 + draw;
        for (int k = 0; k < 20; k++)
            points[k] = (struct press_point){.index = k,
                                             .force = 50 * k,
                                             .deflection = 50 * k / 1e7 + 1e-7 * check_normal(&seed),
                                             .s = 1e-7,
                                             .used = 1};
        check_done(stiffness_fit(points, 20, &options, &stiffness));
        breaks += isfinite(stiffness.phase[0].break_force);
        stiffness_free(&stiffness);
    }
    assert_in_range(breaks, 0, 4); /* 3 in 10000 by chance for one place, here the best of many */
}

static struct force_record record_of(double delay)
{
    static double at[ROD_PHOTOS], force[ROD_PHOTOS];
    for (int k = 0; k < ROD_PHOTOS; k++)
        at[k] = 2 * k + delay, force[k] = pressed_force(k);
    return (struct force_record){.count = ROD_PHOTOS, .at = at, .force = force};
}

static void drawn_rods_give_their_stiffness(void **state)
{
    (void)state;
    struct pressed_rods rods = {.scale = 6e-5, .radius_px = 48, .noise = 0.01, .seed = 11};
    struct press_series_options series = {.rods = {0, 1}, .scale = rods.scale};
    struct press_options options = PRESS_DEFAULT;
    struct press_photo tracked[ROD_PHOTOS] = {0};
    struct press_point points[ROD_PHOTOS];
    struct stiffness stiffness;
    struct force_record record = record_of(0);
    check_done(pressed_follow(&rods, tracked));
    check_done(press_series_points(tracked, ROD_PHOTOS, &record, &series, points));
    check_done(stiffness_fit(points, ROD_PHOTOS, &options, &stiffness));
    check_law(&stiffness, 0.02, 20);
    check_near(stiffness.kn, 0.5 * (PRESSED_LAW.k_high + PRESSED_LAW.again_high), 4 * stiffness.s_kn);
    check_at_most(stiffness.s_kn / stiffness.kn, 0.006);
    stiffness_free(&stiffness);

    /* A rod that the tracker does not trust: the row stays and is not used. */
    tracked[5].grains.flags[1] |= GRAIN_LOST;
    check_done(press_series_points(tracked, ROD_PHOTOS, &record, &series, points));
    assert_int_equal(points[5].used, 0);
    assert_int_equal(points[6].used, 1);
    for (int k = 0; k < ROD_PHOTOS; k++)
        press_photo_free(&tracked[k]);
}

static void what_cannot_be_measured_is_refused(void **state)
{
    (void)state;
    struct press_point points[ROD_PHOTOS];
    struct press_options options = PRESS_DEFAULT;
    struct stiffness stiffness;
    make_points(points, 0, 1);
    assert_int_equal(stiffness_fit(points, 1, &options, &stiffness), -1);
    assert_non_null(strstr(error_message(), "1 usable photo"));
    for (int k = 0; k < ROD_PHOTOS; k++)
        points[k].deflection = -points[k].deflection;
    assert_int_equal(stiffness_fit(points, ROD_PHOTOS, &options, &stiffness), -1);
    assert_int_equal(error_status(), EXIT_INPUT);
    assert_non_null(strstr(error_message(), "part while the force grows"));
    for (int k = 0; k < ROD_PHOTOS; k++)
        points[k].force = 5;
    assert_int_equal(stiffness_fit(points, ROD_PHOTOS, &options, &stiffness), -1);
}

static void clocks_that_do_not_meet_are_told(void **state)
{
    (void)state;
    struct pressed_rods rods = {.scale = 6e-5, .radius_px = 48, .noise = 0, .seed = 3};
    struct press_series_options series = {.rods = {0, 1}, .scale = rods.scale};
    struct press_photo photos[3] = {0};
    struct press_point points[3];
    for (int k = 0; k < 3; k++) {
        check_done(pressed_place(&rods, k, &photos[k].grains));
        photos[k].time = 2 * k;
    }
    struct force_record record = record_of(3600);
    assert_int_equal(press_series_points(photos, 3, &record, &series, points), -1);
    assert_non_null(strstr(error_message(), "no photo lies inside the force record: photos 0 to 4 s, record 3600"));
    series.delay = 3600;
    check_done(press_series_points(photos, 3, &record, &series, points));
    check_near(points[2].force, pressed_force(2), 1e-9);
    check_near(points[2].deflection, pressed_deflection(2), 1e-12);
    series.rods[1] = 2;
    assert_int_equal(press_series_points(photos, 3, &record, &series, points), -1);
    for (int k = 0; k < 3; k++)
        press_photo_free(&photos[k]);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(exact_points_give_the_law_back),
        cmocka_unit_test(stated_errors_are_the_scatter),
        cmocka_unit_test(a_power_law_is_found),
        cmocka_unit_test(one_slope_has_no_break),
        cmocka_unit_test(drawn_rods_give_their_stiffness),
        cmocka_unit_test(what_cannot_be_measured_is_refused),
        cmocka_unit_test(clocks_that_do_not_meet_are_told),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
