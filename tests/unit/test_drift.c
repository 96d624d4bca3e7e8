/* The camera's motion from fixed paper, and the lens: undone for the grains, with their share of the error. */
#include "tests/check.h"
#include "tests/dots.h"

#include "tracker/follow/drift.h"
#include "tracker/follow/track_grains.h"

static const double degree = 3.141592653589793 / 180;
enum { PATCHES_MAX = 4 };
static const double corners[PATCHES_MAX][2] = {{300, 250}, {9800, 260}, {9900, 7400}, {280, 7500}};

/* Where a point is after the camera has turned, zoomed (about the middle of the photo) and shifted. */
static struct vec moved(struct vec p, double zoom, double turn, double tx, double ty)
{
    const double mx = 5160, my = 3876, x = p.x - mx, y = p.y - my;
    return vec(mx + tx + (1 + zoom) * (cos(turn) * x + sin(turn) * y),
               my + ty + (1 + zoom) * (-sin(turn) * x + cos(turn) * y));
}

static struct corrected patch_at(int k, double zoom, double turn, double tx, double ty, double noise, uint64_t *random)
{
    struct vec p = vec(corners[k][0], corners[k][1]), q = moved(p, zoom, turn, tx, ty);
    struct corrected patch = {.x_ref = p.x, .y_ref = p.y, .x = q.x, .y = q.y, .angle = turn};
    double turn_noise = noise / 150;
    patch.xx = patch.yy = noise * noise;
    patch.aa = turn_noise * turn_noise;
    if (random) {
        patch.x += noise * check_normal(random);
        patch.y += noise * check_normal(random);
        patch.angle += turn_noise * check_normal(random);
    }
    return patch;
}

static void test_four_patches_give_the_motion(void **state)
{
    (void)state;
    const int good[PATCHES_MAX] = {1, 1, 1, 1};
    struct corrected patches[PATCHES_MAX];
    for (int k = 0; k < PATCHES_MAX; k++)
        patches[k] = patch_at(k, 1e-4, 0.05 * degree, 2.1, -2.2, 1e-3, NULL);
    struct camera camera = camera_fit(patches, good, PATCHES_MAX);
    assert_true(camera.known);
    struct vec grain = vec(3000, 6000), seen = moved(grain, 1e-4, 0.05 * degree, 2.1, -2.2);
    double angle = 0.3 + 0.05 * degree;
    camera_undo(&camera, &seen.x, &seen.y, &angle);
    check_near(seen.x, grain.x, 1e-6);
    check_near(seen.y, grain.y, 1e-6);
    check_near(angle, 0.3, 1e-9);
}

/* 2000 noisy cameras: the scatter of a grain far from the patches is the stated one; four patches or one. */
static void test_the_covariance_is_the_scatter(void **state)
{
    (void)state;
    uint64_t random = 11;
    for (int count = 1; count <= PATCHES_MAX; count += 3) {
        int good[PATCHES_MAX] = {1, count > 1, count > 1, count > 1}, trials = 2000;
        double sum = 0, sum_angle = 0;
        for (int t = 0; t < trials; t++) {
            struct corrected patches[PATCHES_MAX];
            for (int k = 0; k < PATCHES_MAX; k++)
                patches[k] = patch_at(k, 0, 0.01 * degree, 1, 2, 1e-3, &random);
            struct camera camera = camera_fit(patches, good, PATCHES_MAX);
            struct vec seen = moved(vec(7000, 4000), 0, 0.01 * degree, 1, 2);
            double xx, yy, turn, angle = 0.01 * degree;
            camera_variance(&camera, seen.x, seen.y, &xx, &yy, &turn);
            camera_undo(&camera, &seen.x, &seen.y, &angle);
            sum += pow(seen.x - 7000, 2) / xx + pow(seen.y - 4000, 2) / yy;
            sum_angle += angle * angle / turn;
        }
        if (count == 1) { /* as many measurements as unknowns: nothing widens the covariance */
            check_near(sqrt(sum / (2 * trials)), 1, 0.06);
            check_near(sqrt(sum_angle / trials), 1, 0.06);
        } else { /* widened when the misfit is above its mean: at most a third too careful */
            check_near(sqrt(sum / (2 * trials)), 0.93, 0.12);
            check_near(sqrt(sum_angle / trials), 0.93, 0.12);
        }
    }
}

static void test_without_a_good_patch_nothing_is_known(void **state)
{
    (void)state;
    const int good[PATCHES_MAX] = {0};
    struct corrected patches[PATCHES_MAX] = {{0}};
    assert_false(camera_fit(patches, good, PATCHES_MAX).known);
}

