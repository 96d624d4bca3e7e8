/* From a packing to its photo and the truth beside it: camera, lens, shapes, contacts of faces, markers, options. */
#include "tests/check.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "pipeline/speak/error.h"
#include "simulation/render/render.h"
#include "simulation/render/render_truth.h"

static const double PI = 3.14159265358979323846;

/* A packing of `count` discs without walls; scene: 1 mm per px, 400 x 300 px, origin at the bottom left. */
static void make(struct packing *packing, struct scene *scene, size_t count)
{
    static const char *const columns[] = {"x", "y", "radius", "angle", "mass", "inertia", "flags", NULL};
    *packing = (struct packing){0};
    *scene = (struct scene){.scale = 1e-3, .origin_px = {0, 299}};
    scene->photos.given = 1;
    scene->photos.width = 400;
    scene->photos.height = 300;
    scene->photos.interval_s = NAN;
    check_done(table_alloc(&GRAINS, &packing->grains, count, columns));
}

static void put(struct packing *packing, size_t k, double x, double y, double radius, double angle)
{
    packing->grains.x[k] = x * 1e-3;
    packing->grains.y[k] = y * 1e-3;
    packing->grains.radius[k] = radius * 1e-3;
    packing->grains.angle[k] = angle;
}

struct moments {
    double area, x, y;
};

/* Of everything brighter than the top left pixel, as a share of the pixel at (x, y). */
static struct moments light_of(const struct photo *photo, double x, double y)
{
    double dark = photo_row(photo, 0)[0], full = photo_row(photo, (int)y)[(int)x] - dark;
    struct moments m = {0};
    for (int row = 0; row < photo->height; row++)
        for (int column = 0; column < photo->width; column++) {
            double share = (photo_row(photo, row)[column] - dark) / full;
            m.area += share;
            m.x += share * column;
            m.y += share * row;
        }
    m.x /= m.area;
    m.y /= m.area;
    return m;
}

/* Where the camera of this test shows a corrected position: the similarity written out, the lens by its inverse. */
static struct vec shown(const struct view *view, const struct lens *lens, double x, double y)
{
    double dx = x - 199.5, dy = y - 149.5, c = cos(view->angle), s = sin(view->angle);
    struct vec p =
        vec(199.5 + view->zoom * (c * dx + s * dy) + view->dx, 149.5 + view->zoom * (-s * dx + c * dy) + view->dy);
    return lens ? lens_seen(lens, p) : p;
}

/* Area and centroid of the disc as shown, by Green's theorem over its rim. */
static struct moments shown_disc(const struct view *view, const struct lens *lens, double x, double y, double radius)
{
    enum { POINTS = 4000 };
    struct moments m = {0};
    struct vec a = shown(view, lens, x + radius, y), o = a;
    for (int k = 1; k <= POINTS; k++) {
        double phi = 2 * PI * k / POINTS;
        struct vec b = shown(view, lens, x + radius * cos(phi), y + radius * sin(phi));
        double twice = (a.x - o.x) * (b.y - o.y) - (a.y - o.y) * (b.x - o.x);
        m.area += twice / 2;
        m.x += twice / 2 * (a.x + b.x + o.x) / 3;
        m.y += twice / 2 * (a.y + b.y + o.y) / 3;
        a = b;
    }
    m.x /= m.area;
    m.y /= m.area;
    return m;
}

