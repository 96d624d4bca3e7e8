/* z, the fabric and the degree of force indeterminacy against their definitions: h is what the rank of the matrix of
 * equilibrium says, whatever walls, rattlers, friction and mechanisms there are. */
#include "tests/rank_by_hand.h"

#include "pipeline/numbers/random.h"
#include "pipeline/packing/structure.h"

enum { SIDE = 9, COUNT = SIDE * SIDE, WALLS_AND_DISCS = 8 };
#define RADIUS 0.005
#define BOX (2 * RADIUS * SIDE)

static const char *const NAMES[WALLS_AND_DISCS] = {"bottom",      "right",        "top",       "left",
                                                   "bottom-left", "bottom-right", "top-right", "top-left"};

static void add_contact(struct packing *p, size_t i, size_t j, double nx, double ny, double x, double y)
{
    size_t c = p->contacts.count++;
    double norm = hypot(nx, ny);
    p->contacts.i[c] = (int64_t)i, p->contacts.j[c] = (int64_t)j;
    p->contacts.nx[c] = nx / norm, p->contacts.ny[c] = ny / norm;
    p->contacts.x[c] = x, p->contacts.y[c] = y;
    p->contacts.overlap[c] = 0;
    p->contacts.flags[c] = 0;
}

static void set_walls(struct packing *p, size_t walls)
{
    static const double at[4][4] = {{0, 0, 1, 0}, {1, 0, 1, 1}, {1, 1, 0, 1}, {0, 1, 0, 0}};
    check_done(table_alloc(&WALLS, &p->walls, walls, NULL));
    for (size_t w = 0; w < walls; w++) {
        strcpy(p->walls.name[w], NAMES[w]);
        p->walls.x0[w] = BOX * at[w % 4][0], p->walls.y0[w] = BOX * at[w % 4][1];
        p->walls.x1[w] = BOX * at[w % 4][2], p->walls.y1[w] = BOX * at[w % 4][3];
        p->walls.radius[w] = w < 4 ? 0 : RADIUS;
        p->walls.fx[w] = p->walls.fy[w] = NAN;
    }
}

/* A lattice of discs that is shaken, so that nothing lines up; `density` of the contacts between neighbours are there.
 * Eight walls: corner discs that the grains in the corners touch. */
static struct packing make(uint64_t seed, double density, size_t walls)
{
    struct packing p = {.length_m = NAN};
    uint64_t draw = 0;
    check_done(table_alloc(&GRAINS, &p.grains, COUNT, NULL));
    check_done(table_alloc(&CONTACTS, &p.contacts, 4 * COUNT + 8, NULL));
    p.contacts.count = 0;
    set_walls(&p, walls);
    for (size_t k = 0; k < COUNT; k++) {
        p.grains.x[k] = RADIUS * (1 + 2 * (double)(k % SIDE) + 0.4 * (random_uniform(seed, draw++) - 0.5));
        p.grains.y[k] = RADIUS * (1 + 2 * (double)(k / SIDE) + 0.4 * (random_uniform(seed, draw++) - 0.5));
        p.grains.radius[k] = RADIUS * (0.9 + 0.2 * random_uniform(seed, draw++));
        p.grains.mass[k] = p.grains.inertia[k] = 1;
        p.grains.flags[k] = 0;
    }
    for (size_t k = 0; k < COUNT; k++) {
        const size_t next[3] = {k + 1, k + SIDE, k + SIDE + 1};
        double x = p.grains.x[k], y = p.grains.y[k], r = p.grains.radius[k];
        for (int e = 0; e < 3; e++) {
            if (next[e] >= COUNT || (e != 1 && k % SIDE == SIDE - 1) || random_uniform(seed, draw++) > density)
                continue;
            double dx = p.grains.x[next[e]] - x, dy = p.grains.y[next[e]] - y;
            add_contact(&p, k, next[e], dx, dy, x + 0.5 * dx, y + 0.5 * dy);
        }
        if (walls && k < SIDE)
            add_contact(&p, k, COUNT, 0, -1, x, y - r);
        if (walls && k % SIDE == SIDE - 1)
            add_contact(&p, k, COUNT + 1, 1, 0, x + r, y);
        if (walls && k >= COUNT - SIDE)
            add_contact(&p, k, COUNT + 2, 0, 1, x, y + r);
        if (walls && k % SIDE == 0)
            add_contact(&p, k, COUNT + 3, -1, 0, x - r, y);
    }
    const size_t corner[4] = {0, SIDE - 1, COUNT - 1, COUNT - SIDE};
    for (size_t w = 4; w < walls; w++) {
        size_t k = corner[w - 4];
        double nx = w == 4 || w == 7 ? -0.8 : 0.8, ny = w < 6 ? -0.6 : 0.6;
        add_contact(&p, k, COUNT + w, nx, ny, p.grains.x[k] + RADIUS * nx, p.grains.y[k] + RADIUS * ny);
    }
    return p;
}

static void load(struct packing *p, int bottom, int right, int top, int left)
{
    p->walls.fy[0] = bottom ? 1 : NAN, p->walls.fx[1] = right ? -1 : NAN;
    p->walls.fy[2] = top ? -1 : NAN, p->walls.fx[3] = left ? 1 : NAN;
}

