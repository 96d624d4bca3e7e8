/* track_grains() on drawn packings: every grain within its error or flagged, never wrong in silence. */
#include "tests/drawn_packing.h"

#include <stdio.h>

#include "pipeline/speak/error.h"

static void test_every_grain_is_followed(void **state)
{
    (void)state;
    struct packing packing;
    packing_make(&packing, 1);
    struct photo reference = packing_photo(&packing, 0.01, 1);
    struct photo_grains grains = packing_grains(&packing);
    struct tracker_options options = TRACKER_DEFAULT;
    struct tracks tracks = {0};
    packing_move(&packing, 0.6, -0.4, 0.8, 1.5 * degree, 2);
    struct photo photo = packing_photo(&packing, 0.01, 2);
    check_done(track_grains(&reference, &grains, &photo, NULL, &options, &tracks));
    assert_int_equal(tracks.grains.count, COUNT);
    for (int k = 0; k < COUNT; k++) {
        check_grain(&tracks.grains, &packing, k, 5);
        check_near(tracks.grains.x_ref_px[k], packing.x[k], 0);
        check_near(tracks.grains.s_y_ref[k], 0.01, 0);
        check_near(tracks.grains.radius_px[k], radius, 0);
        assert_true(isnan(tracks.grains.dx_px[k])); /* there was no photo before */
    }
    tracks_free(&tracks);
    table_free(&PHOTO_GRAINS, &grains);
    free(photo.pixels);
    free(reference.pixels);
    packing_free(&packing);
}

/* 3 % noise and small subsets: half a degree is within four standard errors, and the flag says so. */
static void test_vague_grains_are_named(void **state)
{
    (void)state;
    struct packing packing;
    packing_make(&packing, 17);
    struct photo reference = packing_photo(&packing, 0.03, 1);
    struct photo_grains grains = packing_grains(&packing);
    struct tracker_options options = TRACKER_DEFAULT;
    packing_move(&packing, 0.6, -0.4, 0.8, 1.5 * degree, 2);
    struct photo photo = packing_photo(&packing, 0.03, 2);
    for (int small = 0; small < 2; small++) {
        struct tracks tracks = {0};
        int vague = 0;
        options.subset = small ? 10 / radius : 0.95;
        check_done(track_grains(&reference, &grains, &photo, NULL, &options, &tracks));
        for (int k = 0; k < COUNT; k++) {
            vague += (tracks.grains.flags[k] & GRAIN_VAGUE) != 0;
            if (!(tracks.grains.flags[k] & GRAIN_LOST))
                assert_int_equal((tracks.grains.flags[k] & GRAIN_VAGUE) != 0,
                                 tracks.grains.s_angle[k] > 0.125 * degree);
        }
        assert_true(small ? vague > COUNT / 2 : vague == 0);
        tracks_free(&tracks);
    }
    table_free(&PHOTO_GRAINS, &grains);
    free(photo.pixels);
    free(reference.pixels);
    packing_free(&packing);
}

static void test_the_reference_has_not_moved(void **state)
{
    (void)state;
    struct packing packing;
    packing_make(&packing, 3);
    struct photo reference = packing_photo(&packing, 0.01, 1), again = packing_photo(&packing, 0.01, 1);
    struct photo_grains grains = packing_grains(&packing);
    struct tracker_options options = TRACKER_DEFAULT;
    struct tracks tracks = {0};
    check_done(track_grains(&reference, &grains, &again, NULL, &options, &tracks));
    for (int k = 0; k < COUNT; k++) {
        check_near(tracks.grains.x_px[k], grains.x_px[k], 0);
        check_near(tracks.grains.angle[k], 0, 0);
        check_near(tracks.grains.s_x[k], 0, 0);
        assert_int_equal(tracks.grains.flags[k], 0);
    }
    tracks_free(&tracks);
    table_free(&PHOTO_GRAINS, &grains);
    free(again.pixels);
    free(reference.pixels);
    packing_free(&packing);
}

/* Flags of the reference's file: what they say of the circle holds in every photo, how a grain was matched there does
 * not. */
