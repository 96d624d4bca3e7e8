/* One verdict with its reasons: two discs of radius 1 m, one on the other in a box that fits them, in equilibrium by
 * hand under V = 100 N from above and 2 H = 120 N from the side; then one thing is wrong at a time. */
#include "tests/check.h"
#include "tests/touch.h"

#include <stdlib.h>
#include <string.h>

#include "pipeline/packing/verdict.h"

enum { BOTTOM, TOP, LEFT, RIGHT, PAIRS = 7 };
static const double V = 100, H = 60;

static void make(struct packing *p)
{
    static const int64_t i[] = {0, 0, 1, 0, 1, 0, 1}, j[] = {1, 2, 3, 4, 4, 5, 5};
    static const char *const names[] = {"bottom", "top", "left", "right"};
    static const double ends[4][4] = {{-1, 0, 1, 0}, {1, 4, -1, 4}, {-1, 4, -1, 0}, {1, 0, 1, 4}};
    static const double loads[4][2] = {{0, 100}, {0, -100}, {120, 0}, {-120, 0}};
    memset(p, 0, sizeof *p);
    p->length_m = NAN;
    check_done(table_alloc(&GRAINS, &p->grains, 2, NULL));
    check_done(table_alloc(&WALLS, &p->walls, 4, NULL));
    check_done(table_alloc(&CONTACTS, &p->contacts, PAIRS, NULL));
    for (int k = 0; k < 2; k++)
        p->grains.x[k] = 0, p->grains.y[k] = 1 + 2 * k, p->grains.radius[k] = p->grains.mass[k] = 1;
    for (int w = 0; w < 4; w++) {
        strcpy(p->walls.name[w], names[w]);
        p->walls.x0[w] = ends[w][0], p->walls.y0[w] = ends[w][1];
        p->walls.x1[w] = ends[w][2], p->walls.y1[w] = ends[w][3], p->walls.radius[w] = 0;
        p->walls.fx[w] = loads[w][0], p->walls.fy[w] = loads[w][1];
    }
    for (int c = 0; c < PAIRS; c++)
        p->contacts.i[c] = i[c], p->contacts.j[c] = j[c];
    touch(p);
    p->forces = calloc(1, sizeof *p->forces);
    p->force_count = 1;
    struct forces *f = p->forces;
    check_done(table_alloc(&CONTACT_FORCES, &f->contact, PAIRS, NULL));
    for (int c = 0; c < PAIRS; c++)
        f->contact.fn[c] = c < 3 ? V : H, f->contact.ft[c] = 0;
    f->iterations = 7, f->converged = 1, f->imbalance = 1e-9, f->tolerance = 1e-6, f->kn = NAN;
    f->stress[0][0] = 2 * H / 4, f->stress[1][1] = V / 2; /* N/m */
}

static void balanced(struct packing *p)
{
    (void)p;
}

static void not_converged(struct packing *p)
{
    p->forces->converged = 0, p->forces->imbalance = 0.35;
}

static void seeks_none(struct packing *p)
{
    p->forces->iterations = p->forces->converged = 0, p->forces->imbalance = 1.2, p->forces->imbalance_mean = 0.5;
    p->forces->stress[1][1] = 0.5 * V / 2;
}

static void infeasible(struct packing *p)
{
    p->forces->infeasible = 1, p->forces->converged = 0, p->forces->imbalance = 0.8;
}

static void a_little_off(struct packing *p)
{
    p->walls.fx[LEFT] = 124, p->forces->misfit[0] = 4;
}

static void doubled_load(struct packing *p)
{
    p->walls.fx[RIGHT] = -240, p->forces->misfit[0] = -120;
}

/* Friction on the bottom takes a part of what the right wall pushes: the left one bears less, and all is in balance. */
static void wall_friction(struct packing *p)
{
    p->contacts.i[1] = 0;
    p->forces->contact.ft[1] = -20; /* on the wall, along t of n = (0, -1): to the left */
    p->forces->contact.fn[3] = H - 20, p->walls.fx[LEFT] = 100;
}

/* A load that nothing answers, spread over the grains: as series leaves it, which holds equilibrium only nearly. */
static void spread_out(struct packing *p)
{
    check_done(table_alloc(&RESIDUALS, &p->forces->residual, 2, NULL));
    for (int k = 0; k < 2; k++)
        p->forces->residual.residual_x[k] = 15, p->forces->residual.residual_y[k] = k ? 1 : -1;
}

static void bare_wall(struct packing *p)
{
    p->forces->contact.fn[5] = p->forces->contact.fn[6] = 0;
}