static void test_camera_and_lens_bend_what_is_drawn(void **state)
{
    (void)state;
    static const struct lens lens = {{210, 140}, {-2e-7, 1e-13, 0}, {3e-7, -2e-7, 1e-9}};
    uint64_t seed = 5;
    double worst = 0, worst_radius = 0, bend = 0;
    for (int trial = 0; trial < 24; trial++) {
        static const char *const columns[] = {"x_px", "y_px", "radius_px", NULL};
        struct photo_grains grains = {0};
        struct photo photo = {0};
        struct optics optics = OPTICS_PLAIN;
        struct view view = {3 * check_normal(&seed),
                            3 * check_normal(&seed),
                            0.02 * check_normal(&seed),
                            1 + 0.01 * check_normal(&seed),
                            0,
                            0};
        check_done(table_alloc(&PHOTO_GRAINS, &grains, 1, columns));
        double x = grains.x_px[0] = 60 + 280 * check_uniform(&seed),
               y = grains.y_px[0] = 60 + 180 * check_uniform(&seed);
        double radius = grains.radius_px[0] = 20 + 20 * check_uniform(&seed);
        struct picture picture = {
            .width = 400, .height = 300, .grains = &grains, .view = view, .lens = trial % 2 ? &lens : NULL};
        check_done(render_picture(&picture, &optics, &photo));
        struct moments drawn = light_of(&photo, x, y), true_one = shown_disc(&view, picture.lens, x, y, radius);
        struct vec straight = shown(&view, NULL, x, y);
        bend = fmax(bend, hypot(true_one.x - straight.x, true_one.y - straight.y));
        worst = fmax(worst, hypot(drawn.x - true_one.x, drawn.y - true_one.y));
        worst_radius = fmax(worst_radius, fabs(sqrt(drawn.area / PI) - sqrt(true_one.area / PI)));
        photo_free(&photo);
        table_free(&PHOTO_GRAINS, &grains);
    }
    print_message("the lens moves by up to %.2f px; worst centre %.2g px, worst radius %.2g px\n", bend, worst,
                  worst_radius);
    assert_true(bend > 0.5);
    check_at_most(worst, 0.0005);
    check_at_most(worst_radius, 0.001);
}

/* The truth of a moved camera: seen positions and angles are where the similarity and the lens put them. */
static void test_truth_says_what_is_seen(void **state)
{
    (void)state;
    struct packing packing;
    struct scene scene;
    struct photo photo = {0};
    struct photo_truth truth;
    struct optics optics = OPTICS_PLAIN;
    const char *path = FILM_BINARY_DIR "/tests/test_render_truth_lens.json";
    FILE *file = fopen(path, "w");
    assert_non_null(file);
    fputs("{\"schema\": \"film.lens/1\", \"map\": \"corrected from seen\", \"centre_px\": [210, 140], "
          "\"K\": [-2e-7, 0, 0], \"P\": [3e-6, -2e-6, 0]}",
          file);
    fclose(file);
    make(&packing, &scene, 1);
    put(&packing, 0, 90.3, 80.7, 30, 0.4);
    scene.lens = strdup(path);
    optics.wander = (struct view){2, 2, 0.01, 0.001, 0, 0};
    check_done(render(&packing, &optics, &scene, 3, &photo, &truth));
    check_near(truth.grains.x_px[0], 90.3, 1e-9);
    check_near(truth.grains.y_px[0], 299 - 80.7, 1e-9);
    assert_true(fabs(truth.view.dx) > 0.01 && fabs(truth.view.angle) > 1e-4);
    struct lens lens = {{210, 140}, {-2e-7, 0, 0}, {3e-6, -2e-6, 0}};
    struct vec seen = shown(&truth.view, &lens, 90.3, 299 - 80.7);
    check_near(truth.grains.x_seen_px[0], seen.x, 1e-8);
    check_near(truth.grains.y_seen_px[0], seen.y, 1e-8);
    struct vec e = shown(&truth.view, &lens, 90.4, 299 - 80.7), w = shown(&truth.view, &lens, 90.2, 299 - 80.7);
    struct vec s = shown(&truth.view, &lens, 90.3, 299.1 - 80.7), n = shown(&truth.view, &lens, 90.3, 298.9 - 80.7);
    double turn = atan2(s.x - n.x - (e.y - w.y), e.x - w.x + (s.y - n.y));
    check_near(truth.grains.angle_seen[0] - 0.4, turn, 1e-6);
    struct moments drawn = light_of(&photo, seen.x, seen.y),
                   disc = shown_disc(&truth.view, &lens, 90.3, 299 - 80.7, 30);
    check_near(drawn.x, disc.x, 0.0005);
    check_near(drawn.y, disc.y, 0.0005);
    photo_truth_free(&truth);
    photo_free(&photo);
    check_done(render(&packing, &optics, &scene, 0, &photo, &truth)); /* the reference: the camera has not moved */
    check_near(hypot(truth.view.dx, truth.view.dy), 0, 0);
    photo_truth_free(&truth);
    photo_free(&photo);
    free(scene.lens);
    remove(path);
    packing_free(&packing);
}

static double rim(const struct photo_grains *g, size_t k, double phi)
{
    return g->radius_px[k] + g->shape_c[k] * cos(2 * (phi - g->angle[k])) +
           g->shape_s[k] * sin(2 * (phi - g->angle[k]));
}

