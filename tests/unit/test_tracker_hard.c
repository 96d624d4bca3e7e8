/* Hard cases: each grain is followed within its error or flagged, never wrong in silence. */
#include "tests/drawn_packing.h"

/* Not flagged means right. Returns the number of flagged grains. */
static int right_or_flagged(const struct photo_grains *tracks, const struct packing *packing)
{
    int flagged = 0;
    for (int k = 0; k < COUNT; k++) {
        const struct motion *truth = &packing->motion[k];
        if (tracks->flags[k] & GRAIN_DISTRUST) {
            flagged++;
            continue;
        }
        check_near(tracks->x_px[k], packing->x[k] + truth->u, 5 * tracks->s_x[k] + 0.005);
        check_near(tracks->y_px[k], packing->y[k] + truth->v, 5 * tracks->s_y[k] + 0.005);
        check_near(remainder(tracks->angle[k] - truth->angle, 360 * degree), 0, 5 * tracks->s_angle[k] + 3e-4);
    }
    return flagged;
}

static int track(const struct packing *packing, const struct photo *reference, const struct photo *photo,
                 const struct tracker_options *options)
{
    struct photo_grains grains = packing_grains(packing);
    struct tracks tracks = {0};
    check_done(track_grains(reference, &grains, photo, NULL, options, &tracks));
    int flagged = right_or_flagged(&tracks.grains, packing);
    tracks_free(&tracks);
    table_free(&PHOTO_GRAINS, &grains);
    return flagged;
}

static void test_quarter_and_half_turns(void **state)
{
    (void)state;
    struct packing packing;
    struct tracker_options options = TRACKER_DEFAULT;
    options.search_deg = 180;
    options.search_px = 8;
    packing_make(&packing, 21);
    struct photo reference = packing_photo(&packing, 0.01, 1);
    for (int k = 0; k < COUNT; k++)
        packing.motion[k] = (struct motion){2.3, -1.1, (k % 3 - 1) * 90 * degree + (k % 2) * 180 * degree};
    struct photo photo = packing_photo(&packing, 0.01, 2);
    assert_int_equal(track(&packing, &reference, &photo, &options), 0);
    free(reference.pixels);
    free(photo.pixels);
    packing_free(&packing);
}

static void test_light_and_contrast(void **state)
{
    (void)state;
    const double gains[] = {1.3, 0.7, 0.12}, offsets[] = {0, 0, 0.4};
    struct packing packing;
    struct tracker_options options = TRACKER_DEFAULT;
    packing_make(&packing, 22);
    for (int k = 0; k < 3; k++) {
        struct canvas canvas = packing_canvas(&packing);
        struct photo reference = canvas_photo(&canvas, k == 2 ? 0.12 : 1, offsets[k], 0.005, 1);
        canvas_free(&canvas);
        packing_move(&packing, 0.7, 0.3, 0.5, 1 * degree, 23);
        canvas = packing_canvas(&packing);
        struct photo photo = canvas_photo(&canvas, gains[k], offsets[k], 0.005, 2);
        assert_int_equal(track(&packing, &reference, &photo, &options), 0);
        packing_move(&packing, 0, 0, 0, 0, 23);
        canvas_free(&canvas);
        free(reference.pixels);
        free(photo.pixels);
    }
    packing_free(&packing);
}

/* Every grain wears the same face and the packing moves by half its pitch: the search cannot know; it must say so. */
static void test_repeated_faces(void **state)
{
    (void)state;
    struct packing packing;
    struct tracker_options options = TRACKER_DEFAULT;
    packing_make(&packing, 24);
    for (int k = 1; k < COUNT; k++) {
        dots_free(&packing.dots[k]);
        packing.dots[k] = dots_make(radius, DOTS_NORMAL, 2400);
    }
    struct photo reference = packing_photo(&packing, 0.01, 1);
    packing_move(&packing, 31, -0.5, 0.3, 0.5 * degree, 25);
    struct photo photo = packing_photo(&packing, 0.01, 2);
    track(&packing, &reference, &photo, &options);
    packing_move(&packing, 0.6, -0.5, 0.3, 0.5 * degree, 25); /* a small motion is no riddle */
    struct photo near = packing_photo(&packing, 0.01, 3);
    assert_int_equal(track(&packing, &reference, &near, &options), 0);
    free(reference.pixels);
    free(photo.pixels);
    free(near.pixels);
    packing_free(&packing);
}