static void nothing_carries(struct packing *p)
{
    for (int c = 0; c < PAIRS; c++)
        p->forces->contact.fn[c] = 0;
    p->forces->stress[0][0] = p->forces->stress[1][1] = 0;
}

static void pulled(struct packing *p)
{
    for (int w = 0; w < 4; w++)
        p->walls.fx[w] *= -1, p->walls.fy[w] *= -1;
}

static void other_stress(struct packing *p)
{
    p->forces->stress[0][0] *= 0.6, p->forces->stress[1][1] *= 0.6;
}

static void grains_fall(struct packing *p)
{
    p->forces->imbalance_mean = 0.2;
}

static void other_overlaps(struct packing *p)
{
    p->forces->kn = 1e6;
    for (int c = 0; c < PAIRS; c++)
        p->contacts.overlap[c] = 3e-4; /* kn x: 3 times a mean force of 100 N */
}

static void each_reason_is_given(void **state)
{
    static const struct {
        void (*spoil)(struct packing *p);
        enum verdict verdict;
        int converged;
        const char *reason;
    } cases[] = {
        {balanced, VERDICT_BALANCED, 1, ""},
        {not_converged, VERDICT_DOUBTFUL, 0, "not converged: up to 0.35 <fn> is left unbalanced (tolerance 1e-06)"},
        {seeks_none, VERDICT_DOUBTFUL, 0, "the method seeks no equilibrium"},
        {infeasible, VERDICT_VOID, 0, "no forces at all on these contacts balance the loads"},
        {a_little_off, VERDICT_DOUBTFUL, 0, "the contacts of the left wall bear 120 N, but its load is 124 N"},
        {doubled_load, VERDICT_VOID, 0, "the contacts of the right wall bear 120 N, but its load is 240 N"},
        {wall_friction, VERDICT_BALANCED, 1, ""},
        {spread_out, VERDICT_VOID, 0,
         "the grains are left with 30 N along x in all, where the walls are loaded with 120 N"},
        {bare_wall, VERDICT_VOID, 0, "the right wall is loaded, but no contact there carries anything"},
        {nothing_carries, VERDICT_VOID, 0, "no contact carries anything (7 contacts among 2 grains)"},
        {pulled, VERDICT_VOID, 0, "the loads pull outwards (mean stress -40 N/m): is their sign turned?"},
        {other_stress, VERDICT_VOID, 1, "make a stress of 24 N/m where 40 is applied"},
        {grains_fall, VERDICT_VOID, 1, "grains are left with 0.2 <fn> unbalanced in the mean"},
        {other_overlaps, VERDICT_DOUBTFUL, 1, "overlaps times k_n are"},
    };
    (void)state;
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        struct packing p;
        make(&p);
        cases[k].spoil(&p);
        check_done(verdict_find(&p, p.forces));
        if (p.forces->verdict != cases[k].verdict || !strstr(p.forces->reasons, cases[k].reason) ||
            (!*cases[k].reason && *p.forces->reasons))
            fail_msg("case %zu: %s: '%s' does not say '%s'", k, VERDICT_NAMES[p.forces->verdict], p.forces->reasons,
                     cases[k].reason);
        assert_int_equal(p.forces->converged, cases[k].converged);
        packing_free(&p);
    }
}

/* The gravest first, whatever was found first. */
static void the_gravest_comes_first(void **state)
{
    struct packing p;
    (void)state;
    make(&p);
    not_converged(&p), infeasible(&p), a_little_off(&p);
    check_done(verdict_find(&p, p.forces));
    assert_int_equal(p.forces->verdict, VERDICT_VOID);
    assert_int_equal(strncmp(p.forces->reasons, "no forces at all", 16), 0);
    assert_non_null(strstr(p.forces->reasons, "; the contacts of the left wall"));
    packing_free(&p);
}

/* A wall of a fitted frame is never quite level: a load without its tangential component counts all the same (F15). */
static void tilted_walls_keep_their_loads(void **state)
{
    struct packing p;
    (void)state;
    make(&p);
    p.walls.y1[TOP] += 0.02, p.walls.fx[TOP] = NAN;
    check_near(wall_load(&p.walls, TOP), V, 1e-4 * V);
    assert_true(wall_moves(&p.walls, TOP));
    p.walls.fx[TOP] = 3, p.walls.fy[TOP] = NAN;
    assert_true(isnan(wall_load(&p.walls, TOP)));
    packing_free(&p);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(each_reason_is_given),
        cmocka_unit_test(the_gravest_comes_first),
        cmocka_unit_test(tilted_walls_keep_their_loads),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