static void check_h(const struct packing *p, double mu, double mu_wall)
{
    struct indeterminacy found;
    double equations, h = h_by_hand(p, mu, mu_wall, &equations), rattlers = 0, unknowns = 0;
    check_done(packing_indeterminacy(p, mu, mu_wall, &found));
    assert_true(found.known);
    check_near(found.h, h, 0);
    for (size_t k = 0; k < p->grains.count; k++)
        rattlers += (p->grains.flags[k] & GRAIN_RATTLER) != 0;
    for (size_t c = 0; c < p->contacts.count; c++) {
        size_t i = (size_t)p->contacts.i[c], j = (size_t)p->contacts.j[c];
        int wall = j >= p->grains.count;
        if (!(p->contacts.flags[c] & CONTACT_CANDIDATE) && carries_by_hand(p, i) && (wall || carries_by_hand(p, j)))
            unknowns += (wall ? mu_wall : mu) == 0 ? 1 : 2;
    }
    check_near(found.mechanisms, h - unknowns + equations + 3 * rattlers, 0); /* h = Nu + k - Nf */
}

static void walls_rough_smooth_and_loaded(void **state)
{
    (void)state;
    for (uint64_t seed = 1; seed < 4; seed++)
        for (int loads = 0; loads < 16; loads += 3) {
            struct packing p = make(seed, 0.8, 4);
            load(&p, loads & 1, loads & 2, loads & 4, loads & 8);
            check_h(&p, 0.5, 0.3);
            check_h(&p, 0.5, 0);
            check_h(&p, 0, 0); /* every grain can turn */
            check_h(&p, 0, 0.3);
            packing_free(&p);
        }
}

static void corner_discs_bear_on_two_walls(void **state)
{
    (void)state;
    for (uint64_t seed = 1; seed < 4; seed++) {
        struct packing p = make(seed, 0.7, 8);
        load(&p, 0, 1, 1, 0);
        check_h(&p, 0.5, 0.5);
        check_h(&p, 0.5, 0);
        load(&p, 1, 1, 1, 1);
        check_h(&p, 0.5, 0);
        packing_free(&p);
    }
}

/* Loose: chains and loops that give way. Nothing around them: three motions of the whole, too. */
static void mechanisms_are_counted(void **state)
{
    (void)state;
    for (uint64_t seed = 1; seed < 9; seed++) {
        struct packing p = make(seed, 0.25 + 0.05 * (double)seed, 4), free = make(seed, 0.9, 0);
        load(&p, 0, 1, 1, 0);
        check_h(&p, 0.5, 0.3);
        check_h(&p, 0.5, 0);
        check_h(&free, 0.5, 0.5);
        packing_free(&p);
        packing_free(&free);
    }
}

static void rattlers_candidates_and_fixed_grains(void **state)
{
    (void)state;
    for (uint64_t seed = 1; seed < 5; seed++) {
        struct packing p = make(seed, 0.9, 4);
        load(&p, 0, 1, 1, 0);
        for (size_t k = 0; k < COUNT; k += 5)
            p.grains.flags[k] = k % 2 ? GRAIN_RATTLER : k % 4 ? GRAIN_FIXED : GRAIN_LOW_ZNCC;
        for (size_t c = 0; c < p.contacts.count; c += 7)
            p.contacts.flags[c] = CONTACT_CANDIDATE;
        check_h(&p, 0.5, 0);
        check_h(&p, 0.5, 0.5);
        packing_free(&p);
    }
}

/* Two grains that touch each other and the bottom: three contacts, of which two are with a wall; z = (2 3 - 2) / 2. */
static void z_counts_a_wall_contact_once(void **state)
{
    (void)state;
    struct packing p = make(1, 0, 4);
    struct fabric fabric;
    p.grains.count = 2;
    p.contacts.count = 0;
    add_contact(&p, 0, 1, 1, 0, 0, 0);
    add_contact(&p, 0, 2, 0, -1, 0, 0);
    add_contact(&p, 1, 2, 0, -1, 0, 0);
    packing_fabric(&p, 4 * M_PI * RADIUS * RADIUS, &fabric);
    check_near(fabric.z, 2, 1e-15);
    check_near(fabric.tensor[0][0], 1 / 3., 1e-15);
    check_near(fabric.tensor[1][1], 2 / 3., 1e-15);
    p.grains.radius[0] = p.grains.radius[1] = RADIUS;
    packing_fabric(&p, 4 * M_PI * RADIUS * RADIUS, &fabric);
    check_near(fabric.solid, 0.5, 1e-15);
    check_near(fabric.void_ratio, 1, 1e-14);
    p.grains.count = COUNT;
    packing_free(&p);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(walls_rough_smooth_and_loaded), cmocka_unit_test(corner_discs_bear_on_two_walls),
        cmocka_unit_test(mechanisms_are_counted),        cmocka_unit_test(rattlers_candidates_and_fixed_grains),
        cmocka_unit_test(z_counts_a_wall_contact_once),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
