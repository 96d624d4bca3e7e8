/* find_contacts on packings whose network is known by construction. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "contacts/find_contacts.h"
#include "contacts/network/holding.h"
#include "contacts/picture/network_picture.h"
#include "pipeline/speak/error.h"
#include "pipeline/packing/packing_file.h"
#include "tests/check.h"

#define SCALE 1e-4 /* m per px */
static const double pi = 3.14159265358979323846;

/* A scene and a photo in memory, given in px with y UP from the bottom of a photo 1000 px high, for the mind's ease. */
struct setup {
    struct scene scene;
    struct photo_grains grains;
    struct contact_options options;
    struct contact_input input;
    struct packing packing;
    struct contact_summary summary;
};
#define HEIGHT 1000.0

static const char *const basic[] = {"x_px", "y_px", "radius_px", "flags", NULL};

static struct setup setup_new(size_t count)
{
    struct setup s = {.options = CONTACT_OPTIONS_DEFAULT};
    s.scene.path = "scene.json";
    s.scene.scale = SCALE;
    s.scene.origin_px = vec(0, HEIGHT);
    s.scene.grains.density = s.scene.grains.length = NAN;
    s.options.frame_error_px = 0;
    check_done(table_alloc(&PHOTO_GRAINS, &s.grains, count, basic));
    return s;
}

static void put(struct setup *s, size_t k, double x, double up, double radius)
{
    s->grains.x_px[k] = x;
    s->grains.y_px[k] = HEIGHT - up;
    s->grains.radius_px[k] = radius;
}

static void add_column(struct setup *s, const char *name, double **column, double value)
{
    check_done(table_add(&PHOTO_GRAINS, &s->grains, name));
    for (size_t k = 0; k < s->grains.count; k++)
        (*column)[k] = value;
}

static void set_frame(struct setup *s, double x0, double up0, double x1, double up1)
{
    s->scene.frame.given = 1;
    s->scene.frame.corners_px[CORNER_TOP_LEFT] = vec(x0, HEIGHT - up1);
    s->scene.frame.corners_px[CORNER_TOP_RIGHT] = vec(x1, HEIGHT - up1);
    s->scene.frame.corners_px[CORNER_BOTTOM_RIGHT] = vec(x1, HEIGHT - up0);
    s->scene.frame.corners_px[CORNER_BOTTOM_LEFT] = vec(x0, HEIGHT - up0);
}

static int find(struct setup *s, const struct packing *previous, int is_reference)
{
    s->input = (struct contact_input){
        .scene = &s->scene, .grains = &s->grains, .previous = previous, .is_reference = is_reference};
    packing_free(&s->packing);
    return find_contacts(&s->input, &s->options, &s->packing, &s->summary);
}

static void setup_free(struct setup *s)
{
    packing_free(&s->packing);
    table_free(&PHOTO_GRAINS, &s->grains);
}

static long row_of(const struct setup *s, int64_t i, int64_t j)
{
    for (size_t c = 0; c < s->packing.contacts.count; c++)
        if (s->packing.contacts.i[c] == i && s->packing.contacts.j[c] == j)
            return (long)c;
    return -1;
}

static void test_two_grains(void **state)
{
    (void)state;
    struct setup s = setup_new(2);
    put(&s, 0, 100, 100, 50);
    put(&s, 1, 160, 180, 50.4); /* 3-4-5: distance 100, overlap 0.4 px */
    check_done(find(&s, NULL, 1));
    const struct contacts *c = &s.packing.contacts;
    assert_int_equal(c->count, 1);
    assert_int_equal(c->flags[0] & CONTACT_CANDIDATE, 0);
    check_near(c->nx[0], 0.6, 1e-12);
    check_near(c->ny[0], 0.8, 1e-12); /* y is up */
    check_near(c->overlap[0], 0.4 * SCALE, 1e-15);
    check_near(c->x[0], (100 + 0.6 * 49.8) * SCALE, 1e-15);
    check_near(c->y[0], (100 + 0.8 * 49.8) * SCALE, 1e-15);
    check_near(c->s_overlap[0], 0, 0);
    check_near(c->probability[0], 1, 1e-9);
    assert_int_equal(s.summary.rattlers, 2); /* one contact holds nothing */
    setup_free(&s);
}

static void test_one_grain_and_no_contact(void **state)
{
    (void)state;
    struct setup s = setup_new(0);
    set_frame(&s, 0, 0, 500, 400);
    s.options.frame_error_px = 0.3;
    s.options.radius_offset_auto = 1;
    check_done(find(&s, NULL, 1)); /* no grain at all */
    assert_int_equal(s.packing.contacts.count, 0);
    assert_int_equal(s.packing.walls.count, 4);
    setup_free(&s);
    s = setup_new(1);
    put(&s, 0, 10, 10, 5);
    check_done(find(&s, NULL, 1));
    assert_int_equal(s.packing.contacts.count, 0);
    assert_int_equal(s.packing.grains.flags[0], GRAIN_RATTLER);
    setup_free(&s);
    s = setup_new(25);
    for (size_t k = 0; k < 25; k++)
        put(&s, k, 12.0 * (double)(k % 5), 12.0 * (double)(k / 5), 5);
    check_done(find(&s, NULL, 1));
    assert_int_equal(s.packing.contacts.count, 0);
    assert_int_equal(s.summary.rattlers, 25);
    setup_free(&s);
}

