/* Walls of contacts: from the frame, from the grains that lie on them, from markers. */
#include <math.h>
#include <stdlib.h>
#include <stdio.h>

#include "contacts/walls/frame.h"
#include "tests/check.h"

#define PX 1e-4 /* m */

/* Grains of radius 20 px along the bottom of a frame of 1000 x 800 px (origin at the bottom left, y up): overlaps,
 * half-normal of scale `load` px, with a wall that lies `offset` px outside the frame line and is tilted; one grain in
 * five is up to 5 px off. */
static struct grains row_on_wall(size_t count, double load, double offset, double tilt, double noise, uint64_t *seed)
{
    static const char *const columns[] = {"x", "y", "radius", "angle", "s_radius", "flags", NULL};
    struct grains g;
    check_done(table_alloc(&GRAINS, &g, count, columns));
    for (size_t k = 0; k < count; k++) {
        double x = 1000 * ((double)k + 0.5) / (double)count, overlap = fabs(load * check_normal(seed));
        if (k % 5 == 4)
            overlap = -5 * check_uniform(seed);
        double wall = -offset - tilt * (x - 500);
        g.x[k] = x * PX;
        g.y[k] = (wall + 20 - overlap) * PX;
        g.radius[k] = (20 + noise * check_normal(seed)) * PX;
        g.s_radius[k] = noise * PX;
        g.angle[k] = 0;
    }
    return g;
}

static struct wall_line bottom_line(double s_offset_px)
{
    return (struct wall_line){.middle = vec(500 * PX, 0),
                              .along = vec(1, 0),
                              .half_length = 500 * PX,
                              .s_offset = s_offset_px * PX,
                              .s_angle = M_SQRT2 * s_offset_px / 1000};
}

static const struct pair_statistics usual = {
    .touching = 0.9, .resting = 1e-6, .apart = 0.1, .scale = 0.1 * PX, .flat = 0.96, .wide = 0.02, .window = 0.5 * PX};

static const struct rim_statistics usual_rims = {.bearing = &usual};

/* Found offset (px) and tilt against the truth, rms over many draws: as they are, and in units of their stated errors.
 */
struct line_scores {
    double offset, tilt, offset_stated, tilt_stated;
};

static struct line_scores score_lines(size_t grains, double load)
{
    enum { DRAWS = 60 };
    uint64_t seed = 3;
    struct line_scores sum = {0};
    for (int draw = 0; draw < DRAWS; draw++) {
        double offset = check_normal(&seed), tilt = 1e-3 * check_normal(&seed);
        struct grains g = row_on_wall(grains, load, offset, tilt, 0.02, &seed);
        struct wall_line line = bottom_line(1);
        check_done(support_fit(&g, NULL, &usual_rims, &line));
        double wrong = -line.middle.y / PX - offset, turned = -atan2(line.along.y, line.along.x) - tilt;
        sum.offset += wrong * wrong / DRAWS;
        sum.tilt += turned * turned / DRAWS;
        sum.offset_stated += pow(wrong / (line.s_offset / PX), 2) / DRAWS;
        sum.tilt_stated += pow(turned / line.s_angle, 2) / DRAWS;
        table_free(&GRAINS, &g);
    }
    return (struct line_scores){sqrt(sum.offset), sqrt(sum.tilt), sqrt(sum.offset_stated), sqrt(sum.tilt_stated)};
}

static void test_line_from_grains(void **state)
{
    (void)state;
    struct line_scores scores = score_lines(50, 0.1);
    check_at_most(scores.offset, 0.015); /* px: m / n = 0.08 / 40, noise 0.02 / sqrt(40), and gaps near zero */
    check_at_most(scores.tilt, 5e-5);
    check_near(scores.offset_stated, 1, 0.3);
    check_near(scores.tilt_stated, 1, 0.3);
}