static void test_elliptic_faces_touch_where_their_rims_do(void **state)
{
    (void)state;
    struct packing packing;
    struct scene scene;
    struct photo photo = {0};
    struct photo_truth truth;
    struct optics optics = OPTICS_PLAIN;
    make(&packing, &scene, 40);
    for (size_t k = 0; k < 40; k++)
        put(&packing, k, 30 + 40.0 * (double)(k % 8), 25 + 40.0 * (double)(k / 8), 20, 0.3 * (double)k);
    optics.ellipticity = 0.02;
    check_done(render(&packing, &optics, &scene, 0, &photo, &truth));
    const struct photo_grains *g = &truth.grains;
    size_t row = 0, pairs = 0;
    for (size_t i = 0; i < 40; i++)
        for (size_t j = i + 1; j < 40; j++) {
            double dx = g->x_px[j] - g->x_px[i], dy = g->y_px[i] - g->y_px[j], d = hypot(dx, dy), phi = atan2(dy, dx);
            double overlap = rim(g, i, phi) + rim(g, j, phi + PI) - d;
            pairs += d < 41;
            if (overlap <= 0)
                continue;
            assert_true(row < truth.contacts.count);
            assert_int_equal(truth.contacts.i[row], i);
            assert_int_equal(truth.contacts.j[row], j);
            check_near(truth.contacts.overlap[row] / 1e-3, overlap, 1e-9);
            check_near(truth.contacts.nx[row], dx / d, 1e-12);
            check_near(truth.contacts.x[row] / 1e-3, g->x_px[i] + (rim(g, i, phi) - overlap / 2) * dx / d, 1e-9);
            row++;
        }
    assert_int_equal(row, truth.contacts.count);
    assert_true(row > pairs / 4 && row < 3 * pairs / 4); /* some touch, some do not */
    photo_truth_free(&truth);
    photo_free(&photo);
    packing_free(&packing);
}

static void test_mean_ellipticity(void **state)
{
    (void)state;
    struct packing packing;
    struct scene scene;
    struct photo_truth truth = {0};
    struct picture picture;
    struct plate *plates = NULL;
    struct optics optics = OPTICS_PLAIN;
    double mean = 0;
    make(&packing, &scene, 4000);
    for (size_t k = 0; k < 4000; k++)
        put(&packing, k, (double)k, 0, 10, 0);
    optics.ellipticity = 0.01;
    check_done(picture_of(&packing, &optics, &scene, 0, NULL, &truth, &plates, &picture));
    for (size_t k = 0; k < 4000; k++)
        mean += 2 * hypot(truth.grains.shape_c[k], truth.grains.shape_s[k]) / 10 / 4000;
    check_near(mean, 0.01, 4 * 0.01 * 0.523 / sqrt(4000)); /* Rayleigh: deviation 0.523 of the mean */
    free(plates);
    photo_truth_free(&truth);
    packing_free(&packing);
}

/* A wall that has moved takes its marker along: the middle of its inner line and its direction. */
static void test_markers_follow_their_wall(void **state)
{
    (void)state;
    static const char *const names[] = {"bottom", "right", "top", "left"};
    struct packing packing;
    struct scene scene;
    struct photo_truth truth;
    struct photo photo = {0};
    struct optics optics = OPTICS_PLAIN;
    struct scene_marker marker = {"top", {100, 20, 160, 40}};
    make(&packing, &scene, 0);
    check_done(table_alloc(&WALLS, &packing.walls, 4, NULL));
    /* px, y up from the bottom: the top wall slopes by 2 px over 200. */
    double walls[4][4] = {{50, 50, 250, 50}, {250, 50, 250, 242}, {250, 242, 50, 240}, {50, 240, 50, 50}};
    for (size_t w = 0; w < 4; w++) {
        memcpy(packing.walls.name[w], names[w], strlen(names[w]));
        packing.walls.x0[w] = walls[w][0] * 1e-3;
        packing.walls.y0[w] = walls[w][1] * 1e-3;
        packing.walls.x1[w] = walls[w][2] * 1e-3;
        packing.walls.y1[w] = walls[w][3] * 1e-3;
        packing.walls.radius[w] = 0;
    }
    scene.frame.given = 1;
    const struct vec corners[4] = {{50, 50}, {250, 50}, {250, 249}, {50, 249}}; /* reference: level at y = 50 px */
    memcpy(scene.frame.corners_px, corners, sizeof corners);
    scene.frame.markers = &marker;
    scene.frame.marker_count = 1;
    optics.marker = (struct surface){.level = 0.8};
    check_done(render(&packing, &optics, &scene, 0, &photo, &truth));
    double turn = atan2(2, 200); /* the right end rises: counter-clockwise as seen */
    /* Middle of the inner line: from (150, 50) to (150, 299 - 241 = 58); the arm (-20, -20) turns with it. */
    double x = 150 + cos(turn) * -20 + sin(turn) * -20, y = 58 - sin(turn) * -20 + cos(turn) * -20;
    check_near(truth.patches.angle[0], turn, 1e-12);
    check_near(truth.patches.x_px[0], x, 1e-9);
    check_near(truth.patches.y_px[0], y, 1e-9);
    check_near(truth.patches.dx_px[0], x - 130, 1e-9);
    double dark = photo_row(&photo, 0)[0], mass = 0, mx = 0, my = 0; /* frame, void and outside have one level */
    for (int row = 0; row < 300; row++)
        for (int column = 0; column < 400; column++) {
            double light = photo_row(&photo, row)[column] - dark;
            mass += light;
            mx += light * column;
            my += light * row;
        }
    check_near(mx / mass, x, 0.001);
    check_near(my / mass, y, 0.001);
    check_near(mass / ((0.8 - 0.05) * 65535), 60 * 20, 0.2);
    photo_truth_free(&truth);
    photo_free(&photo);
    packing_free(&packing);
}