static void test_radius_correction(void **state)
{
    (void)state;
    struct setup s = setup_new(2);
    put(&s, 0, 100, 100, 50);
    put(&s, 1, 200, 100, 49);
    check_done(find(&s, NULL, 1));
    assert_int_equal(s.summary.contacts, 0);
    s.options.radius_offset_px = 0.75;
    check_done(find(&s, NULL, 1));
    check_near(s.packing.contacts.overlap[0], 0.5 * SCALE, 1e-15);
    s.options.radius_offset_px = 0;
    s.options.radius_scale = 1.02;
    check_done(find(&s, NULL, 1));
    check_near(s.packing.contacts.overlap[0], 0.98 * SCALE, 1e-15);
    s.options.radius_scale = 1;
    s.options.tolerance_px = 1.01;
    check_done(find(&s, NULL, 1));
    assert_int_equal(s.summary.contacts, 1);
    s.options.tolerance_px = 0.99;
    check_done(find(&s, NULL, 1));
    assert_int_equal(s.summary.contacts, 0);
    setup_free(&s);
}

/* n x n grains between four walls: 2 n (n - 1) contacts between grains, 4 n with walls, all overlaps alike. */
static void test_square_lattice_with_walls(void **state)
{
    (void)state;
    enum { N = 6 };
    const double r = 20, x = 0.25, pitch = 2 * r - x, low = 100;
    const double high = low + (N - 1) * pitch + 2 * (r - x);
    struct setup s = setup_new(N * N);
    for (size_t k = 0; k < N * N; k++)
        put(&s, k, low + r - x + pitch * (double)(k % N), low + r - x + pitch * (double)(k / N), r);
    set_frame(&s, low, low, high, high);
    check_done(find(&s, NULL, 1));
    assert_int_equal(s.summary.contacts, 2 * N * (N - 1) + 4 * N);
    assert_int_equal(s.summary.wall_contacts, 4 * N);
    assert_int_equal(s.summary.candidates, 0);
    assert_int_equal(s.summary.rattlers, 0);
    for (size_t c = 0; c < s.packing.contacts.count; c++)
        check_near(s.packing.contacts.overlap[c], x * SCALE, 1e-14);
    const char *const names[] = {"bottom", "right", "top", "left"};
    const double nx[] = {0, 1, 0, -1}, ny[] = {-1, 0, 1, 0};
    const int64_t grain[] = {2, 3 * N - 1, N * N - 3, 2 * N}; /* one grain on each */
    for (int w = 0; w < 4; w++) {
        assert_string_equal(s.packing.walls.name[w], names[w]);
        long c = row_of(&s, grain[w], N * N + w);
        assert_true(c >= 0);
        check_near(s.packing.contacts.nx[c], nx[w], 1e-12);
        check_near(s.packing.contacts.ny[c], ny[w], 1e-12);
        assert_true(s.packing.contacts.flags[c] & CONTACT_WALL);
    }
    check_near(walls_area(&s.packing.walls), pow((high - low) * SCALE, 2), 1e-12);
    setup_free(&s);
}

/* The fabric stands in the file: every normal of a square lattice lies along an axis. */
static void test_fabric_in_the_file(void **state)
{
    (void)state;
    enum { N = 3 };
    const char *path = FILM_BINARY_DIR "/test_contacts.hdf";
    struct setup s = setup_new(N * N);
    for (size_t k = 0; k < N * N; k++)
        put(&s, k, 39.75 * (double)(k % N), 39.75 * (double)(k / N), 20);
    check_done(find(&s, NULL, 1));
    struct provenance provenance = PROVENANCE_DEFAULT;
    provenance.stage = "contacts";
    provenance.parameters = "{}";
    check_done(packing_write(path, &s.packing, &provenance));
    double z, directions[36];
    struct state *file = state_open(path);
    assert_non_null(file);
    check_done(state_read_numbers(file, "contacts", "z", &z, 1));
    check_done(state_read_numbers(file, "contacts", "directions", directions, 36));
    state_close(file);
    remove(path);
    check_near(z, 2.0 * 12 / 9, 1e-12);
    check_near(directions[0] + directions[35], 6, 0); /* along x, rounding on either side */
    check_near(directions[17] + directions[18], 6, 0);
    setup_free(&s);
}

static void test_hexagonal_crystal(void **state)
{
    (void)state;
    enum { N = 12 };
    for (int sign = -1; sign <= 1; sign += 2) { /* all overlap by 0.1 px, then all are 0.1 px apart */
        const double r = 30, pitch = 2 * r - sign * 0.1;
        struct setup s = setup_new(N * N);
        for (size_t k = 0; k < N * N; k++) {
            size_t row = k / N;
            put(&s, k, pitch * ((double)(k % N) + 0.5 * (double)(row % 2)), pitch * sqrt(0.75) * (double)row, r);
        }
        check_done(find(&s, NULL, 1));
        size_t along = N * (N - 1), across = (N - 1) * (2 * N - 1);
        assert_int_equal(s.summary.contacts, sign > 0 ? along + across : 0);
        setup_free(&s);
    }
}

