/* What a photo tells without a scene: the radius range, the frame that the grains lean against; a hole stays a hole;
 * the flank of a rod and the end of the grey range are said. */
#include "tests/check.h"
#include "tests/discs.h"
#include "findgrains/find_grains.h"
#include "pipeline/numbers/random.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { ROOM = 400 };

static const struct scenery usual = {1500, 1.05, 400, 0.1, 800, 5};

static long row_of(const struct photo_grains *grains, const struct disc *disc)
{
    for (size_t k = 0; k < grains->count; k++)
        if (hypot(grains->x_px[k] - disc->x, grains->y_px[k] - disc->y) < 0.2 * disc->radius &&
            fabs(grains->radius_px[k] - disc->radius) < 0.1 * disc->radius)
            return (long)k;
    return -1;
}

static size_t count_matched(const struct photo_grains *grains, const struct disc *discs, size_t count)
{
    size_t matched = 0;
    for (size_t k = 0; k < count; k++)
        matched += row_of(grains, &discs[k]) >= 0;
    return matched;
}

static void find(int width, int height, const struct disc *discs, size_t count, const struct scenery *scenery,
                 struct photo_grains *grains, struct find_notes *notes)
{
    struct find_options options = FIND_OPTIONS_DEFAULT;
    struct photo photo;
    check_done(discs_draw(width, height, discs, count, scenery, &photo));
    check_done(find_grains(&photo, &options, grains, notes));
    photo_free(&photo);
}

static size_t pack(int width, int height, const double radii[4], struct disc *discs)
{
    size_t count = discs_pack(width, height, radii, 4, 5, 17, discs, ROOM);
    for (size_t k = 0; k < count; k++)
        discs[k].grey = 22000 + 12000 * random_uniform(3, k);
    return count;
}

/* Radii from 8 to 40 px and nothing said about them. */
static void radius_range_is_found(void **state)
{
    static const double radii[] = {8, 13, 22, 40};
    struct disc discs[ROOM] = {{0}};
    struct photo_grains grains = {0};
    struct find_notes notes;
    (void)state;
    size_t count = pack(420, 380, radii, discs);
    struct scenery scenery = usual;
    scenery.dots = 0;
    find(420, 380, discs, count, &scenery, &grains, &notes);
    printf("  %zu of %zu found, %zu in all, radii %.1f to %.1f px searched\n", count_matched(&grains, discs, count),
           count, grains.count, notes.radius_min_px, notes.radius_max_px);
    assert_int_equal(count_matched(&grains, discs, count), count);
    assert_int_equal(grains.count, count);
    assert_true(notes.radius_min_px <= 8 && notes.radius_max_px >= 40);
    assert_false(notes.frame.found);
    table_free(&PHOTO_GRAINS, &grains);
}

static void missing_grain_stays_missing(void **state)
{
    static const double radii[] = {18, 22, 27, 33};
    struct disc discs[ROOM] = {{0}};
    struct photo_grains grains = {0};
    (void)state;
    size_t count = pack(400, 360, radii, discs);
    struct disc gone = discs[0]; /* in the middle */
    find(400, 360, discs + 1, count - 1, &usual, &grains, NULL);
    assert_int_equal(count_matched(&grains, discs + 1, count - 1), count - 1);
    assert_int_equal(grains.count, count - 1);
    assert_int_equal(row_of(&grains, &gone), -1);
    table_free(&PHOTO_GRAINS, &grains);
}

/* Rods of three sizes in a row along a side, touching it, `clear` away from its ends. */
static size_t lean(struct vec from, struct vec to, double clear, struct disc *discs, size_t count)
{
    static const double radii[] = {13, 9, 17};
    struct vec along = vec_unit(vec_sub(to, from)), inward = vec_turn(along);
    double length = vec_norm(vec_sub(to, from)), at = clear;
    for (int k = 0;; k++) {
        double r = radii[k % 3];
        at += r;
        if (at > length - clear - r)
            return count;
        struct vec centre = vec_add(from, vec_add(vec_scale(at, along), vec_scale(r, inward)));
        discs[count++] = (struct disc){.x = centre.x, .y = centre.y, .radius = r, .grey = 24000 + 4000 * (k % 3)};
        at += r + 3;
    }
}