static int read_optics(const char *section, struct optics *optics)
{
    const char *path = FILM_BINARY_DIR "/tests/test_render_scene.json";
    struct scene scene = {0};
    FILE *file = fopen(path, "w");
    assert_non_null(file);
    fprintf(file, "{\"schema\": \"film.scene/1\", \"name\": \"t\", \"optics\": %s}", section);
    fclose(file);
    check_done(scene_read(path, &scene));
    int status = optics_read(&scene, optics);
    scene_free(&scene);
    remove(path);
    return status;
}

static void test_optics_section(void **state)
{
    (void)state;
    struct optics optics;
    check_done(read_optics(
        "{\"seed\": 5, \"psf_px\": 1.1, \"noise\": {\"read\": 0.01}, \"grain\": {\"level\": 0.4, \"paint\": "
        "[{\"radius_px\": [1, 2], \"coverage\": 0.3, \"level\": [0.1, 0.2]}], \"ellipticity\": 0.01}, \"labels_px\": "
        "[[1, 2, 3, 4]]}",
        &optics));
    assert_int_equal(optics.label_count, 1);
    check_near(optics.labels[0].y1, 4, 0);
    optics_free(&optics);
    check_near(optics.psf, 1.1, 0);
    assert_int_equal(optics.grain.paint_count, 1);
    check_near(optics.grain.paint[0].level_max, 0.2, 0);
    static const char *const wrong[] = {
        "{\"psf\": 1}",
        "{\"psf_px\": 0.1}",
        "{\"bits\": 17}",
        "{\"noise\": {\"red\": 1}}",
        "{\"grain\": {\"paint\": [{\"radius_px\": [2, 1], \"coverage\": 0.3, \"level\": [0.1, 0.2]}]}}",
        "{\"grain\": {\"paint\": [{\"radius_px\": [1, 2], \"coverage\": 1.0, \"level\": [0.1, 0.2]}]}}",
        "{\"grain\": {\"paint\": [{\"radius_px\": [1, 2], \"coverage\": 0.5}]}}",
        "{\"labels_px\": [[1, 2, 3]]}",
        "{\"labels_px\": [[1, 2, 3]]}",
        "{\"grain\": {\"rings\": {\"contrast\": 0.5}}}",
        "{\"camera\": {\"shift\": 1}}",
        "{\"seed\": -1}"};
    for (size_t k = 0; k < sizeof wrong / sizeof *wrong; k++) {
        assert_int_equal(read_optics(wrong[k], &optics), -1);
        assert_int_equal(error_status(), EXIT_INPUT);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_camera_and_lens_bend_what_is_drawn),
        cmocka_unit_test(test_truth_says_what_is_seen),
        cmocka_unit_test(test_elliptic_faces_touch_where_their_rims_do),
        cmocka_unit_test(test_mean_ellipticity),
        cmocka_unit_test(test_markers_follow_their_wall),
        cmocka_unit_test(test_optics_section),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