static void test_two_walls_and_a_corner_disc(void **state)
{
    (void)state;
    const double r = 40, corner = r * (sqrt(2.0) - 1); /* exactly reaches the grain in the corner */
    struct setup s = setup_new(1);
    put(&s, 0, 100 + r - 0.2, 100 + r - 0.3, r);
    set_frame(&s, 100, 100, 600, 500);
    s.scene.frame.corner_radius_px = corner;
    check_done(find(&s, NULL, 1));
    assert_int_equal(s.packing.walls.count, 8);
    assert_string_equal(s.packing.walls.name[4], "bottom-left");
    assert_int_equal(s.summary.contacts, 3);
    long bottom = row_of(&s, 0, 1 + 0), left = row_of(&s, 0, 1 + 3), disc = row_of(&s, 0, 1 + 4);
    assert_true(bottom >= 0 && left >= 0 && disc >= 0);
    check_near(s.packing.contacts.overlap[bottom], 0.3 * SCALE, 1e-15);
    check_near(s.packing.contacts.overlap[left], 0.2 * SCALE, 1e-15);
    check_near(s.packing.contacts.overlap[disc], (r + corner - hypot(r - 0.2, r - 0.3)) * SCALE, 1e-15);
    assert_true(s.packing.contacts.nx[disc] < 0 && s.packing.contacts.ny[disc] < 0);
    assert_int_equal(s.packing.grains.flags[0], 0); /* held */
    setup_free(&s);
}

/* A ring of 60 small discs around one 20 times as large. */
static void test_ratio_of_twenty(void **state)
{
    (void)state;
    const double big = 200, small = 10;
    struct setup s = setup_new(61);
    put(&s, 60, 500, 500, big);
    for (size_t k = 0; k < 60; k++) {
        double a = 2 * pi * (double)k / 60, d = big + small - (k % 2 ? 0.2 : -0.2);
        put(&s, k, 500 + d * cos(a), 500 + d * sin(a), small);
    }
    check_done(find(&s, NULL, 1));
    for (int64_t k = 0; k < 60; k++)
        assert_true((row_of(&s, k, 60) >= 0) == (k % 2 == 1));
    setup_free(&s);
}

static void test_identical_centres_are_refused(void **state)
{
    (void)state;
    struct setup s = setup_new(3);
    put(&s, 0, 100, 100, 20);
    put(&s, 1, 300, 100, 20);
    put(&s, 2, 100, 100, 21);
    assert_int_equal(find(&s, NULL, 1), -1);
    assert_int_equal(error_status(), EXIT_INPUT);
    assert_non_null(strstr(error_message(), "grains 0 and 2"));
    assert_int_equal(s.packing.contacts.count, 0);
    setup_free(&s);
}

/* A standard error or a shape that is no number does not make a grain exact, or a circle. */
static void test_missing_errors_are_flagged(void **state)
{
    (void)state;
    for (int k = 0; k < 4; k++) {
        struct setup s = setup_new(4);
        for (size_t g = 0; g < 4; g++)
            put(&s, g, 39.8 * (double)g, 100, 20);
        add_column(&s, "s_x", &s.grains.s_x, 0.003);
        add_column(&s, "s_radius", &s.grains.s_radius, 0.02);
        add_column(&s, "shape_c", &s.grains.shape_c, 0.01);
        add_column(&s, "s_shape", &s.grains.s_shape, 0.01);
        double *const columns[] = {s.grains.s_x, s.grains.s_radius, s.grains.shape_c, s.grains.s_shape};
        columns[k][1] = k == 3 ? -0.01 : k == 1 ? INFINITY : NAN;
        check_done(find(&s, NULL, 1));
        assert_int_equal(s.packing.grains.flags[1], GRAIN_NOT_FINITE);
        assert_int_equal(s.summary.unusable, 1);
        assert_int_equal(s.packing.contacts.count, 1); /* of grains 2 and 3 */
        setup_free(&s);
    }
}

static void test_missing_numbers_are_flagged(void **state)
{
    (void)state;
    struct setup s = setup_new(4);
    for (size_t k = 0; k < 4; k++)
        put(&s, k, 39.8 * (double)k, 100, 20);
    s.grains.radius_px[1] = NAN;
    check_done(find(&s, NULL, 1));
    assert_int_equal(s.packing.grains.count, 4);
    assert_int_equal(s.packing.grains.flags[1], GRAIN_NOT_FINITE);
    assert_int_equal(s.summary.unusable, 1);
    assert_int_equal(s.packing.contacts.count, 1);
    assert_true(row_of(&s, 2, 3) == 0);
    setup_free(&s);
}

static void test_no_scale_is_refused(void **state)
{
    (void)state;
    struct setup s = setup_new(1);
    s.scene.scale = NAN;
    assert_int_equal(find(&s, NULL, 1), -1);
    assert_int_equal(error_status(), EXIT_INPUT);
    assert_non_null(strstr(error_message(), "scale_m_per_px"));
    setup_free(&s);
}

static void test_mass_and_weight(void **state)
{
    (void)state;
    struct setup s = setup_new(1);
    put(&s, 0, 100, 100, 50);
    s.scene.gravity = vec(0, -9.81);
    assert_int_equal(find(&s, NULL, 1), -1); /* weight needs a density */
    assert_int_equal(error_status(), EXIT_INPUT);
    s.scene.grains.density = 730;
    s.scene.grains.length = 0.06;
    check_done(find(&s, NULL, 1));
    double r = 50 * SCALE, mass = 730 * 0.06 * pi * r * r;
    check_near(s.packing.grains.mass[0], mass, 1e-14);
    check_near(s.packing.grains.inertia[0], 0.5 * mass * r * r, 1e-18);
    check_near(s.packing.grains.load_y[0], -9.81 * mass, 1e-14);
    check_near(s.packing.grains.load_x[0], 0, 0);
    assert_int_equal(s.packing.grains.flags[0], GRAIN_RATTLER | GRAIN_FLOATING);
    setup_free(&s);
}

