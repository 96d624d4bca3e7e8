/* Stress of packings whose forces are known by construction. */
#include "tests/check.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "pipeline/packing/stress.h"
#include "pipeline/packing/structure.h"

static double area_of(const struct packing *packing)
{
    double area;
    check_done(packing_area(packing, &area));
    return area;
}

enum { SIDE = 6, GRAINS_COUNT = SIDE * SIDE };
static const double R = 0.01, LENGTH = 0.06;

static void add_contact(struct packing *p, size_t *c, int64_t i, int64_t j, double nx, double ny)
{
    p->contacts.i[*c] = i;
    p->contacts.j[*c] = j;
    p->contacts.nx[*c] = nx;
    p->contacts.ny[*c] = ny;
    p->contacts.x[*c] = p->grains.x[i] + R * nx;
    p->contacts.y[*c] = p->grains.y[i] + R * ny;
    (*c)++;
}

static void set_wall(struct walls *walls, size_t w, const char *name, double x0, double y0, double x1, double y1)
{
    strcpy(walls->name[w], name);
    walls->x0[w] = x0;
    walls->y0[w] = y0;
    walls->x1[w] = x1;
    walls->y1[w] = y1;
    walls->radius[w] = 0;
}

/* A square lattice of touching discs far from the origin, inside four walls that touch it. */
static void make_lattice(struct packing *p)
{
    const double x0 = 3, y0 = -2, a = 2 * R, L = SIDE * a;
    size_t c = 0;
    memset(p, 0, sizeof *p);
    p->length_m = LENGTH;
    check_done(table_alloc(&GRAINS, &p->grains, GRAINS_COUNT, NULL));
    check_done(table_alloc(&WALLS, &p->walls, 4, NULL));
    check_done(table_alloc(&CONTACTS, &p->contacts, 2 * SIDE * (SIDE - 1) + 4 * SIDE, NULL));
    for (int k = 0; k < GRAINS_COUNT; k++) {
        p->grains.x[k] = x0 + R + a * (k % SIDE);
        p->grains.y[k] = y0 + R + a * (k / SIDE);
        p->grains.radius[k] = R;
    }
    set_wall(&p->walls, 0, "bottom", x0, y0, x0 + L, y0);
    set_wall(&p->walls, 1, "right", x0 + L, y0, x0 + L, y0 + L);
    set_wall(&p->walls, 2, "top", x0 + L, y0 + L, x0, y0 + L);
    set_wall(&p->walls, 3, "left", x0, y0 + L, x0, y0);
    for (int k = 0; k < GRAINS_COUNT; k++) {
        if (k % SIDE < SIDE - 1)
            add_contact(p, &c, k, k + 1, 1, 0);
        if (k / SIDE < SIDE - 1)
            add_contact(p, &c, k, k + SIDE, 0, 1);
    }
    for (int s = 0; s < SIDE; s++) {
        add_contact(p, &c, s, GRAINS_COUNT, 0, -1);
        add_contact(p, &c, s * SIDE + SIDE - 1, GRAINS_COUNT + 1, 1, 0);
        add_contact(p, &c, (SIDE - 1) * SIDE + s, GRAINS_COUNT + 2, 0, 1);
        add_contact(p, &c, s * SIDE, GRAINS_COUNT + 3, -1, 0);
    }
    assert_int_equal(c, p->contacts.count);
}

/* Every horizontal contact carries 3 N and every vertical one 5 N: sigma = force / (2 R length). */
static void test_weber_square_lattice(void **unused)
{
    (void)unused;
    struct packing p;
    double fn[200], ft[200] = {0}, sigma[2][2];
    make_lattice(&p);
    for (size_t c = 0; c < p.contacts.count; c++)
        fn[c] = p.contacts.nx[c] != 0 ? 3 : 5;
    check_near(area_of(&p), SIDE * SIDE * 4 * R * R, 1e-15);
    stress_weber(&p, fn, ft, area_of(&p), sigma);
    check_near(sigma[0][0], 3 / (2 * R * LENGTH), 1e-9 * 2500);
    check_near(sigma[1][1], 5 / (2 * R * LENGTH), 1e-9 * 4200);
    check_near(sigma[0][1], 0, 1e-9 * 2500);
    check_near(sigma[1][0], 0, 1e-9 * 2500);
    p.length_m = NAN; /* per metre of depth */
    stress_weber(&p, fn, ft, area_of(&p), sigma);
    check_near(sigma[0][0], 3 / (2 * R), 1e-9 * 150);
    fn[7] = NAN; /* left out */
    stress_weber(&p, fn, ft, area_of(&p), sigma);
    check_at_most(sigma[0][0] + sigma[1][1], 8 / (2 * R) - 1);
    stress_weber(&p, fn, ft, NAN, sigma);
    assert_true(isnan(sigma[0][0]) && isnan(sigma[1][0]));
    packing_free(&p);
}

