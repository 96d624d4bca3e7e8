/* Hard photos, each with its figure: everything found, nothing else, errors below what the case allows. Limits are
 * about 1.5 times what was measured on other seeds. */
#include "tests/check.h"
#include "tests/discs.h"
#include "findgrains/find_grains.h"
#include "pipeline/speak/error.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { ROOM = 120, WIDTH = 430, HEIGHT = 380 };

struct hard {
    double low, high;    /* radii, px */
    double dark, bright; /* greys of the rods */
    struct scenery scenery;
};

static const struct hard usual = {
    .low = 24, .high = 42, .dark = 20000, .bright = 34000, .scenery = {1500, 1.05, 400, 0.15, 800, 21}};

struct outcome {
    size_t count, matched, extra;
    double centre, radius, bias;
};

static size_t pack(const struct hard *hard, struct disc *discs)
{
    double step = (hard->high - hard->low) / 3;
    double radii[] = {hard->low, hard->low + step, hard->low + 2 * step, hard->high};
    size_t count = discs_pack(WIDTH, HEIGHT, radii, 4, 5, hard->scenery.seed, discs, ROOM);
    uint64_t seed = hard->scenery.seed + 1;
    for (size_t k = 0; k < count; k++)
        discs[k].grey = hard->dark + (hard->bright - hard->dark) * check_uniform(&seed);
    return count;
}

static struct outcome compare(const struct photo_grains *grains, const struct disc *discs, size_t count)
{
    struct outcome outcome = {.count = count};
    for (size_t k = 0; k < count; k++)
        for (size_t j = 0; j < grains->count; j++) {
            double x = grains->x_px[j] - discs[k].x, y = grains->y_px[j] - discs[k].y;
            double r = grains->radius_px[j] - discs[k].radius;
            if (hypot(x, y) > 0.2 * discs[k].radius || fabs(r) > 0.1 * discs[k].radius)
                continue;
            outcome.matched++;
            outcome.centre += 0.5 * (x * x + y * y);
            outcome.radius += r * r;
            outcome.bias += r;
        }
    outcome.extra = grains->count - outcome.matched;
    outcome.centre = sqrt(outcome.centre / (double)outcome.matched);
    outcome.radius = sqrt(outcome.radius / (double)outcome.matched);
    outcome.bias /= (double)outcome.matched;
    printf("  %zu of %zu, %zu extra; centre %.4f radius %.4f bias %+.4f px\n", outcome.matched, count, outcome.extra,
           outcome.centre, outcome.radius, outcome.bias);
    return outcome;
}

static struct outcome find(const struct hard *hard, const struct photo *photo, const struct disc *discs, size_t count)
{
    struct find_options options = FIND_OPTIONS_DEFAULT;
    struct photo_grains grains = {0};
    options.radius_min_px = 0.95 * hard->low;
    options.radius_max_px = 1.05 * hard->high;
    check_done(find_grains(photo, &options, &grains, NULL));
    struct outcome outcome = compare(&grains, discs, count);
    table_free(&PHOTO_GRAINS, &grains);
    return outcome;
}

static void check_case(struct hard hard, double centre, double radius, double bias)
{
    struct disc discs[ROOM] = {{0}};
    struct photo photo;
    size_t count = pack(&hard, discs);
    check_done(discs_draw(WIDTH, HEIGHT, discs, count, &hard.scenery, &photo));
    struct outcome outcome = find(&hard, &photo, discs, count);
    assert_int_equal(outcome.matched, count);
    assert_int_equal(outcome.extra, 0);
    check_at_most(outcome.centre, centre);
    check_at_most(outcome.radius, radius);
    check_near(outcome.bias, 0, bias);
    photo_free(&photo);
}

static void many_specks(void **state)
{
    struct hard hard = usual;
    (void)state;
    hard.scenery.dots = 0.3;
    check_case(hard, 0.08, 0.06, 0.04);
}

static void strong_noise(void **state)
{
    struct hard hard = usual;
    (void)state;
    hard.scenery.noise = 900;
    check_case(hard, 0.07, 0.05, 0.03);
}

static void low_contrast(void **state)
{
    struct hard hard = usual;
    (void)state;
    hard.scenery.void_grey = 20000;
    hard.dark = 26000;
    hard.bright = 30000; /* 12 % of the range above the voids at most */
    hard.scenery.dots = 0;
    check_case(hard, 0.06, 0.05, 0.02);
}