/* Two tracked grains side by side, i = 0 left, j = 1 right, whose motion since the reference is given with y up. */
static struct setup tracked_pair(double ux0, double uy0, double turn0, double ux1, double uy1, double turn1)
{
    struct setup s = setup_new(2);
    put(&s, 0, 100 + ux0, 500 + uy0, 40);
    put(&s, 1, 179.5 + ux1, 500 + uy1, 40);
    add_column(&s, "x_ref_px", &s.grains.x_ref_px, 0);
    add_column(&s, "y_ref_px", &s.grains.y_ref_px, HEIGHT - 500);
    add_column(&s, "angle", &s.grains.angle, 0);
    s.grains.x_ref_px[0] = 100;
    s.grains.x_ref_px[1] = 179.5;
    s.grains.angle[0] = turn0;
    s.grains.angle[1] = turn1;
    return s;
}

static void check_motion(struct setup s, double un, double ut)
{
    add_column(&s, "s_x", &s.grains.s_x, 0.003);
    add_column(&s, "s_y", &s.grains.s_y, 0.004);
    add_column(&s, "s_angle", &s.grains.s_angle, 1e-4);
    check_done(find(&s, NULL, 0));
    const struct contacts *c = &s.packing.contacts;
    assert_int_equal(c->count, 1);
    check_near(c->un[0], un * SCALE, 1e-7 * SCALE);
    check_near(c->ut[0], ut * SCALE, 1e-7 * SCALE);
    check_near(c->s_un[0], 0.003 * sqrt(2) * SCALE, 1e-9);
    check_near(c->s_ut[0], sqrt(2 * (0.004 * 0.004 + pow(39.75 * 1e-4, 2))) * SCALE, 1e-9);
    setup_free(&s);
}

/* The lever arm is 39.75 px: radius 40 less half of the overlap 0.5. */
static void test_motion_since_the_reference(void **state)
{
    (void)state;
    /* Second order in the rotation: a pair that turns as one by a slips by d a^3 / 24, 3e-8 px here. */
    check_motion(tracked_pair(3, 4, 0, 3, 4, 0), 0, 0);             /* both move alike */
    check_motion(tracked_pair(0, 0, 0, -0.1, 0, 0), -0.1, 0);       /* j comes closer */
    check_motion(tracked_pair(0, 0, 0, 0, 0, 0.001), 0, -39.75e-3); /* j turns counter-clockwise */
    check_motion(tracked_pair(0, 0, 0.001, 0, 0, 0), 0, -39.75e-3); /* i turns counter-clockwise */
    check_motion(tracked_pair(0, 0, 0.001, 0, 0, -0.001), 0, 0);    /* two gear wheels */
    check_motion(tracked_pair(0, -1e-4, 0, 0, 1e-4, 0), 0, 2e-4);   /* j rises */
    double a = 0.002, half = 39.75;                                 /* the pair turns as one body */
    check_motion(tracked_pair(half * (1 - cos(a)), -half * sin(a), a, half * (cos(a) - 1), half * sin(a), a), 0, 0);
}

static void test_motion_since_the_previous(void **state)
{
    (void)state;
    struct setup first = tracked_pair(0, 0, 0, 0.05, 0, 0.001), second = tracked_pair(0, 0, 0, 0.02, 0, 0.003);
    check_done(find(&first, NULL, 0));
    check_done(find(&second, &first.packing, 0));
    const struct contacts *c = &second.packing.contacts;
    check_near(c->dun[0], -0.03 * SCALE, 1e-12);
    check_near(c->dut[0], -0.002 * 39.76 * SCALE, 1e-9);
    check_near(c->un[0], 0.02 * SCALE, 1e-12);
    assert_int_equal(c->flags[0] & CONTACT_NEW, 0);
    /* Apart before, touching now: new, without increments. */
    struct setup apart = tracked_pair(0, 0, 0, 5, 0, 0);
    check_done(find(&apart, NULL, 0));
    assert_int_equal(apart.packing.contacts.count, 0);
    check_done(find(&second, &apart.packing, 0));
    assert_true(second.packing.contacts.flags[0] & CONTACT_NEW);
    assert_true(isnan(second.packing.contacts.dun[0]));
    check_near(second.packing.contacts.un[0], 0.02 * SCALE, 1e-12);
    setup_free(&first);
    setup_free(&second);
    setup_free(&apart);
}