/* One contact with a tangential force: sigma_ab = (fn n + ft t)_a l_b / A, written out by hand. */
static void test_weber_one_contact(void **unused)
{
    (void)unused;
    struct packing p = {.length_m = NAN};
    double fn = 7, ft = -2, sigma[2][2];
    check_done(table_alloc(&GRAINS, &p.grains, 2, NULL));
    check_done(table_alloc(&CONTACTS, &p.contacts, 1, NULL));
    p.grains.x[0] = 1, p.grains.y[0] = 1, p.grains.x[1] = 1.3, p.grains.y[1] = 1.4;
    p.contacts.j[0] = 1;
    p.contacts.nx[0] = 0.6, p.contacts.ny[0] = 0.8;
    stress_weber(&p, &fn, &ft, 2, sigma);
    double fx = 7 * 0.6 + -2 * -0.8, fy = 7 * 0.8 + -2 * 0.6; /* t = (-0.8, 0.6) */
    check_near(sigma[0][0], fx * 0.3 / 2, 1e-14);
    check_near(sigma[0][1], fx * 0.4 / 2, 1e-14);
    check_near(sigma[1][0], fy * 0.3 / 2, 1e-14);
    check_near(sigma[1][1], fy * 0.4 / 2, 1e-14);
    packing_free(&p);
}

static void load_walls(struct packing *p, double x, double y)
{
    const double fx[4] = {0, -x, 0, x}, fy[4] = {y, 0, -y, 0};
    memcpy(p->walls.fx, fx, sizeof fx);
    memcpy(p->walls.fy, fy, sizeof fy);
}

static void assert_box(const struct packing *p, double x, double y)
{
    double sigma[2][2];
    stress_applied(p, area_of(p), sigma);
    if (isnan(x))
        assert_true(isnan(sigma[0][0]));
    else
        check_near(sigma[0][0], x, 1e-9 * 2500);
    if (isnan(y))
        assert_true(isnan(sigma[1][1]));
    else
        check_near(sigma[1][1], y, 1e-9 * 4200);
    if (!isnan(x) && !isnan(y))
        check_near(sigma[0][1], 0, 1e-9 * 2500);
}

/* The walls of the lattice carry SIDE forces each; the stress that they apply is Weber's. */
static void test_applied(void **unused)
{
    (void)unused;
    struct packing p;
    make_lattice(&p);
    double x = 3 / (2 * R * LENGTH), y = 5 / (2 * R * LENGTH);
    load_walls(&p, 3 * SIDE, 5 * SIDE);
    assert_box(&p, x, y);
    p.walls.fx[0] = NAN; /* along a wall: no load */
    assert_box(&p, x, y);
    p.walls.fx[3] = p.walls.fy[3] = p.walls.fx[0] = p.walls.fy[0] = NAN; /* left and bottom react */
    assert_box(&p, x, y);
    p.walls.fx[1] = NAN; /* an oedometer: the side walls are fixed */
    assert_box(&p, NAN, y);
    p.walls.fy[2] = NAN;
    assert_box(&p, NAN, NAN);
    packing_free(&p);
    make_lattice(&p);
    p.walls.count = 0;
    assert_box(&p, NAN, NAN);
    p.walls.count = 4;
    packing_free(&p);
}

/* Overlaps of 3 and 5 N at kn, walls that carry just that; then a stiffness, a list of contacts and loads that are
 * wrong. */
static void test_overlaps_over_loads(void **unused)
{
    (void)unused;
    struct packing p;
    const double kn = 1e5;
    make_lattice(&p);
    load_walls(&p, 3 * SIDE, 5 * SIDE);
    for (size_t c = 0; c < p.contacts.count; c++)
        p.contacts.overlap[c] = (fabs(p.contacts.nx[c]) > 0.5 ? 3 : 5) / kn;
    check_near(stress_overlaps_over_loads(&p, kn), 1, 1e-12);
    check_near(stress_overlaps_over_loads(&p, 2 * kn), 2, 1e-12);
    p.length_m = NAN; /* forces do not need it */
    check_near(stress_overlaps_over_loads(&p, kn), 1, 1e-12);
    for (size_t c = 0; c < p.contacts.count; c++)
        p.contacts.flags[c] |= CONTACT_CANDIDATE;
    check_near(stress_overlaps_over_loads(&p, kn), 0, 0);
    load_walls(&p, NAN, NAN);
    assert_true(isnan(stress_overlaps_over_loads(&p, kn)));
    packing_free(&p);
}

/* Gravity g per grain on a lattice that carries itself: a contact under k rows bears k g, the top wall nothing.
 * The applied stress is the sum of contact forces times branches, done by hand. */