static void sharp_and_soft(void **state)
{
    struct hard hard = usual;
    (void)state;
    hard.scenery.blur = 0.7;
    check_case(hard, 0.05, 0.04, 0.02);
    hard.scenery.blur = 1.5;
    check_case(hard, 0.09, 0.07, 0.04);
}

static void small_grains(void **state)
{
    struct hard hard = usual;
    (void)state;
    hard.low = 10;
    hard.high = 26;
    hard.scenery.dots = 0.05;
    check_case(hard, 0.09, 0.07, 0.04);
}

/* Specks as large as a tenth of the rods: the votes of some rims lie on a ridge that leads to smaller circles. */
static void small_and_specked(void **state)
{
    struct hard hard = usual;
    (void)state;
    hard.low = 14;
    hard.high = 35;
    hard.scenery.dots = 0.2;
    for (hard.scenery.seed = 31; hard.scenery.seed < 34; hard.scenery.seed++)
        check_case(hard, 0.09, 0.07, 0.04);
}

/* Rods of one grey: where they touch there is no edge at all. */
static void equal_greys(void **state)
{
    struct hard hard = usual;
    (void)state;
    hard.dark = hard.bright = 28000;
    hard.scenery.dots = hard.scenery.rings = 0;
    check_case(hard, 0.02, 0.02, 0.008);
}

/* The brightest rods reach the end of the range: their rims seem to lie further out. */
static void saturation(void **state)
{
    struct hard hard = usual;
    (void)state;
    hard.dark = 50000;
    hard.bright = 75000;
    check_case(hard, 0.07, 0.07, 0.05);
}

/* A corner darkens to a third: done on the drawn photo. */
static void vignetting(void **state)
{
    struct hard hard = usual;
    struct disc discs[ROOM] = {{0}};
    struct photo photo;
    (void)state;
    size_t count = pack(&hard, discs);
    check_done(discs_draw(WIDTH, HEIGHT, discs, count, &hard.scenery, &photo));
    for (int y = 0; y < HEIGHT; y++)
        for (int x = 0; x < WIDTH; x++) {
            uint16_t *pixel = &photo.pixels[(size_t)y * WIDTH + (size_t)x];
            *pixel = (uint16_t)(*pixel * (1 - 0.66 * hypot(x, y) / hypot(WIDTH, HEIGHT)));
        }
    struct outcome outcome = find(&hard, &photo, discs, count);
    assert_int_equal(outcome.matched, count);
    assert_int_equal(outcome.extra, 0);
    check_at_most(outcome.centre, 0.06);
    check_at_most(outcome.radius, 0.05);
    photo_free(&photo);
}

/* 8 bits: as good as its steps allow. */
static void eight_bits(void **state)
{
    struct hard hard = usual;
    struct disc discs[ROOM] = {{0}};
    struct photo photo;
    (void)state;
    size_t count = pack(&hard, discs);
    check_done(discs_draw(WIDTH, HEIGHT, discs, count, &hard.scenery, &photo));
    struct outcome sixteen = find(&hard, &photo, discs, count);
    for (size_t k = 0; k < (size_t)WIDTH * HEIGHT; k++)
        photo.pixels[k] = (uint16_t)(photo.pixels[k] / 257);
    photo.bits = 8;
    struct outcome outcome = find(&hard, &photo, discs, count);
    assert_int_equal(outcome.matched, count);
    assert_int_equal(outcome.extra, 0);
    check_at_most(outcome.centre, 0.06);
    check_at_most(outcome.centre, 1.5 * sixteen.centre);
    photo_free(&photo);
}

/* Two rods of almost equal grey whose faces meet along a long arc: the second one's face covers a cap of the first one,
 * whose rim is not there. Their other rims must not give way. */