/* 1 % ellipses: the rim along the branch decides. */
static void test_elliptic_rims(void **state)
{
    (void)state;
    struct setup s = setup_new(3);
    add_column(&s, "shape_c", &s.grains.shape_c, 0);
    add_column(&s, "shape_s", &s.grains.shape_s, 0);
    put(&s, 0, 100, 500, 50);
    put(&s, 1, 200.4, 500, 50);     /* to the right: touches with the long axis of grain 0 */
    put(&s, 2, 100, 600 - 0.1, 50); /* above: would touch as circles */
    s.grains.shape_c[0] = 0.5;
    check_done(find(&s, NULL, 1));
    assert_int_equal(s.packing.contacts.count, 1);
    check_near(s.packing.contacts.overlap[row_of(&s, 0, 1)], 0.1 * SCALE, 1e-15);
    /* Turn the ellipse by 90 degrees with the grain: the other one touches. */
    add_column(&s, "angle", &s.grains.angle, 0);
    add_column(&s, "x_ref_px", &s.grains.x_ref_px, 0);
    add_column(&s, "y_ref_px", &s.grains.y_ref_px, 0);
    s.grains.shape_c[0] = 0.3;
    s.grains.angle[0] = pi / 4;
    s.grains.shape_s[0] = 0; /* at 45 degrees the axes carry nothing */
    check_done(find(&s, NULL, 0));
    check_near(s.packing.contacts.overlap[row_of(&s, 0, 2)], 0.1 * SCALE, 1e-15);
    s.grains.angle[0] = pi / 2;
    check_done(find(&s, NULL, 0));
    assert_int_equal(s.packing.contacts.count,
                     1); /* the long axis points up now: 0.3 px more there, less to the side */
    check_near(s.packing.contacts.overlap[row_of(&s, 0, 2)], 0.4 * SCALE, 1e-15);
    setup_free(&s);
}

static void test_error_of_an_overlap(void **state)
{
    (void)state;
    struct setup s = setup_new(2);
    put(&s, 0, 100, 100, 50);
    put(&s, 1, 160, 180, 50.4);
    add_column(&s, "s_x", &s.grains.s_x, 0.03);
    add_column(&s, "s_y", &s.grains.s_y, 0.04);
    add_column(&s, "s_radius", &s.grains.s_radius, 0.02);
    check_done(find(&s, NULL, 1));
    double one = 0.02 * 0.02 + pow(0.6 * 0.03, 2) + pow(0.8 * 0.04, 2);
    check_near(s.packing.contacts.s_overlap[0], sqrt(2 * one) * SCALE, 1e-15);
    check_near(s.packing.grains.s_x_ref[0], 0.03 * SCALE, 1e-15); /* one photo: the error of the reference */
    check_near(s.packing.grains.s_x[0], 0, 0);
    setup_free(&s);
}

/* A chain hangs from a held cluster: peeling takes it away link by link, and leaves the cluster. */
static void test_peeling(void **state)
{
    (void)state;
    struct setup s = setup_new(7);
    const double d = 39.9;
    put(&s, 0, 100, 100, 20);
    put(&s, 1, 100 + d, 100, 20);
    put(&s, 2, 100 + d / 2, 100 + d * sqrt(0.75), 20); /* a triangle holds itself */
    for (size_t k = 3; k < 6; k++)
        put(&s, k, 100 + d * (double)(k - 1), 100, 20); /* a chain to its right */
    put(&s, 6, 800, 800, 20);
    check_done(find(&s, NULL, 1));
    for (size_t k = 0; k < 7; k++)
        assert_int_equal(s.packing.grains.flags[k], k < 3 ? 0 : GRAIN_RATTLER);
    setup_free(&s);
}

static int held_by(size_t count, const double degrees[], double mu, struct vec load)
{
    struct hold holds[4] = {{{0, 0}, 0}};
    for (size_t k = 0; k < count; k++)
        holds[k] = (struct hold){vec(cos(degrees[k] * pi / 180), sin(degrees[k] * pi / 180)), mu};
    return grain_is_held(holds, count, load, 0);
}

/* mu = 0.53 is 27.9 degrees: without a load two contacts hold when the chord between them is within that of both
 * normals, so when they are more than 180 - 55.8 = 124.2 degrees apart; under its weight a grain needs one below on
 * either side, or one that is steep enough. */
static void test_what_holds_a_grain(void **state)
{
    (void)state;
    const struct vec none = vec(0, 0), down = vec(0, -1);
    assert_false(held_by(0, NULL, 0.53, none));
    assert_false(held_by(1, (const double[]){0}, 0.53, none));
    assert_true(held_by(2, (const double[]){0, 180}, 0.53, none));
    assert_true(held_by(2, (const double[]){0, 180}, 0, none));
    assert_true(held_by(2, (const double[]){10, 138}, 0.53, none));
    assert_false(held_by(2, (const double[]){10, 130}, 0.53, none));
    assert_false(held_by(2, (const double[]){0, 150}, 0, none));
    assert_true(held_by(3, (const double[]){0, 120, 240}, 0, none));
    assert_false(held_by(3, (const double[]){0, 60, 120}, 0.53, none)); /* all on one side: 120 degrees at most */
    assert_true(held_by(2, (const double[]){225, 315}, 0, down));
    assert_false(held_by(2, (const double[]){45, 135}, 0, down)); /* both above */
    assert_false(held_by(1, (const double[]){250}, 0.53, down));  /* rolls off */
    assert_true(held_by(1, (const double[]){270}, 0.53, down));
    assert_false(held_by(2, (const double[]){200, 250}, 0, down));
    assert_true(held_by(2, (const double[]){200, 250}, NAN, down)); /* friction not known: two hold */
}

/* A bar of grains that only lean against a squeezed column are free, whatever they touch: 0 and 1 are squeezed between
 * the walls, 2 leans on both. */