/* The frame hides a part of some grains. */
static void test_under_the_frame(void **state)
{
    (void)state;
    struct packing packing;
    struct tracker_options options = TRACKER_DEFAULT;
    packing_make(&packing, 26);
    struct photo reference = packing_photo(&packing, 0.01, 1);
    packing_move(&packing, -0.7, 0.4, 0.4, 0.5 * degree, 27);
    for (int edge = 60; edge <= 110; edge += 10) {
        struct photo photo = packing_photo(&packing, 0.01, 2);
        for (int y = 0; y < HEIGHT; y++)
            for (int x = 0; x < edge; x++)
                photo.pixels[y * WIDTH + x] = (uint16_t)(1500 + (x * 7 + y * 13) % 50);
        int flagged = track(&packing, &reference, &photo, &options);
        assert_true(flagged <= ROWS); /* the first column only */
        free(photo.pixels);
    }
    free(reference.pixels);
    packing_free(&packing);
}

/* Specks of white paint that saturate, 3 % of the area, moving with their grains. */
static void test_saturated_specks(void **state)
{
    (void)state;
    struct packing packing;
    struct tracker_options options = TRACKER_DEFAULT;
    packing_make(&packing, 28);
    for (int k = 0; k < COUNT; k++)
        for (size_t d = 0; d < packing.dots[k].count; d += 12)
            packing.dots[k].height[d] = 3;
    struct photo reference = packing_photo(&packing, 0.01, 1);
    packing_move(&packing, 0.3, 0.6, 0.5, 1 * degree, 29);
    struct photo photo = packing_photo(&packing, 0.01, 2);
    assert_true(track(&packing, &reference, &photo, &options) <= 1);
    free(reference.pixels);
    free(photo.pixels);
    packing_free(&packing);
}

/* Bare wood with three specks on each face, 3 % of it: followed where they tell, else flagged. */
static void test_few_specks(void **state)
{
    (void)state;
    struct packing packing;
    struct tracker_options options = TRACKER_DEFAULT;
    int flagged = 0;
    enum { PACKINGS = 4 };
    for (uint64_t key = 0; key < PACKINGS; key++) {
        packing_make(&packing, 3600 + key);
        for (int k = 0; k < COUNT; k++) {
            packing.dots[k].count = 3;
            for (size_t d = 0; d < 3; d++)
                packing.dots[k].height[d] = -0.5;
        }
        struct photo reference = packing_photo(&packing, 0.01, 1);
        packing_move(&packing, 0.3, 0.6, 0.5, 1 * degree, 37);
        struct photo photo = packing_photo(&packing, 0.01, 2);
        flagged += track(&packing, &reference, &photo, &options);
        free(reference.pixels);
        free(photo.pixels);
        packing_free(&packing);
    }
    print_message("few specks: %d of %d flagged\n", flagged, PACKINGS * COUNT);
    assert_true(flagged <= PACKINGS * COUNT / 4);
}

/* Subsets of 8 px: no silent mistakes, and most of them found. */
static void test_tiny_subsets(void **state)
{
    (void)state;
    struct packing packing;
    struct tracker_options options = TRACKER_DEFAULT;
    options.subset = 8 / radius;
    packing_make(&packing, 30);
    struct photo reference = packing_photo(&packing, 0.01, 1);
    packing_move(&packing, 0.4, -0.3, 0.4, 0.5 * degree, 31);
    struct photo photo = packing_photo(&packing, 0.01, 2);
    assert_true(track(&packing, &reference, &photo, &options) <= COUNT / 3);
    free(reference.pixels);
    free(photo.pixels);
    packing_free(&packing);
}