/* A body moved and turned behind a lens: its motion without the lens comes back. */
static void test_the_lens_is_undone(void **state)
{
    (void)state;
    const struct lens lens = {.centre = {5000, 3900}, .k = {-3e-11, 1e-19, 0}, .p = {2e-8, -1e-8, 0}};
    const struct vec before = vec(800, 6900), after = vec(812.4, 6891.7);
    const double turn = 0.02, arm = 5;
    struct vec seen_before = lens_seen(&lens, before), seen_after = lens_seen(&lens, after);
    /* The turn that is seen: of a short arm of the body, in each of four directions. */
    double seen_turn = 0;
    for (int k = 0; k < 4; k++) {
        double a = k * 90 * degree, b = a + turn;
        struct vec d0 = vec_sub(lens_seen(&lens, vec(before.x + arm * cos(a), before.y - arm * sin(a))), seen_before);
        struct vec d1 = vec_sub(lens_seen(&lens, vec(after.x + arm * cos(b), after.y - arm * sin(b))), seen_after);
        seen_turn += atan2(-vec_cross(d0, d1), vec_dot(d0, d1)) / 4;
    }
    struct shape shape = {.cx = seen_before.x, .cy = seen_before.y, .radius = 80};
    struct fit fit = {.motion = {seen_after.x - seen_before.x, seen_after.y - seen_before.y, seen_turn}};
    struct corrected body = correct_lens(&lens, &shape, &fit);
    check_near(body.x_ref, before.x, 1e-8);
    check_near(body.x - body.x_ref, after.x - before.x, 1e-8);
    check_near(body.y - body.y_ref, after.y - before.y, 1e-8);
    check_near(body.angle, turn, 1e-7);
    assert_true(fabs(fit.motion.u - (after.x - before.x)) > 0.02); /* the lens does something here */
}

/* A circle of the specimen is seen as an ellipse: the stretch gives the circle back. */
static void test_an_ellipse_becomes_the_circle(void **state)
{
    (void)state;
    const struct lens lens = {.centre = {5000, 3900}, .k = {-3e-11, 0, 0}, .p = {0, 0, 0}};
    const struct vec centre = vec(9000, 700);
    const double radius = 100;
    struct vec seen = lens_seen(&lens, centre);
    double mean = 0, c = 0, s = 0;
    enum { STEPS = 360 };
    for (int k = 0; k < STEPS; k++) {
        double phi = k * degree;
        struct vec rim = lens_seen(&lens, vec(centre.x + radius * cos(phi), centre.y - radius * sin(phi)));
        double r = vec_norm(vec_sub(rim, seen));
        mean += r / STEPS;
        c += 2 * r * cos(2 * phi) / STEPS;
        s += 2 * r * sin(2 * phi) / STEPS;
    }
    struct stretch stretch = correct_stretch(&lens, seen.x, seen.y);
    check_near(stretch.magnification * mean, radius, 0.01);
    check_near(c * stretch.magnification + stretch.shape_c * mean, 0, 0.01);
    check_near(s * stretch.magnification + stretch.shape_s * mean, 0, 0.01);
    assert_true(hypot(c, s) > 0.05);
}

/* One paper alone, a zoom of 1e-3: its quarters show it. A grain 400 px away would be wrong by 0.4 px without. */
static void test_one_paper_shows_the_zoom(void **state)
{
    (void)state;
    enum { SIDE = 480 };
    const struct rect paper = {20, 20, 160, 160};
    const double zoom = 1e-3, turn = 0.1 * degree, tx = 1.3, ty = -0.6, x = 400, y = 390;
    struct canvas before = canvas_make(SIDE, SIDE, 0.7), after = canvas_make(SIDE, SIDE, 0.7);
    const double centres[2][3] = {{90, 90, 110}, {x, y, 60}};
    for (int k = 0; k < 2; k++) {
        struct dots dots = dots_make(centres[k][2], DOTS_NORMAL, 950 + (uint64_t)k);
        for (size_t d = 0; d < dots.count; d++) {
            struct vec p = vec(centres[k][0] + dots.x[d], centres[k][1] + dots.y[d]), q = moved(p, zoom, turn, tx, ty);
            canvas_add_dot(&before, p.x, p.y, dots.sigma[d], dots.height[d], 0);
            q = vec_add(q, vec_sub(vec(240, 240), moved(vec(240, 240), zoom, turn, 0, 0))); /* about the middle here */
            canvas_add_dot(&after, q.x, q.y, dots.sigma[d], dots.height[d], 0);
        }
        dots_free(&dots);
    }
    struct photo reference = canvas_photo(&before, 1, 0, 0.005, 1), photo = canvas_photo(&after, 1, 0, 0.005, 2);
    static const char *const names[] = {"x_px", "y_px", "radius_px", "flags", NULL};
    struct photo_grains grains = {0};
    struct tracker_options options = TRACKER_DEFAULT;
    struct tracks tracks = {0};
    check_done(table_alloc(&PHOTO_GRAINS, &grains, 1, names));
    grains.x_px[0] = x;
    grains.y_px[0] = y;
    grains.radius_px[0] = 45;
    options.drift = &paper;
    options.drift_count = 1;
    check_done(track_grains(&reference, &grains, &photo, NULL, &options, &tracks));
    assert_int_equal(tracks.patches.count, 1);
    check_near(tracks.grains.x_px[0], x, 5 * tracks.grains.s_x[0]);
    check_near(tracks.grains.y_px[0], y, 5 * tracks.grains.s_y[0]);
    check_near(tracks.grains.angle[0], 0, 5 * tracks.grains.s_angle[0]);
    check_at_most(tracks.grains.s_x[0], 0.03);
    tracks_free(&tracks);
    table_free(&PHOTO_GRAINS, &grains);
    free(reference.pixels);
    free(photo.pixels);
    canvas_free(&before);
    canvas_free(&after);
}