static void test_flags_of_the_circle_are_kept(void **state)
{
    (void)state;
    struct packing packing;
    packing_make(&packing, 3);
    struct photo reference = packing_photo(&packing, 0.01, 1), again = packing_photo(&packing, 0.01, 1);
    struct photo_grains grains = packing_grains(&packing);
    struct tracker_options options = TRACKER_DEFAULT;
    struct tracks tracks = {0};
    const uint32_t of_circle = GRAIN_WEAK_EDGE | GRAIN_FLANK | GRAIN_BY_HAND;
    const uint32_t of_match = GRAIN_LOW_ZNCC | GRAIN_LOST | GRAIN_RESCUED | GRAIN_MASKED | GRAIN_RATTLER | GRAIN_VAGUE;
    grains.flags[3] = of_circle | of_match;
    check_done(track_grains(&reference, &grains, &again, NULL, &options, &tracks));
    assert_int_equal(tracks.grains.flags[3], of_circle);
    assert_int_equal(tracks.grains.flags[4], 0);
    tracks_free(&tracks);
    table_free(&PHOTO_GRAINS, &grains);
    free(again.pixels);
    free(reference.pixels);
    packing_free(&packing);
}

/* Shifts that no start can reach are found by the search; the photo after is found from there. */
static void test_far_grains_are_found_and_predicted(void **state)
{
    (void)state;
    struct packing packing;
    packing_make(&packing, 5);
    struct photo reference = packing_photo(&packing, 0.01, 1);
    struct photo_grains grains = packing_grains(&packing);
    struct tracker_options options = TRACKER_DEFAULT;
    struct tracks first = {0}, second = {0};
    packing_move(&packing, 24, -19, 1, 9 * degree, 6);
    struct photo photo = packing_photo(&packing, 0.01, 2);
    struct tracker *tracker = tracker_open(&reference, &grains, &options);
    assert_non_null(tracker);
    check_done(tracker_follow(tracker, &photo, NULL, &first));
    for (int k = 0; k < COUNT; k++)
        check_grain(&first.grains, &packing, k, 5);
    for (int k = 0; k < COUNT; k++)
        packing.motion[k].u += 0.5;
    struct photo next = packing_photo(&packing, 0.01, 3);
    check_done(tracker_follow(tracker, &next, &first.grains, &second));
    for (int k = 0; k < COUNT; k++) {
        check_grain(&second.grains, &packing, k, 5);
        assert_int_equal(second.grains.flags[k] & GRAIN_RESCUED, 0);
        check_near(second.grains.dx_px[k], 0.5, 0.05);
    }
    tracker_close(tracker);
    tracks_free(&first);
    tracks_free(&second);
    table_free(&PHOTO_GRAINS, &grains);
    free(photo.pixels);
    free(next.pixels);
    free(reference.pixels);
    packing_free(&packing);
}

/* A file of the photo before may lack columns and hold any number: such grains are looked for from nothing. */
static void test_absurd_starts(void **state)
{
    (void)state;
    static const double absurd[] = {NAN, INFINITY, -INFINITY, 1e300, -1e300, 1e18, 3e9, -3e9};
    struct packing packing;
    packing_make(&packing, 5);
    struct photo reference = packing_photo(&packing, 0.01, 1);
    struct photo_grains grains = packing_grains(&packing);
    struct tracker_options options = TRACKER_DEFAULT;
    struct tracks first = {0}, second = {0}, third = {0};
    packing_move(&packing, 2, -1.5, 1, 2 * degree, 6);
    struct photo photo = packing_photo(&packing, 0.01, 2);
    check_done(track_grains(&reference, &grains, &photo, NULL, &options, &first));
    check_done(track_grains(&reference, &grains, &photo, &first.grains, &options, &second));
    double *const columns[] = {second.grains.x_seen_px, second.grains.y_seen_px, second.grains.angle_seen,
                               second.grains.dx_px, second.grains.dangle};
    for (size_t c = 0; c < 5; c++)
        for (size_t k = 0; k < 4; k++)
            columns[c][4 * c + k] = absurd[(4 * c + k) % 8];
    for (int round = 0; round < 2; round++) {
        check_done(track_grains(&reference, &grains, &photo, &second.grains, &options, &third));
        for (int k = 0; k < COUNT; k++)
            check_grain(&third.grains, &packing, k, 5);
        tracks_free(&third);
        free(second.grains.dy_px); /* dx_px without dy_px */
        second.grains.dy_px = NULL;
    }
    tracks_free(&first);
    tracks_free(&second);
    table_free(&PHOTO_GRAINS, &grains);
    free(photo.pixels);
    free(reference.pixels);
    packing_free(&packing);
}