static void test_leaning_grain_is_a_rattler(void **state)
{
    (void)state;
    struct setup s = setup_new(3);
    s.scene.contact_given = 1;
    s.scene.contact = (struct contact_law){.row = &linear_law, .kn = 1e7, .kt_over_kn = 1, .mu = 0.53};
    put(&s, 0, 300, 139.8, 40);
    put(&s, 1, 300, 219.4, 40);
    put(&s, 2, 300 + 79.8 * sqrt(0.75), 179.6, 40);
    set_frame(&s, 100, 100, 800, 259.2);
    check_done(find(&s, NULL, 1));
    assert_int_equal(s.summary.contacts, 5);
    assert_int_equal(s.packing.grains.flags[0] | s.packing.grains.flags[1], 0);
    assert_int_equal(s.packing.grains.flags[2], GRAIN_RATTLER);
    check_done(contact_indeterminacy(&s.scene, &s.packing, &s.summary));
    /* one contact with friction, two walls without: four unknowns for six equations, of which three can be broken: the
     * sum of forces across, and that of moments, about either end of the column */
    check_near(s.summary.indeterminacy, 1, 0);
    check_near(s.summary.mechanisms, 3 + 3, 0);
    const char *path = FILM_BINARY_DIR "/test_contacts.svg";
    char line[64];
    check_done(overlap_picture(path, &s.summary));
    FILE *file = fopen(path, "r");
    assert_non_null(file);
    assert_true(fgets(line, sizeof line, file) && !strncmp(line, "<?xml", 5));
    assert_true(fgets(line, sizeof line, file) && !strncmp(line, "<svg", 4));
    fclose(file);
    remove(path);
    assert_int_equal(overlap_picture(FILM_BINARY_DIR "/test_contacts.gif", &s.summary), -1); /* another ending */
    assert_int_equal(error_status(), EXIT_INPUT);
    assert_int_equal(access(FILM_BINARY_DIR "/test_contacts.gif", F_OK), -1);
    mkdir(FILM_BINARY_DIR "/folder.svg", 0777); /* not a file: refused, and nothing is left beside it */
    assert_int_equal(overlap_picture(FILM_BINARY_DIR "/folder.svg", &s.summary), -1);
    assert_int_equal(rmdir(FILM_BINARY_DIR "/folder.svg"), 0);
    setup_free(&s);
}

/* Errors of a motion between two photos: the reference photo's noise, half of each variance, is in both and drops out.
 */
static void test_errors_between_two_photos(void **state)
{
    (void)state;
    struct setup first = tracked_pair(0, 0, 0, 0.05, 0, 0), second = tracked_pair(0, 0, 0, 0.02, 0, 0);
    add_column(&first, "s_x", &first.grains.s_x, 0.003);
    add_column(&second, "s_x", &second.grains.s_x, 0.003);
    check_done(find(&first, NULL, 0));
    check_done(find(&second, &first.packing, 0));
    check_near(second.packing.contacts.s_un[0], 0.003 * sqrt(2) * SCALE, 1e-9);
    check_near(second.packing.contacts.s_dun[0], 0.003 * sqrt(2) * SCALE, 1e-9);
    setup_free(&first);
    setup_free(&second);
}

/* Discs of one size, pushed together in pairs at random angles: monodisperse, every second pair 0.3 px apart. */
static void test_monodisperse(void **state)
{
    (void)state;
    enum { PAIRS = 200 };
    uint64_t seed = 5;
    struct setup s = setup_new(2 * PAIRS);
    for (size_t k = 0; k < PAIRS; k++) {
        double a = 2 * pi * check_uniform(&seed), d = 40 + (k % 2 ? 0.3 : -0.3), x = 200 * (double)(k % 20);
        put(&s, 2 * k, x, 200 * (double)(k / 20), 20);
        put(&s, 2 * k + 1, x + d * cos(a), 200 * (double)(k / 20) + d * sin(a), 20);
    }
    add_column(&s, "s_radius", &s.grains.s_radius, 0.02);
    check_done(find(&s, NULL, 1));
    assert_int_equal(s.summary.contacts, PAIRS / 2);
    for (size_t c = 0; c < s.packing.contacts.count; c++)
        if (!(s.packing.contacts.flags[c] & CONTACT_CANDIDATE))
            assert_int_equal(s.packing.contacts.i[c] / 2 % 2, 0);
    setup_free(&s);
}

/* A heavy grain lies in the groove between two fixed walls' worth of others; one of its contacts looks open by 3
 * standard errors. Without repair it floats, with repair it stands. */
static void test_repair(void **state)
{
    (void)state;
    for (int repair = 0; repair < 2; repair++) {
        struct setup s = setup_new(4);
        s.scene.gravity = vec(0, -9.81);
        s.scene.grains.density = 730;
        s.options.repair = repair;
        s.options.tolerance_px = 0; /* a plain threshold, so that the open one is a candidate */
        set_frame(&s, 0, 0, 198.4, 400);
        put(&s, 0, 49.8, 49.8, 50);  /* in the left corner: bottom and left wall */
        put(&s, 1, 148.6, 49.8, 50); /* in the right corner */
        put(&s, 2, 99.2, 49.8 + sqrt(100 * 100 - 49.4 * 49.4) + 0.05, 50); /* on top, open on either side */
        put(&s, 3, 99.2, 300, 50);                                         /* in the air: nothing can help it */
        add_column(&s, "s_radius", &s.grains.s_radius, 0.02);
        check_done(find(&s, NULL, 1));
        assert_int_equal(s.packing.grains.flags[2], repair ? 0 : GRAIN_RATTLER | GRAIN_FLOATING);
        assert_int_equal(s.packing.grains.flags[3], GRAIN_RATTLER | GRAIN_FLOATING);
        assert_int_equal(s.summary.promoted, repair ? 2 : 0);
        uint32_t flags = s.packing.contacts.flags[row_of(&s, 0, 2)];
        assert_int_equal(flags, repair ? CONTACT_PROMOTED : CONTACT_CANDIDATE);
        setup_free(&s);
    }
}