/* Drawn paper and drawn grains: the camera moves by pixels, the grains by their own 0.4 px. */
static void test_drawn_paper(void **state)
{
    (void)state;
    enum { SIDE = 420, GRAIN_COUNT = 4 };
    const struct rect paper[2] = {{20, 20, 110, 90}, {310, 320, 400, 400}};
    const double zoom = 1e-4, turn = 0.1 * degree, tx = 2.3, ty = -1.6;
    struct canvas before = canvas_make(SIDE, SIDE, 0.7), after = canvas_make(SIDE, SIDE, 0.7);
    struct photo_grains grains = {0};
    static const char *const names[] = {"x_px", "y_px", "radius_px", "flags", NULL};
    check_done(table_alloc(&PHOTO_GRAINS, &grains, GRAIN_COUNT, names));
    for (int k = 0; k < 2 + GRAIN_COUNT; k++) {
        double x = k < 2 ? (paper[k].x0 + paper[k].x1) / 2 : 140 + (k % 2) * 120;
        double y = k < 2 ? (paper[k].y0 + paper[k].y1) / 2 : 150 + (k / 4) * 110;
        double own = k < 2 ? 0 : 0.4;
        struct vec place = moved(vec(x + own, y), zoom, turn, tx, ty);
        struct dots dots = dots_make(62, DOTS_NORMAL, 900 + (uint64_t)k);
        canvas_add(&before, &dots, x, y, 0, 0);
        canvas_add(&after, &dots, place.x, place.y, turn + 0.01 * own, 0);
        dots_free(&dots);
        if (k >= 2) {
            grains.x_px[k - 2] = x;
            grains.y_px[k - 2] = y;
            grains.radius_px[k - 2] = 45;
        }
    }
    struct photo reference = canvas_photo(&before, 1, 0, 0.005, 1), photo = canvas_photo(&after, 1, 0, 0.005, 2);
    struct tracker_options options = TRACKER_DEFAULT;
    struct tracks tracks = {0};
    options.drift = paper;
    options.drift_count = 2;
    check_done(track_grains(&reference, &grains, &photo, NULL, &options, &tracks));
    assert_int_equal(tracks.patches.count, 2);
    assert_string_equal(tracks.patches.kind[0], "drift");
    for (int k = 0; k < GRAIN_COUNT; k++) {
        const struct photo_grains *g = &tracks.grains;
        assert_int_equal(g->flags[k] & GRAIN_DISTRUST, 0);
        check_near(g->x_px[k] - grains.x_px[k], 0.4, 5 * g->s_x[k]);
        check_near(g->y_px[k] - grains.y_px[k], 0, 5 * g->s_y[k]);
        check_near(g->angle[k], 0.004, 5 * g->s_angle[k]);
        check_at_most(g->s_x[k], 0.01);
        assert_true(fabs(g->x_seen_px[k] - grains.x_px[k]) > 0.5);
    }
    tracks_free(&tracks);
    table_free(&PHOTO_GRAINS, &grains);
    free(reference.pixels);
    free(photo.pixels);
    canvas_free(&before);
    canvas_free(&after);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_four_patches_give_the_motion),
        cmocka_unit_test(test_the_covariance_is_the_scatter),
        cmocka_unit_test(test_without_a_good_patch_nothing_is_known),
        cmocka_unit_test(test_the_lens_is_undone),
        cmocka_unit_test(test_an_ellipse_becomes_the_circle),
        cmocka_unit_test(test_one_paper_shows_the_zoom),
        cmocka_unit_test(test_drawn_paper),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