static void long_arc(void **state)
{
    static const double depths[] = {1, 3, 6}, specks[] = {0, 0.2};
    enum { REPEATS = 6 };
    (void)state;
    for (int s = 0; s < 2; s++)
        for (int d = 0; d < 3; d++) {
            struct hard hard = usual;
            struct disc discs[2 * REPEATS] = {{0}};
            struct photo photo;
            for (int k = 0; k < REPEATS; k++) {
                double angle = 0.3 + 2 * M_PI * k / REPEATS, x = 125 + 240 * (k % 3), y = 120 + 240.0 * (k / 3);
                discs[2 * k] = (struct disc){x + 0.13 * k, y, 40, 0, 0, 30000};
                double apart = 40 + 36 - depths[d];
                discs[2 * k + 1] =
                    (struct disc){x + 0.13 * k + apart * cos(angle), y + apart * sin(angle), 36, 0, 0, 30600};
            }
            hard.low = 36;
            hard.high = 40;
            hard.scenery.dots = specks[s];
            hard.scenery.rings = 0;
            check_done(discs_draw(730, 490, discs, 2 * REPEATS, &hard.scenery, &photo));
            printf("  caps %.0f px deep on a chord of %.0f px, %.0f %% specks:\n", depths[d],
                   2 * sqrt(2 * 40 * 36 / (40.0 + 36) * depths[d]), 100 * specks[s]);
            struct outcome outcome = find(&hard, &photo, discs, 2 * REPEATS);
            assert_int_equal(outcome.matched, 2 * REPEATS);
            assert_int_equal(outcome.extra, 0);
            check_at_most(outcome.centre, specks[s] > 0 ? 0.05 : 0.008);
            check_at_most(outcome.radius, specks[s] > 0 ? 0.045 : 0.007);
            photo_free(&photo);
        }
}

/* A dark bevel at the rim is a constant radius bias: the shift must show up alike on all grains. */
static void bevel_is_a_constant_bias(void **state)
{
    struct hard hard = usual;
    struct disc discs[2 * ROOM] = {{0}};
    struct photo photo;
    (void)state;
    hard.scenery.dots = hard.scenery.rings = 0;
    size_t count = pack(&hard, discs);
    /* the face proper, 1.5 px smaller, over a dark disc */
    for (size_t k = 0; k < count; k++) {
        discs[count + k] = discs[k];
        discs[count + k].radius -= 1.5;
        discs[k].grey = 0.3 * discs[k].grey;
    }
    check_done(discs_draw(WIDTH, HEIGHT, discs, 2 * count, &hard.scenery, &photo));
    struct outcome outcome = find(&hard, &photo, discs, count);
    assert_int_equal(outcome.matched, count);
    assert_true(outcome.bias < -0.3 && outcome.bias > -1.5);
    check_at_most(sqrt(outcome.radius * outcome.radius - outcome.bias * outcome.bias), 0.1);
    check_at_most(outcome.centre, 0.05);
    photo_free(&photo);
}

/* Circles that no photo holds: refused, and not measured. */
static void refuses_absurd_circles(const struct photo *photo)
{
    const struct correction absurd[] = {{.x = 1e308, .y = 100, .radius = 5},
                                        {.x = 100, .y = 100, .radius = 1e308},
                                        {.x = 100, .y = 100, .radius = 1e9},
                                        {.x = 100, .y = 100, .radius = 2000}};
    for (size_t k = 0; k < sizeof absurd / sizeof *absurd; k++) {
        struct correction item = absurd[k];
        struct corrections corrections = {&item, 1, 1};
        struct find_options options = FIND_OPTIONS_DEFAULT;
        struct photo_grains grains = {0};
        options.corrections = &corrections;
        assert_int_equal(find_grains(photo, &options, &grains, NULL), -1);
        assert_int_equal(error_status(), EXIT_INPUT);
    }
}