/* A tilted frame, known by the rods that lean against it, and a label outside. */
static void frame_is_found(void **state)
{
    static const struct vec corners[4] = {{40.3, 45.7}, {560.8, 54.1}, {556.2, 438.4}, {36.9, 432.2}};
    struct disc discs[ROOM] = {{0}}, label = {.x = 300, .y = 20, .radius = 12, .grey = 40000};
    struct photo_grains grains = {0};
    struct find_notes notes;
    size_t count = 0;
    (void)state;
    for (int k = 0; k < 4; k++)
        count = lean(corners[k], corners[(k + 1) % 4], 45, discs, count);
    for (int k = 0; k < 24; k++)
        discs[count++] = (struct disc){
            .x = 110 + 75 * (k % 6), .y = 120 + 78 * (k / 6) + 5 * (k % 3), .radius = 20 + k % 12, .grey = 30000};
    discs[count++] = label;
    find(600, 480, discs, count, &usual, &grains, &notes);
    assert_int_equal(count_matched(&grains, discs, count), count);
    assert_true(notes.frame.found);
    for (int k = 0; k < 4; k++) {
        double x = notes.frame.corners[k].x - corners[k].x, y = notes.frame.corners[k].y - corners[k].y;
        printf("  corner %d: %+.3f %+.3f px, standard errors %.3f %.3f, %d rods lean on the side\n", k, x, y,
               notes.frame.s_corners[k][0], notes.frame.s_corners[k][1], notes.frame.touching[k]);
        check_near(x, 0, 4 * notes.frame.s_corners[k][0]);
        check_near(y, 0, 4 * notes.frame.s_corners[k][1]);
        check_at_most(notes.frame.s_corners[k][0], 0.1);
        check_at_most(notes.frame.s_corners[k][1], 0.1);
    }
    for (size_t k = 0; k < count; k++) {
        uint32_t flags = grains.flags[row_of(&grains, &discs[k])];
        assert_int_equal(flags & GRAIN_CUT, k == count - 1 ? GRAIN_CUT : 0);
    }
    table_free(&PHOTO_GRAINS, &grains);
}

/* Every second rod shows its flank towards the right: a darker disc behind the face. */
static void flank_is_seen(void **state)
{
    struct disc discs[ROOM] = {{0}}, faces[12];
    struct photo_grains grains = {0};
    size_t count = 0;
    (void)state;
    for (int k = 0; k < 12; k++) {
        faces[k] = (struct disc){.x = 70 + 100.3 * (k % 4), .y = 60 + 100.2 * (k / 4), .radius = 30 + k, .grey = 30000};
        struct disc flank = {.x = faces[k].x + 7, .y = faces[k].y + 2, .radius = faces[k].radius, .grey = 13000};
        if (k % 2)
            discs[count++] = flank;
        discs[count++] = faces[k];
    }
    struct scenery scenery = usual;
    scenery.dots = 0;
    find(460, 330, discs, count, &scenery, &grains, NULL);
    assert_int_equal(grains.count, 12);
    double worst = 0;
    for (int k = 0; k < 12; k++) {
        long row = row_of(&grains, &faces[k]);
        assert_true(row >= 0);
        assert_int_equal(grains.flags[row] & GRAIN_FLANK, k % 2 ? GRAIN_FLANK : 0);
        worst = fmax(worst, hypot(grains.x_px[row] - faces[k].x, grains.y_px[row] - faces[k].y));
    }
    printf("  farthest centre with or without flank: %.3f px\n", worst);
    check_at_most(worst, 0.1);
    table_free(&PHOTO_GRAINS, &grains);
}

static void saturation_is_said(void **state)
{
    static const double radii[] = {18, 22, 27, 33};
    struct disc discs[ROOM] = {{0}};
    struct photo_grains grains = {0};
    (void)state;
    size_t count = pack(400, 360, radii, discs);
    for (size_t k = 0; k < count; k++)
        discs[k].grey = k % 2 ? 70000 : 50000;
    find(400, 360, discs, count, &usual, &grains, NULL);
    for (size_t k = 0; k < count; k++) {
        long row = row_of(&grains, &discs[k]);
        assert_true(row >= 0);
        assert_int_equal(grains.flags[row] & GRAIN_SATURATED, k % 2 ? GRAIN_SATURATED : 0);
    }
    table_free(&PHOTO_GRAINS, &grains);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(radius_range_is_found), cmocka_unit_test(missing_grain_stays_missing),
        cmocka_unit_test(frame_is_found),        cmocka_unit_test(flank_is_seen),
        cmocka_unit_test(saturation_is_said),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