/* Barrel distortion of 3 px at the corner, undone for grains as seen and for the frame; not for what the tracker
 * corrected. */
static void test_lens(void **state)
{
    (void)state;
    const struct lens lens = {.centre = {500, 500}, .k = {-8e-9, 0, 0}};
    struct setup s = setup_new(2);
    const double x[] = {900, 979.5}, up[] = {900, 900};
    for (size_t k = 0; k < 2; k++) {
        struct vec seen = lens_seen(&lens, vec(x[k], HEIGHT - up[k]));
        double j[2][2];
        lens_jacobian(&lens, seen, j);
        put(&s, k, seen.x, HEIGHT - seen.y, 40 / sqrt(j[0][0] * j[1][1] - j[0][1] * j[1][0]));
    }
    set_frame(&s, 0, 0, 1000, 1000);
    for (int k = 0; k < 4; k++)
        s.scene.frame.corners_px[k] = lens_seen(&lens, s.scene.frame.corners_px[k]);
    s.input =
        (struct contact_input){.scene = &s.scene, .grains = &s.grains, .lens = &lens, .seen = 1, .is_reference = 1};
    check_done(find_contacts(&s.input, &s.options, &s.packing, NULL));
    for (size_t k = 0; k < 2; k++) {
        check_near(s.packing.grains.x[k], x[k] * SCALE, 1e-9 * SCALE);
        check_near(s.packing.grains.y[k], up[k] * SCALE, 1e-9 * SCALE);
        check_near(s.packing.grains.radius[k], 40 * SCALE, 1e-9 * SCALE);
    }
    check_near(s.packing.contacts.overlap[row_of(&s, 0, 1)], 0.5 * SCALE, 1e-8 * SCALE);
    check_near(s.packing.walls.x0[2], 1000 * SCALE, 1e-8 * SCALE); /* the top begins at the right */
    check_near(s.packing.walls.y0[2], 1000 * SCALE, 1e-8 * SCALE);
    double seen_px = s.grains.x_px[0];
    packing_free(&s.packing);
    s.input.seen = 0;
    check_done(find_contacts(&s.input, &s.options, &s.packing, NULL));
    check_near(s.packing.grains.x[0], seen_px * SCALE, 1e-12);
    setup_free(&s);
}

/* The same radii from three photos, one of them flagged: the mean of the good ones, and their error. */
static void test_radii_from_several_photos(void **state)
{
    (void)state;
    struct setup s = setup_new(2), more[2] = {setup_new(2), setup_new(2)};
    struct setup *all[] = {&s, &more[0], &more[1]};
    const double radii[] = {50, 50.03, 60};
    for (int m = 0; m < 3; m++) {
        add_column(all[m], "s_radius", &all[m]->grains.s_radius, 0.02);
        put(all[m], 0, 100, 100, radii[m]);
        put(all[m], 1, 200, 100, 50);
    }
    more[1].grains.flags[0] = GRAIN_WEAK_EDGE;
    const struct photo_grains *photos[] = {&more[0].grains, &more[1].grains};
    s.input = (struct contact_input){
        .scene = &s.scene, .grains = &s.grains, .more_radii = photos, .more_count = 2, .is_reference = 1};
    check_done(find_contacts(&s.input, &s.options, &s.packing, NULL));
    check_near(s.packing.grains.radius[0], 50.015 * SCALE, 1e-14);
    double scatter = 2 * pow(0.015 / 0.02, 2); /* chi2 of two measurements, over n - 1 */
    check_near(s.packing.grains.s_radius[0], 0.02 / sqrt(2) * sqrt(fmax(1, scatter)) * SCALE, 1e-14);
    check_near(s.packing.grains.s_radius[1], 0.02 / sqrt(3) * SCALE, 1e-14);
    for (int m = 0; m < 3; m++)
        setup_free(all[m]);
}

/* A contact that opens and is still near keeps its row, flagged; one that closes is new. */
static void test_opening_and_closing(void **state)
{
    (void)state;
    struct setup shut = setup_new(2), open = setup_new(2);
    put(&shut, 0, 100, 100, 50);
    put(&shut, 1, 199.5, 100, 50);
    put(&open, 0, 100, 100, 50);
    put(&open, 1, 200.2, 100, 50);
    for (int k = 0; k < 2; k++)
        add_column(k ? &open : &shut, "s_radius", k ? &open.grains.s_radius : &shut.grains.s_radius, 0.1);
    shut.options.tolerance_px = open.options.tolerance_px = 0;
    check_done(find(&shut, NULL, 1));
    check_done(find(&open, &shut.packing, 1));
    assert_int_equal(open.packing.contacts.flags[0], CONTACT_CANDIDATE | CONTACT_OPENED);
    check_near(open.packing.contacts.dun[0], 0.7 * SCALE, 1e-12);
    check_done(find(&shut, &open.packing, 1));
    assert_int_equal(shut.packing.contacts.flags[0], CONTACT_NEW);
    assert_true(isnan(shut.packing.contacts.dun[0]));
    setup_free(&shut);
    setup_free(&open);
}