/* A grain taken away by hand and put back, and the same grains measured again on another photo of them. */
static void corrections_and_known_grains(void **state)
{
    struct hard hard = usual;
    struct disc discs[ROOM] = {{0}};
    struct photo photo, later;
    struct photo_grains fewer = {0}, all = {0}, again = {0};
    (void)state;
    size_t count = pack(&hard, discs);
    check_done(discs_draw(WIDTH, HEIGHT, discs, count, &hard.scenery, &photo));
    struct find_options options = FIND_OPTIONS_DEFAULT;
    options.radius_min_px = 0.95 * hard.low;
    options.radius_max_px = 1.05 * hard.high;
    struct correction items[2] = {{.x = discs[3].x + 5, .y = discs[3].y - 4},
                                  {.x = discs[3].x + 0.8, .y = discs[3].y, .radius = discs[3].radius + 0.7}};
    struct corrections corrections = {items, 1, 2};
    options.corrections = &corrections;
    check_done(find_grains(&photo, &options, &fewer, NULL));
    assert_int_equal(fewer.count, count - 1);
    corrections.count = 2;
    check_done(find_grains(&photo, &options, &all, NULL));
    assert_int_equal(all.count, count);
    size_t by_hand = 0;
    for (size_t k = 0; k < count; k++)
        if (all.flags[k] & GRAIN_BY_HAND) {
            by_hand++;
            check_near(all.x_px[k], discs[3].x, 0.15);
            check_near(all.radius_px[k], discs[3].radius, 0.15);
        }
    assert_int_equal(by_hand, 1);
    struct correction nowhere = {.x = 1, .y = 1};
    corrections = (struct corrections){&nowhere, 1, 1};
    assert_int_equal(find_grains(&photo, &options, &again, NULL), -1);
    assert_int_equal(error_status(), EXIT_INPUT);

    refuses_absurd_circles(&photo);

    options.corrections = NULL;
    for (size_t k = 0; k < count; k++)
        discs[k].x += 0.37;
    hard.scenery.seed += 100;
    check_done(discs_draw(WIDTH, HEIGHT, discs, count, &hard.scenery, &later));
    all.x_px[7] = NAN; /* lost in the later photo */
    const double absurd_px[] = {1e308, -1e308, 9e5, 1e9};
    for (size_t k = 0; k < 4; k++) {
        all.radius_px[8 + k] = fabs(absurd_px[k]);
        all.x_px[12 + k] = absurd_px[k];
    }
    /* Its walls have moved: a frame that cuts the grains on the left says nothing about this photo. */
    options.has_frame = 1;
    options.corners_px[0] = vec(150, 0);
    options.corners_px[1] = vec(WIDTH - 1, 0);
    options.corners_px[2] = vec(WIDTH - 1, HEIGHT - 1);
    options.corners_px[3] = vec(150, HEIGHT - 1);
    check_done(find_known_grains(&later, &options, &all, &again, NULL));
    assert_int_equal(again.count, count);
    for (size_t k = 0; k < count; k++)
        if (k < 7 || k > 15) {
            check_near(again.x_px[k], all.x_px[k] + 0.37, 0.3);
            check_near(again.y_px[k], all.y_px[k], 0.3);
            assert_false(again.flags[k] & GRAIN_CUT);
        }
    for (size_t k = 7; k <= 15; k++)
        assert_true(again.flags[k] & GRAIN_DISTRUST);
    table_free(&PHOTO_GRAINS, &fewer);
    table_free(&PHOTO_GRAINS, &all);
    table_free(&PHOTO_GRAINS, &again);
    photo_free(&photo);
    photo_free(&later);
}

/* Lists of a person who read other pixels than the photo's. A cut grain may have its centre a little outside. */
static void grains_outside_are_refused(void **state)
{
    static const char *const wrong[] = {"4000 4000", "-30 20", "20 -30", "895 20", "20 760"};
    static const char *const right[] = {"-0.5 -0.5", "849.5 713.5", "-15 20", "20 730"};
    char path[] = "/tmp/test_findgrains_hard.XXXXXX", line[160];
    (void)state;
    int file = mkstemp(path);
    assert_true(file >= 0);
    for (size_t k = 0; k < 9; k++) {
        struct corrections corrections = {0};
        const char *place = k < 5 ? wrong[k] : right[k - 5];
        int length = snprintf(line, sizeof line, "# x y radius\n%s 40\n", place);
        assert_int_equal(ftruncate(file, 0), 0);
        assert_int_equal(pwrite(file, line, (size_t)length, 0), length);
        check_done(corrections_read_added(path, &corrections));
        assert_int_equal(corrections_check(&corrections, 850, 714), k < 5 ? -1 : 0);
        if (k == 0) {
            snprintf(line, sizeof line, "%s:2: (4000, 4000) is outside the photo of 850 x 714 px: give px of the photo",
                     path);
            assert_string_equal(error_message(), line);
            assert_int_equal(error_status(), EXIT_INPUT);
        }
        corrections_free(&corrections);
    }
    check_done(corrections_check(NULL, 850, 714));
    close(file);
    remove(path);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(many_specks),
        cmocka_unit_test(strong_noise),
        cmocka_unit_test(low_contrast),
        cmocka_unit_test(sharp_and_soft),
        cmocka_unit_test(small_grains),
        cmocka_unit_test(small_and_specked),
        cmocka_unit_test(equal_greys),
        cmocka_unit_test(saturation),
        cmocka_unit_test(vignetting),
        cmocka_unit_test(eight_bits),
        cmocka_unit_test(long_arc),
        cmocka_unit_test(bevel_is_a_constant_bias),
        cmocka_unit_test(corrections_and_known_grains),
        cmocka_unit_test(grains_outside_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