/* A grain with another face is lost, its neighbours are not; when its face comes back, it is found again. */
static void test_a_replaced_grain_is_lost_and_found_again(void **state)
{
    (void)state;
    struct packing packing;
    packing_make(&packing, 7);
    struct photo reference = packing_photo(&packing, 0.01, 1);
    struct photo_grains grains = packing_grains(&packing);
    struct tracker_options options = TRACKER_DEFAULT;
    struct tracks lost = {0}, found = {0};
    packing_move(&packing, 0.3, 0.2, 0.5, 1 * degree, 8);
    struct dots face = packing.dots[7];
    packing.dots[7] = dots_make(radius, DOTS_NORMAL, 4242);
    struct photo photo = packing_photo(&packing, 0.01, 2);
    check_done(track_grains(&reference, &grains, &photo, NULL, &options, &lost));
    for (int k = 0; k < COUNT; k++)
        if (k != 7)
            check_grain(&lost.grains, &packing, k, 5);
    assert_int_equal(lost.grains.flags[7] & GRAIN_LOST, GRAIN_LOST);
    assert_true(isnan(lost.grains.x_px[7]) && isnan(lost.grains.angle[7]));
    dots_free(&packing.dots[7]);
    packing.dots[7] = face;
    packing.motion[7].u += 9; /* it has gone on meanwhile */
    struct photo next = packing_photo(&packing, 0.01, 3);
    check_done(track_grains(&reference, &grains, &next, &lost.grains, &options, &found));
    for (int k = 0; k < COUNT; k++)
        check_grain(&found.grains, &packing, k, 5);
    assert_true(isnan(found.grains.dx_px[7]));
    tracks_free(&lost);
    tracks_free(&found);
    table_free(&PHOTO_GRAINS, &grains);
    free(photo.pixels);
    free(next.pixels);
    free(reference.pixels);
    packing_free(&packing);
}

static void test_a_black_photo_loses_every_grain(void **state)
{
    (void)state;
    struct packing packing;
    packing_make(&packing, 9);
    struct photo reference = packing_photo(&packing, 0.01, 1);
    struct photo_grains grains = packing_grains(&packing);
    struct tracker_options options = TRACKER_DEFAULT;
    struct tracks tracks = {0};
    struct canvas canvas = canvas_make(WIDTH, HEIGHT, 0);
    for (int noisy = 0; noisy < 2; noisy++) {
        struct photo black = canvas_photo(&canvas, 1, noisy * 0.05, noisy * 0.01, 3);
        check_done(track_grains(&reference, &grains, &black, NULL, &options, &tracks));
        for (int k = 0; k < COUNT; k++)
            assert_int_equal(tracks.grains.flags[k] & GRAIN_LOST, GRAIN_LOST);
        assert_int_equal(tracks_flagged(&tracks), COUNT);
        tracks_free(&tracks);
        free(black.pixels);
    }
    canvas_free(&canvas);
    table_free(&PHOTO_GRAINS, &grains);
    free(reference.pixels);
    packing_free(&packing);
}

/* Grains that leave the view: followed while half of the subset is there, then flagged. */
static void test_the_border(void **state)
{
    (void)state;
    struct packing packing;
    packing_make(&packing, 11);
    struct photo reference = packing_photo(&packing, 0.01, 1);
    struct photo_grains grains = packing_grains(&packing);
    struct tracker_options options = TRACKER_DEFAULT;
    struct tracks tracks = {0};
    for (int step = 1; step <= 11; step++) { /* 8 px a step to the left: column 0 starts at x = 80 */
        struct tracks next = {0};
        packing_move(&packing, -8 * step, 0, 0, 0, 12);
        struct photo photo = packing_photo(&packing, 0.01, 1 + (uint64_t)step);
        check_done(
            track_grains(&reference, &grains, &photo, tracks.grains.count ? &tracks.grains : NULL, &options, &next));
        tracks_free(&tracks);
        tracks = next;
        for (int k = 0; k < COUNT; k++) {
            double left = packing.x[k] - 8 * step - 0.8 * radius;
            if (left > 3)
                check_grain(&tracks.grains, &packing, k, 5);
            else if (left < -0.8 * radius)
                assert_true(tracks.grains.flags[k] & (GRAIN_OUT_OF_VIEW | GRAIN_LOST));
            else if (!(tracks.grains.flags[k] & GRAIN_DISTRUST))
                assert_true(tracks.grains.flags[k] & GRAIN_MASKED || left > 0),
                    check_grain(&tracks.grains, &packing, k, 5);
        }
        free(photo.pixels);
    }
    tracks_free(&tracks);
    table_free(&PHOTO_GRAINS, &grains);
    free(reference.pixels);
    packing_free(&packing);
}

