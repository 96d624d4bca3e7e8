/* What is said of a rim: rims_table() on made-up fits, rim_is_saturated() on drawn photos, the noise of a grey level.
 */
#include "tests/check.h"

#include <math.h>
#include <stdlib.h>

#include "findgrains/look/threshold.h"
#include "findgrains/rims/rim_looks.h"
#include "findgrains/rims/rims_table.h"
#include "pipeline/packing/grains.h"

enum { COUNT = 5, SIDE = 200 };

/* A rim in the middle of the photo that nothing is to be said of. */
static struct refined good_rim(void)
{
    return (struct refined){.rim = {100, 100, 40, 0, 0},
                            .s_x = 0.01,
                            .s_y = 0.02,
                            .s_radius = 0.03,
                            .s_shape = NAN,
                            .support = 0.95,
                            .scatter = 0.1,
                            .moved = 0.001,
                            .sectors = 80};
}

static struct photo_grains table_of(struct refined items[COUNT], double correlation)
{
    struct candidate origin[COUNT] = {{.support = 1}};
    struct rims rims = {items, origin, COUNT};
    struct rims_state rims_state = {.correlation = correlation};
    struct zone zone;
    struct photo_grains grains = {0};
    check_done(zone_make(SIDE, SIDE, NULL, 0, &zone));
    check_done(rims_table(&zone, &rims_state, &rims, 1, &grains));
    return grains;
}

/* The last step against the larger of 0.02 px and the standard error. */
static void test_what_still_moves_is_flagged(void **state)
{
    (void)state;
    struct refined items[COUNT];
    for (int k = 0; k < COUNT; k++)
        items[k] = good_rim();
    items[1].moved = 0.029; /* within s_radius = 0.03 */
    items[2].moved = 0.031;
    items[3].s_radius = 0.001, items[3].moved = 0.019;
    items[4].s_radius = 0.001, items[4].moved = 0.021;
    struct photo_grains grains = table_of(items, 1);
    for (int k = 0; k < COUNT; k++)
        assert_int_equal(grains.flags[k], k == 2 || k == 4 ? GRAIN_NOT_CONVERGED : 0);
    table_free(&PHOTO_GRAINS, &grains);
}

/* Sectors that scatter more than three times as much as is usual, or a support below the limit. */
static void test_ragged_rims_are_flagged(void **state)
{
    (void)state;
    struct refined items[COUNT];
    for (int k = 0; k < COUNT; k++)
        items[k] = good_rim();
    items[1].scatter = 0.29;
    items[2].scatter = 0.31;
    struct photo_grains grains = table_of(items, 1);
    for (int k = 0; k < COUNT; k++)
        assert_int_equal(grains.flags[k], k == 2 ? GRAIN_WEAK_EDGE : 0);
    table_free(&PHOTO_GRAINS, &grains);
}

/* Each error in its own column, times what the correlation of neighbouring sectors adds. */
static void test_errors_stand_in_their_columns(void **state)
{
    (void)state;
    struct refined items[COUNT];
    for (int k = 0; k < COUNT; k++)
        items[k] = good_rim();
    struct photo_grains grains = table_of(items, 1.5);
    check_near(grains.s_x[0], 0.015, 1e-15);
    check_near(grains.s_y[0], 0.030, 1e-15);
    check_near(grains.s_radius[0], 0.045, 1e-15);
    table_free(&PHOTO_GRAINS, &grains);
}

/* A disc of one grey level on black. */
static struct photo disc_photo(int bits, int grey)
{
    struct photo photo;
    check_done(photo_alloc(&photo, SIDE, SIDE));
    photo.bits = bits;
    for (int y = 0; y < SIDE; y++)
        for (int x = 0; x < SIDE; x++)
            photo.pixels[y * SIDE + x] = hypot(x - 100, y - 100) <= 40 ? (uint16_t)grey : 0;
    return photo;
}

/* A camera of n bits ends at 2^n - 1: that level is saturated, the one below it is not. */
static void test_the_end_of_the_grey_range(void **state)
{
    (void)state;
    const struct rim rim = {100, 100, 40, 0, 0};
    static const int bits[] = {8, 12, 14, 16};
    for (int k = 0; k < 4; k++)
        for (int below = 0; below < 2; below++) {
            struct photo photo = disc_photo(bits[k], (1 << bits[k]) - 1 - below);
            assert_int_equal(rim_is_saturated(&photo, &rim, 1), !below);
            photo_free(&photo);
        }
}

/* Grey noise from the second differences along rows, sqrt(6) times as large: what is stated is what was added. */
static void test_noise_of_the_void(void **state)
{
    (void)state;
    const double noise = 400;
    uint64_t seed = 3;
    struct photo photo = disc_photo(16, 30000);
    for (int k = 0; k < SIDE * SIDE; k++)
        photo.pixels[k] = (uint16_t)lrint(8000 + photo.pixels[k] + noise * check_normal(&seed));
    struct zone zone;
    struct grey_levels levels;
    check_done(zone_make(SIDE, SIDE, NULL, 0, &zone));
    check_done(threshold_find(&photo, &zone, &levels));
    check_near(levels.noise, noise, 0.05 * noise); /* the rims, a hundredth of the pixels, add to it */
    photo_free(&photo);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_what_still_moves_is_flagged),
        cmocka_unit_test(test_ragged_rims_are_flagged),
        cmocka_unit_test(test_errors_stand_in_their_columns),
        cmocka_unit_test(test_the_end_of_the_grey_range),
        cmocka_unit_test(test_noise_of_the_void),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