/* Subsets larger than the grains: what they hold of their neighbours is left out, and said. */
static void test_neighbours_in_the_subset(void **state)
{
    (void)state;
    struct packing packing;
    struct tracker_options options = TRACKER_DEFAULT;
    struct tracks tracks = {0};
    options.subset = 1.3;
    packing_make(&packing, 34);
    struct photo_grains grains = packing_grains(&packing);
    struct photo reference = packing_photo(&packing, 0.01, 1);
    packing_move(&packing, 0.2, 0.4, 0.9, 2 * degree, 35);
    struct photo photo = packing_photo(&packing, 0.01, 2);
    check_done(track_grains(&reference, &grains, &photo, NULL, &options, &tracks));
    for (int k = 0; k < COUNT; k++)
        assert_true(tracks.grains.flags[k] & GRAIN_MASKED);
    assert_int_equal(right_or_flagged(&tracks.grains, &packing), 0);
    tracks_free(&tracks);
    table_free(&PHOTO_GRAINS, &grains);
    free(reference.pixels);
    free(photo.pixels);
    packing_free(&packing);
}

/* Any photo alone is the same as in its series, in any order: to 1e-3 px, with the same distrust. */
static void test_alone_or_in_series(void **state)
{
    (void)state;
    enum { PHOTOS = 4 };
    const int order[PHOTOS] = {2, 0, 3, 1};
    struct packing packing;
    struct tracker_options options = TRACKER_DEFAULT;
    struct photo photos[PHOTOS];
    struct tracks alone[PHOTOS] = {0}, previous = {0};
    packing_make(&packing, 32);
    struct photo_grains grains = packing_grains(&packing);
    struct photo reference = packing_photo(&packing, 0.01, 1);
    for (int p = 0; p < PHOTOS; p++) {
        packing_move(&packing, 3.0 * p, -2.0 * p, 0.6, (0.5 + p) * degree, 33);
        photos[p] = packing_photo(&packing, 0.01, 2 + (uint64_t)p);
        check_done(track_grains(&reference, &grains, &photos[p], NULL, &options, &alone[p]));
        assert_int_equal(right_or_flagged(&alone[p].grains, &packing), 0);
    }
    options.keep = 1;
    struct tracker *tracker = tracker_open(&reference, &grains, &options);
    for (int step = 0; step < 2 * PHOTOS; step++) { /* first in order, then out of order */
        int p = step < PHOTOS ? step : order[step - PHOTOS];
        struct tracks tracks = {0};
        check_done(tracker_follow(tracker, &photos[p], step ? &previous.grains : NULL, &tracks));
        for (int k = 0; k < COUNT; k++) {
            check_near(tracks.grains.x_px[k], alone[p].grains.x_px[k], 1e-3);
            check_near(tracks.grains.y_px[k], alone[p].grains.y_px[k], 1e-3);
            check_near(tracks.grains.angle[k], alone[p].grains.angle[k], 1e-3 / radius);
            assert_int_equal(tracks.grains.flags[k] & GRAIN_DISTRUST, alone[p].grains.flags[k] & GRAIN_DISTRUST);
        }
        tracks_free(&previous);
        previous = tracks;
    }
    tracker_close(tracker);
    tracks_free(&previous);
    for (int p = 0; p < PHOTOS; p++) {
        tracks_free(&alone[p]);
        free(photos[p].pixels);
    }
    free(reference.pixels);
    table_free(&PHOTO_GRAINS, &grains);
    packing_free(&packing);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_quarter_and_half_turns),
        cmocka_unit_test(test_light_and_contrast),
        cmocka_unit_test(test_repeated_faces),
        cmocka_unit_test(test_under_the_frame),
        cmocka_unit_test(test_saturated_specks),
        cmocka_unit_test(test_tiny_subsets),
        cmocka_unit_test(test_few_specks),
        cmocka_unit_test(test_neighbours_in_the_subset),
        cmocka_unit_test(test_alone_or_in_series),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