static void test_rows_without_numbers_keep_their_place(void **state)
{
    (void)state;
    struct packing packing;
    packing_make(&packing, 13);
    struct photo reference = packing_photo(&packing, 0.01, 1);
    struct photo_grains grains = packing_grains(&packing);
    struct tracker_options options = TRACKER_DEFAULT;
    struct tracks tracks = {0};
    grains.x_px[3] = NAN;
    grains.radius_px[4] = -1;
    grains.x_px[5] = -500;
    grains.flags[6] = GRAIN_CUT | GRAIN_FLANK;
    packing_move(&packing, 0.4, 0.1, 0.2, 0.3 * degree, 14);
    struct photo photo = packing_photo(&packing, 0.01, 2);
    check_done(track_grains(&reference, &grains, &photo, NULL, &options, &tracks));
    assert_int_equal(tracks.grains.count, COUNT);
    assert_int_equal(tracks.grains.flags[3], GRAIN_NOT_FINITE | GRAIN_LOST);
    assert_int_equal(tracks.grains.flags[4], GRAIN_NOT_FINITE | GRAIN_LOST);
    assert_true(tracks.grains.flags[5] & GRAIN_LOST && tracks.grains.flags[5] & GRAIN_OUT_OF_VIEW);
    assert_int_equal(tracks.grains.flags[6], GRAIN_CUT | GRAIN_FLANK);
    for (int k = 7; k < COUNT; k++)
        check_grain(&tracks.grains, &packing, k, 5);
    tracks_free(&tracks);
    table_free(&PHOTO_GRAINS, &grains);
    free(photo.pixels);
    free(reference.pixels);
    packing_free(&packing);
}

static void test_wrong_input_is_refused(void **state)
{
    (void)state;
    struct packing packing;
    packing_make(&packing, 15);
    struct photo reference = packing_photo(&packing, 0, 1), cropped = reference;
    struct photo_grains grains = packing_grains(&packing), fewer = grains;
    struct tracker_options options = TRACKER_DEFAULT;
    struct tracks tracks = {0};
    cropped.height--;
    assert_int_equal(track_grains(&reference, &grains, &cropped, NULL, &options, &tracks), -1);
    assert_int_equal(error_status(), EXIT_INPUT);
    fewer.count--;
    assert_int_equal(track_grains(&reference, &grains, &reference, &fewer, &options, &tracks), -1);
    assert_int_equal(error_status(), EXIT_INPUT);
    fewer.count = 0;
    check_done(track_grains(&reference, &fewer, &reference, NULL, &options, &tracks));
    assert_int_equal(tracks.grains.count, 0);
    tracks_free(&tracks);
    table_free(&PHOTO_GRAINS, &grains);
    free(reference.pixels);
    packing_free(&packing);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_every_grain_is_followed),
        cmocka_unit_test(test_vague_grains_are_named),
        cmocka_unit_test(test_the_reference_has_not_moved),
        cmocka_unit_test(test_flags_of_the_circle_are_kept),
        cmocka_unit_test(test_far_grains_are_found_and_predicted),
        cmocka_unit_test(test_absurd_starts),
        cmocka_unit_test(test_a_replaced_grain_is_lost_and_found_again),
        cmocka_unit_test(test_a_black_photo_loses_every_grain),
        cmocka_unit_test(test_the_border),
        cmocka_unit_test(test_rows_without_numbers_keep_their_place),
        cmocka_unit_test(test_wrong_input_is_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
