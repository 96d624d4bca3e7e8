/* Overlaps of turned ellipses and stated errors of overlaps, motions and walls, from their definitions. */
#include "tests/check.h"

#include <math.h>

#include "contacts/motion/pair_motion.h"
#include "contacts/network/near_pairs.h"
#include "contacts/walls/frame.h"

#define PX 1e-4 /* m */

/* Two grains of different size and error, 60 and 80 px apart along x and y, on a wall that leans. */
static struct grains two_grains(void)
{
    static const char *const columns[] = {"x",        "y",       "radius",  "angle",   "s_x",   "s_y", "s_angle",
                                          "s_radius", "s_shape", "shape_c", "shape_s", "flags", NULL};
    struct grains g;
    check_done(table_alloc(&GRAINS, &g, 2, columns));
    for (int k = 0; k < 2; k++) {
        g.x[k] = k ? 60 * PX : 0, g.y[k] = k ? 80 * PX : 0, g.radius[k] = (k ? 60.5 : 40) * PX;
        g.s_x[k] = (k ? 0.01 : 0.03) * PX, g.s_y[k] = (k ? 0.05 : 0.02) * PX, g.s_angle[k] = 0;
        g.s_radius[k] = (k ? 0.04 : 0.02) * PX, g.s_shape[k] = 0;
        g.angle[k] = g.shape_c[k] = g.shape_s[k] = 0;
    }
    return g;
}

static double variance_towards(const struct grains *g, int k, double nx, double ny)
{
    return pow(g->s_radius[k], 2) + pow(nx * g->s_x[k], 2) + pow(ny * g->s_y[k], 2);
}

static void test_errors_of_both_grains(void **state)
{
    (void)state;
    struct grains g = two_grains();
    struct pair pair = pair_of_grains(&g, 0, 1);
    check_near(pair.overlap, 0.5 * PX, 1e-15);
    check_near(pair.s_overlap, sqrt(variance_towards(&g, 0, 0.6, 0.8) + variance_towards(&g, 1, 0.6, 0.8)), 1e-15);
    table_free(&GRAINS, &g);
}

/* r(phi) = R + c cos 2 (phi - angle) + s sin 2 (phi - angle): what turns with the grain. */
static void test_shapes_turn_with_the_grain(void **state)
{
    (void)state;
    struct grains g = two_grains();
    double c = 0.3 * PX, s = 0.2 * PX, angle = 0.4, phi = atan2(0.8, 0.6) - angle;
    g.shape_c[0] = c, g.shape_s[0] = s, g.angle[0] = angle;
    check_near(rim_radius(&g, 0, vec(0.6, 0.8)), 40 * PX + c * cos(2 * phi) + s * sin(2 * phi), 1e-15);
    g.angle[0] = 0;
    check_near(rim_radius(&g, 0, vec(0, 1)), 40 * PX - c, 1e-15);
    table_free(&GRAINS, &g);
}

static struct walls bottom_wall(double s_offset, double s_angle)
{
    static const char *const columns[] = {"name", "x0", "y0", "x1", "y1", "radius", "s_offset", "s_angle", NULL};
    struct walls walls;
    check_done(table_alloc(&WALLS, &walls, 1, columns));
    walls.x0[0] = -100 * PX, walls.x1[0] = 300 * PX; /* from left to right: the inside is above; the middle at 100 px */
    walls.y0[0] = walls.y1[0] = -39.5 * PX;
    walls.radius[0] = 0;
    walls.s_offset[0] = s_offset, walls.s_angle[0] = s_angle;
    return walls;
}

/* Grain 0 lies 100 px beside the middle of the wall: an error of its direction counts with that arm. */
static void test_errors_of_a_wall(void **state)
{
    (void)state;
    struct grains g = two_grains();
    struct walls walls = bottom_wall(0.06 * PX, 5e-4);
    struct pair pair = pair_with_wall(&g, 0, &walls, 0);
    check_near(pair.overlap, 0.5 * PX, 1e-15);
    check_near(pair.s_overlap, sqrt(variance_towards(&g, 0, 0, -1) + pow(0.06 * PX, 2) + pow(100 * PX * 5e-4, 2)),
               1e-15);
    table_free(&WALLS, &walls);
    table_free(&GRAINS, &g);
}