/* A square lattice of grains whose neighbours overlap exponentially (mean 0.2 px) or, one pair in eight, are up to
 * 1 px apart. Rows and columns are independent chains, so that every overlap can be chosen; radii are then seen with an
 * error of 0.02 px and too large or too small by `offset`. */
static struct setup lattice_seen(size_t side, double offset, double factor, uint64_t *seed)
{
    struct setup s = setup_new(side * side);
    add_column(&s, "s_radius", &s.grains.s_radius, 0.02);
    const double r = 30;
    for (size_t row = 0; row < side; row++) {
        double x = 0;
        for (size_t column = 0; column < side; column++) {
            put(&s, row * side + column, x, 90 * (double)row, factor * r + offset + 0.02 * check_normal(seed));
            double overlap = check_uniform(seed) < 0.125 ? -check_uniform(seed) : -0.2 * log(1 - check_uniform(seed));
            x += 2 * r - overlap;
        }
    }
    return s;
}

static void test_automatic_radius_offset(void **state)
{
    (void)state;
    uint64_t seed = 11;
    const double offsets[] = {-0.8, -0.3, 0, 0.3};
    double squares = 0;
    for (size_t k = 0; k < 4; k++) {
        struct setup s = lattice_seen(30, offsets[k], 1, &seed);
        s.options.radius_offset_auto = 1;
        check_done(find(&s, NULL, 1));
        assert_null(s.summary.undecided);
        check_near(s.summary.radius_offset_px, -offsets[k], 0.02);
        check_at_most(s.summary.s_radius_offset_px, 0.015); /* 5 % of the mean overlap, and the scatter */
        squares += pow((s.summary.radius_offset_px + offsets[k]) / s.summary.s_radius_offset_px, 2);
        setup_free(&s);
    }
    check_at_most(sqrt(squares / 4), 2);
    struct setup s = lattice_seen(30, 0, 0.995, &seed);
    s.options.radius_scale_auto = 1;
    check_done(find(&s, NULL, 1));
    check_near(s.summary.radius_scale, 1 / 0.995, 3e-4);
    s.options.radius_offset_auto = 1; /* both: refused */
    assert_int_equal(find(&s, NULL, 1), -1);
    assert_int_equal(error_status(), EXIT_INPUT);
    setup_free(&s);
}

/* Nothing to see: too few pairs, no pile-up. The radii stay as they are. */
static void test_automatic_offset_says_when_it_cannot_tell(void **state)
{
    (void)state;
    uint64_t seed = 12;
    struct setup s = lattice_seen(5, 0.3, 1, &seed);
    s.options.radius_offset_auto = 1;
    check_done(find(&s, NULL, 1));
    assert_non_null(s.summary.undecided);
    check_near(s.summary.radius_offset_px, 0, 0);
    setup_free(&s);
    s = setup_new(400); /* loose grains, gaps spread evenly over 12 px */
    for (size_t k = 0; k < 400; k++)
        put(&s, k, k % 2 ? 60.2 + 12 * check_uniform(&seed) : 0, 100 * (double)(k / 2), 30);
    add_column(&s, "s_radius", &s.grains.s_radius, 0.02);
    s.options.radius_offset_auto = 1;
    check_done(find(&s, NULL, 1));
    assert_non_null(s.summary.undecided);
    check_near(s.summary.radius_offset_px, 0, 0);
    setup_free(&s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_two_grains),
        cmocka_unit_test(test_one_grain_and_no_contact),
        cmocka_unit_test(test_radius_correction),
        cmocka_unit_test(test_square_lattice_with_walls),
        cmocka_unit_test(test_fabric_in_the_file),
        cmocka_unit_test(test_hexagonal_crystal),
        cmocka_unit_test(test_two_walls_and_a_corner_disc),
        cmocka_unit_test(test_ratio_of_twenty),
        cmocka_unit_test(test_identical_centres_are_refused),
        cmocka_unit_test(test_missing_errors_are_flagged),
        cmocka_unit_test(test_missing_numbers_are_flagged),
        cmocka_unit_test(test_no_scale_is_refused),
        cmocka_unit_test(test_mass_and_weight),
        cmocka_unit_test(test_motion_since_the_reference),
        cmocka_unit_test(test_motion_since_the_previous),
        cmocka_unit_test(test_elliptic_rims),
        cmocka_unit_test(test_error_of_an_overlap),
        cmocka_unit_test(test_peeling),
        cmocka_unit_test(test_what_holds_a_grain),
        cmocka_unit_test(test_leaning_grain_is_a_rattler),
        cmocka_unit_test(test_errors_between_two_photos),
        cmocka_unit_test(test_monodisperse),
        cmocka_unit_test(test_repair),
        cmocka_unit_test(test_lens),
        cmocka_unit_test(test_radii_from_several_photos),
        cmocka_unit_test(test_opening_and_closing),
        cmocka_unit_test(test_automatic_radius_offset),
        cmocka_unit_test(test_automatic_offset_says_when_it_cannot_tell),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