static void test_applied_gravity(void **unused)
{
    (void)unused;
    struct packing p;
    make_lattice(&p);
    const double g = 0.25;
    double fn[200] = {0}, ft[200] = {0}, weber[2][2], applied[2][2], by_hand = 0;
    for (size_t k = 0; k < GRAINS_COUNT; k++) {
        p.grains.load_x[k] = 0;
        p.grains.load_y[k] = -g;
    }
    for (size_t c = 0; c < p.contacts.count; c++) {
        size_t row = (size_t)p.contacts.i[c] / SIDE;
        if (p.contacts.ny[c] > 0 && p.contacts.j[c] < GRAINS_COUNT)
            fn[c] = (double)(SIDE - 1 - row) * g, by_hand += fn[c] * 2 * R;
        else if (p.contacts.ny[c] < 0)
            fn[c] = SIDE * g, by_hand += fn[c] * R;
    }
    load_walls(&p, 0, 0);
    p.walls.fy[0] = NAN;
    stress_weber(&p, fn, ft, area_of(&p), weber);
    stress_applied(&p, area_of(&p), applied);
    by_hand /= area_of(&p) * LENGTH;
    check_near(weber[1][1], by_hand, 1e-9 * by_hand);
    check_near(applied[1][1], by_hand, 1e-9 * by_hand);
    packing_free(&p);
}

/* Weights of the top row alone: what they carry downwards crosses every row. (Uniform weights have no moment about the
 * middle: they would not tell whether their places are seen.) */
static void test_applied_weights_above(void **unused)
{
    (void)unused;
    struct packing p;
    make_lattice(&p);
    const double g = 0.25, across = 0.1;
    double applied[2][2], volume = area_of(&p) * LENGTH, by_hand = SIDE * g * (SIDE - 0.5) * 2 * R / volume;
    for (size_t k = 0; k < GRAINS_COUNT; k++)
        p.grains.load_x[k] = p.grains.load_y[k] = 0;
    for (int s = 0; s < SIDE; s++)
        p.grains.load_y[(SIDE - 1) * SIDE + s] = -g;
    load_walls(&p, 0, 0);
    p.walls.fy[0] = NAN; /* the bottom bears them */
    stress_applied(&p, area_of(&p), applied);
    check_near(applied[1][1], by_hand, 1e-9 * by_hand);
    check_near(applied[0][0], 0, 1e-9 * by_hand);
    for (int s = 0; s < SIDE; s++)
        p.grains.load_x[s * SIDE] = across; /* the left column is pushed towards the right wall */
    p.walls.fx[1] = NAN;
    stress_applied(&p, area_of(&p), applied);
    by_hand = SIDE * across * (SIDE - 0.5) * 2 * R / volume;
    check_near(applied[0][0], by_hand, 1e-9 * by_hand);
    packing_free(&p);
}

/* Without walls: the hull of one disc is the disc; of two, a stadium. */
static void test_hull(void **unused)
{
    (void)unused;
    struct packing p = {.length_m = NAN};
    check_done(table_alloc(&GRAINS, &p.grains, 3, NULL));
    p.grains.count = 1;
    p.grains.x[0] = 100, p.grains.y[0] = 50, p.grains.radius[0] = 2;
    check_near(area_of(&p), M_PI * 4, 1e-9);
    p.grains.count = 2;
    p.grains.x[1] = 103, p.grains.y[1] = 50, p.grains.radius[1] = 2;
    check_near(area_of(&p), M_PI * 4 + 3 * 4, 0.01); /* 64 corners: the sides of the stadium are 1e-3 too high */
    p.grains.count = 3;                              /* a lost grain does not spoil it */
    check_near(area_of(&p), M_PI * 4 + 3 * 4, 0.01);
    p.grains.count = 0;
    assert_true(isnan(area_of(&p)));
    p.grains.count = 3;
    packing_free(&p);
}

static void test_fabric(void **unused)
{
    (void)unused;
    struct packing p;
    struct fabric fabric;
    make_lattice(&p);
    p.grains.flags[3] = GRAIN_RATTLER;
    p.contacts.flags[0] = CONTACT_CANDIDATE; /* horizontal */
    packing_fabric(&p, area_of(&p), &fabric);
    assert_int_equal(fabric.contacts, 83);
    assert_int_equal(fabric.wall_contacts, 24);
    assert_int_equal(fabric.rattlers, 1);
    check_near(fabric.z, (2.0 * 59 + 24) / 36, 1e-12);
    check_near(fabric.solid, M_PI / 4, 1e-12);
    check_near(fabric.void_ratio, 4 / M_PI - 1, 1e-12);
    check_near(fabric.tensor[0][0], 41.0 / 83, 1e-12);
    check_near(fabric.tensor[1][1], 42.0 / 83, 1e-12);
    check_near(fabric.tensor[0][1], 0, 1e-12);
    packing_free(&p);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_weber_square_lattice),
        cmocka_unit_test(test_weber_one_contact),
        cmocka_unit_test(test_applied),
        cmocka_unit_test(test_applied_gravity),
        cmocka_unit_test(test_applied_weights_above),
        cmocka_unit_test(test_overlaps_over_loads),
        cmocka_unit_test(test_hull),
        cmocka_unit_test(test_fabric),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