/* The motion of grain and wall since an exact state: errors of the grain along the normal and the wall's own. */
static void test_errors_of_a_motion(void **state)
{
    (void)state;
    struct grains g = two_grains();
    struct walls walls = bottom_wall(0, 0), walls_before = bottom_wall(0, 0);
    const struct vec at[2] = {vec(0, 1 * PX), vec(60 * PX, 80 * PX)};
    struct state_before before = {.at = at, .walls = &walls_before, .s_wall = {0.07 * PX}};
    g.s_angle[0] = 1e-3;
    struct pair pair = pair_with_wall(&g, 0, &walls, 0);
    struct contact_motion motion = contact_motion(&g, &walls, &pair, &before);
    double arm = 39.75 * PX;               /* to the middle of the overlap */
    check_near(motion.un, -1 * PX, 1e-15); /* the grain has come down by 1 px: the wall came nearer */
    check_near(motion.s_un, sqrt(pow(g.s_y[0], 2) + pow(0.07 * PX, 2)), 1e-15);
    check_near(motion.s_ut, sqrt(pow(g.s_x[0], 2) + pow(0.07 * PX, 2) + pow(arm * 1e-3, 2)), 1e-15);
    table_free(&WALLS, &walls);
    table_free(&WALLS, &walls_before);
    table_free(&GRAINS, &g);
}

/* An empty frame of 1000 x 800 px whose corners are known to 2 px: a side's offset to 2 px, its direction, of two ends,
 * to sqrt(2) 2 px over its length; a disc on a corner to the mean square of its two sides. */
static void test_errors_of_a_frame(void **state)
{
    (void)state;
    struct scene scene = {.scale = PX, .origin_px = vec(0, 800), .name = "frame"};
    const struct vec corners[] = {vec(0, 0), vec(1000, 0), vec(1000, 800), vec(0, 800)};
    scene.frame.given = 1;
    scene.frame.corner_radius_px = 10;
    scene.frame.corners_px[CORNER_TOP_LEFT] = corners[0];
    scene.frame.corners_px[CORNER_TOP_RIGHT] = corners[1];
    scene.frame.corners_px[CORNER_BOTTOM_RIGHT] = corners[2];
    scene.frame.corners_px[CORNER_BOTTOM_LEFT] = corners[3];
    struct grains none = {0};
    struct pair_statistics usual = {.touching = 0.9,
                                    .resting = 1e-6,
                                    .apart = 0.1,
                                    .scale = 0.1 * PX,
                                    .flat = 0.96,
                                    .wide = 0.02,
                                    .window = 0.5 * PX};
    struct frame_request request = {
        .scene = &scene, .grains = &none, .statistics = {.bearing = &usual}, .frame_error_px = 2};
    struct frame frame;
    check_done(frame_walls(&request, &frame));
    assert_int_equal(frame.now.count, 8);
    for (int k = 0; k < 4; k++) {
        check_near(frame.now.s_offset[k], 2 * PX, 1e-5 * PX); /* over a grid */
        check_near(frame.now.s_angle[k], M_SQRT2 * 2 / (k % 2 ? 800 : 1000), 1e-8);
        check_near(frame.now.s_offset[4 + k], 2 * PX, 1e-5 * PX);
        check_near(frame.now.s_angle[4 + k], 0, 0);
        check_near(frame.now.radius[4 + k], 10 * PX, 1e-15);
    }
    frame_free(&frame);
}

/* Pairs are looked for as far as `sigmas` standard errors of an overlap, sqrt(2) times a grain's. */
static void test_window_of_pairs(void **state)
{
    (void)state;
    struct grains g = two_grains();
    struct pairs pairs = {0};
    double window, error = 3 * PX;
    for (int k = 0; k < 2; k++)
        g.s_x[k] = g.s_y[k] = error, g.s_radius[k] = 0;
    check_done(candidates_between_grains(&g, 8, 0, &pairs, &window));
    check_near(window, 8 * M_SQRT2 * error, 1e-15);
    assert_int_equal(pairs.count, 1);
    pairs_free(&pairs);
    table_free(&GRAINS, &g);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_errors_of_both_grains), cmocka_unit_test(test_shapes_turn_with_the_grain),
        cmocka_unit_test(test_errors_of_a_wall),      cmocka_unit_test(test_errors_of_a_motion),
        cmocka_unit_test(test_errors_of_a_frame),     cmocka_unit_test(test_window_of_pairs),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