/* Walls that bear more or less than the rest of the packing: overlaps of another scale than the photo's. */
static void test_line_under_another_load(void **state)
{
    (void)state;
    static const double loads[] = {0.05, 0.2};
    for (int k = 0; k < 2; k++) {
        struct line_scores scores = score_lines(30, loads[k]);
        /* 24 of 30 touch, 0.8 of them per scale and px near zero: one in load / 0.8 / 24 px; noise 0.02 / sqrt(24) */
        check_at_most(scores.offset, hypot(2 * loads[k] / 0.8 / 24, 2 * 0.02 / sqrt(24)));
        check_near(scores.offset_stated, 1, 0.3);
        check_near(scores.tilt_stated, 1, 0.3);
    }
}

static void test_line_without_grains_keeps_the_prior(void **state)
{
    (void)state;
    struct grains none = {0};
    struct wall_line line = bottom_line(1);
    check_done(support_fit(&none, NULL, &usual_rims, &line));
    check_near(line.middle.y, 0, 1e-12);
    check_near(line.s_offset, 1 * PX, 0.02 * PX);
    check_near(line.s_angle, M_SQRT2 / 1000, 3e-5);
}

static void test_exact_line_is_left_alone(void **state)
{
    (void)state;
    uint64_t seed = 5;
    struct grains g = row_on_wall(20, 0.1, 0.5, 0, 0.02, &seed);
    struct wall_line line = bottom_line(0);
    check_done(support_fit(&g, NULL, &usual_rims, &line));
    check_near(line.middle.y, 0, 0);
    check_near(line.s_offset, 0, 0);
    table_free(&GRAINS, &g);
}

/* The wall and what lies on it move 12 px up and turn by 10 degrees: the grains carry the line along. */
static void test_line_follows_the_grains(void **state)
{
    (void)state;
    uint64_t seed = 7;
    const double turn = 10 * 3.14159265358979323846 / 180;
    struct grains g = row_on_wall(50, 0.1, 0, 0, 0.02, &seed);
    struct vec *before = calloc(g.count, sizeof *before);
    assert_non_null(before);
    struct vec middle = vec(500 * PX, 0), moved = vec(500 * PX, 12 * PX);
    for (size_t k = 0; k < g.count; k++) {
        before[k] = vec(g.x[k], g.y[k]);
        struct vec now = vec_add(moved, vec_rotate(vec_sub(before[k], middle), turn));
        g.x[k] = now.x;
        g.y[k] = now.y;
    }
    struct wall_line line = bottom_line(1);
    check_done(support_fit(&g, before, &usual_rims, &line));
    check_near(line.middle.y, 0, 0.03 * PX);
    check_done(support_follow(&g, before, &usual_rims, &line));
    check_done(support_fit(&g, NULL, &usual_rims, &line));
    check_near(atan2(line.along.y, line.along.x), turn, 1e-4);
    check_near(vec_dot(vec_sub(line.middle, moved), wall_line_inward(&line)), 0, 0.03 * PX);
    free(before);
    table_free(&GRAINS, &g);
}

static struct scene frame_scene(void)
{
    struct scene scene = {.scale = PX, .origin_px = vec(0, 800), .name = "frame"};
    scene.frame.given = 1;
    scene.frame.corners_px[CORNER_TOP_LEFT] = vec(0, 0);
    scene.frame.corners_px[CORNER_TOP_RIGHT] = vec(1000, 0);
    scene.frame.corners_px[CORNER_BOTTOM_RIGHT] = vec(1000, 800);
    scene.frame.corners_px[CORNER_BOTTOM_LEFT] = vec(0, 800);
    return scene;
}

/* Corners by hand, each wrong by `error` across the wall: the ends of a wall of length L turn it by sqrt 2 error / L.
 */
static void test_errors_of_the_frame(void **state)
{
    (void)state;
    struct scene scene = frame_scene();
    struct grains none = {0};
    struct frame_request request = {
        .scene = &scene, .grains = &none, .statistics = {.bearing = &usual}, .frame_error_px = 0.5};
    struct frame frame;
    check_done(frame_walls(&request, &frame));
    const double length[] = {1000, 800, 1000, 800};
    for (int w = 0; w < 4; w++) {
        check_near(frame.now.s_offset[w], 0.5 * PX, 1e-4 * PX);
        check_near(frame.now.s_angle[w], M_SQRT2 * 0.5 / length[w], 1e-4 / length[w]);
    }
    frame_free(&frame);
}

/* Markers say that the top comes down by 8 px and the side walls lean by 10 degrees (simple shear). */
static void test_walls_follow_markers(void **state)
{
    (void)state;
    const double lean = 10 * 3.14159265358979323846 / 180; /* clockwise: the top goes right */
    struct scene scene = frame_scene();
    struct grains none = {0};
    struct vec no_reference[1];
    struct patches patches;
    check_done(table_alloc(&PATCHES, &patches, 3, NULL));
    const char *const walls[] = {"top", "left", "right"};
    const double x[] = {500, -50, 1050}, up[] = {850, 400, 400}; /* markers stand outside, in the reference */
    const double foot_x[] = {0, 0, 1000};
    for (size_t k = 0; k < 3; k++) {
        struct vec was = vec(x[k], up[k]), now = vec(x[k] + 20, up[k] - 8);
        if (k > 0) /* turns about the foot of its wall */
            now = vec_add(vec(foot_x[k], 0), vec_rotate(vec_sub(was, vec(foot_x[k], 0)), -lean));
        snprintf(patches.kind[k], NAME_LENGTH, "wall");
        snprintf(patches.name[k], NAME_LENGTH, "%s", walls[k]);
        patches.x_px[k] = now.x;
        patches.y_px[k] = 800 - now.y;
        patches.dx_px[k] = now.x - was.x;
        patches.dy_px[k] = -(now.y - was.y);
        patches.angle[k] = k > 0 ? -lean : 0;
        patches.s_x[k] = patches.s_y[k] = 0.01;
        patches.s_angle[k] = 1e-5;
    }
    struct frame_request request = {.scene = &scene,
                                    .grains = &none,
                                    .reference = no_reference,
                                    .patches = &patches,
                                    .statistics = {.bearing = &usual},
                                    .frame_error_px = 0};
    struct frame frame;
    check_done(frame_walls(&request, &frame));
    /* bottom, right, top, left; each from its first corner, counter-clockwise */
    const double expected_x[] = {0, 1000, 1000 + 792 * tan(lean), 792 * tan(lean)};
    const double expected_y[] = {0, 0, 792, 792};
    for (size_t w = 0; w < 4; w++) {
        check_near(frame.now.x0[w], expected_x[w] * PX, 1e-12);
        check_near(frame.now.y0[w], expected_y[w] * PX, 1e-12);
    }
    double strain[3];
    frame_strain(&frame.now, &frame.reference, strain);
    check_near(strain[0], 0, 1e-12);
    check_near(strain[1], 0.01, 1e-12); /* 8 px of 800: shortening is positive */
    check_near(strain[2], 792 * tan(lean) / 800, 1e-12);
    frame_motion(&frame.now, &frame.reference);
    check_near(frame.now.dangle[1], -lean, 1e-12);
    check_near(frame.now.dy[2], -8 * PX, 1e-12);
    check_near(frame.s_motion[2], 0.01 * PX, 1e-12);
    frame_free(&frame);
    table_free(&PATCHES, &patches);
}

static void test_no_frame_no_walls(void **state)
{
    (void)state;
    struct scene scene = frame_scene();
    scene.frame.given = 0;
    struct grains none = {0};
    struct frame_request request = {.scene = &scene, .grains = &none, .statistics = {.bearing = &usual}};
    struct frame frame;
    check_done(frame_walls(&request, &frame));
    assert_int_equal(frame.now.count, 0);
    frame_free(&frame);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_line_from_grains),
        cmocka_unit_test(test_line_under_another_load),
        cmocka_unit_test(test_line_without_grains_keeps_the_prior),
        cmocka_unit_test(test_exact_line_is_left_alone),
        cmocka_unit_test(test_line_follows_the_grains),
        cmocka_unit_test(test_errors_of_the_frame),
        cmocka_unit_test(test_walls_follow_markers),
        cmocka_unit_test(test_no_frame_no_walls),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
