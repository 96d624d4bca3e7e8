/* The automatic radius offset on rows of elliptic rods: with shapes that are in equilibrium, and with shapes that
 * overlap at random; on round rods whose overlaps are twenty times smaller than their errors; and what loads say about
 * the overlaps. */
#include <math.h>
#include <stdio.h>

#include "contacts/network/near_pairs.h"
#include "contacts/radii/loaded_overlaps.h"
#include "contacts/radii/radius_offset.h"
#include "tests/check.h"

enum { SIDE = 22 };
#define PX 1e-4
#define RADIUS 30.0
#define ERROR 0.02

/* Rows of rods that press on their neighbours with a half-normal overlap (0.3 px), one pair in eight apart; every
 * radius is measured too large by `offset`. The overlaps are those of the ellipses (balanced) or of the circles. */
static struct grains rows_of_ellipses(double offset, int balanced, uint64_t *seed)
{
    static const char *const columns[] = {"x", "y", "radius", "s_radius", "shape_c", "shape_s", "angle", "flags", NULL};
    struct grains g;
    check_done(table_alloc(&GRAINS, &g, SIDE * SIDE, columns));
    for (size_t k = 0; k < g.count; k++) {
        g.radius[k] = (RADIUS + offset + ERROR * check_normal(seed)) * PX;
        g.s_radius[k] = ERROR * PX;
        g.shape_c[k] = 0.3 * check_normal(seed) * PX;
        g.y[k] = 90 * PX * (double)(k / SIDE);
        g.shape_s[k] = g.angle[k] = g.x[k] = 0;
        g.flags[k] = 0;
    }
    for (size_t k = 0; k < g.count; k++) {
        if (k % SIDE == 0)
            continue;
        double overlap = check_uniform(seed) < 0.125 ? -check_uniform(seed) : fabs(0.38 * check_normal(seed));
        g.x[k] = g.x[k - 1] + (2 * RADIUS - overlap) * PX + (balanced ? g.shape_c[k] + g.shape_c[k - 1] : 0);
    }
    return g;
}

static void find_offset(double offset, int balanced, uint64_t *seed)
{
    struct grains g = rows_of_ellipses(offset, balanced, seed);
    struct pairs pairs;
    struct radius_correction found;
    struct overlap_choice choice = {.farthest = 4 * PX, .kind = CORRECT_OFFSET};
    double window;
    check_done(candidates_between_grains(&g, 4, 4 * PX, &pairs, &window));
    check_done(radius_correction_estimate(&g, &pairs, &choice, 0, &found));
    assert_int_equal(found.decided, 1);
    assert_int_equal(found.unbalanced, !balanced);
    check_near(found.value / PX, -offset, 0.02);
    check_near((found.value / PX + offset) / (found.error / PX), 0, 3);
    pairs_free(&pairs);
    table_free(&GRAINS, &g);
}

static void test_shapes_in_equilibrium(void **state)
{
    (void)state;
    uint64_t seed = 5;
    find_offset(0.3, 1, &seed);
    find_offset(-0.3, 1, &seed);
}

/* The edge is where the circles meet, whatever their shapes do. */
static void test_shapes_at_random(void **state)
{
    (void)state;
    uint64_t seed = 6;
    find_offset(0.3, 0, &seed);
    find_offset(-0.3, 0, &seed);
}

/* ---- overlaps that are smaller than their errors ---- */

enum { SEEDS = 10 };
#define SMALL_OVERLAP 0.01 /* px: mean, */
#define LARGE_ERROR 0.2    /* and standard error of an overlap */

/* Rows of round rods that press on their neighbours with half-normal overlaps, one pair in eight apart. The errors are
 * `understated` times what is stated. *loaded: sum of overlaps times branches, m2. */
static struct grains rows_of_rods(double offset, double understated, uint64_t *seed, double *loaded)
{
    static const char *const columns[] = {"x", "y", "radius", "s_radius", "flags", NULL};
    struct grains g;
    double stated = LARGE_ERROR * M_SQRT1_2;
    check_done(table_alloc(&GRAINS, &g, SIDE * SIDE, columns));
    *loaded = 0;
    for (size_t k = 0; k < g.count; k++) {
        g.radius[k] = (RADIUS + offset + understated * stated * check_normal(seed)) * PX;
        g.s_radius[k] = stated * PX;
        g.y[k] = 90 * PX * (double)(k / SIDE);
        g.flags[k] = 0;
        g.x[k] = 0;
        if (k % SIDE == 0)
            continue;
        double overlap = SMALL_OVERLAP * sqrt(0.5 * M_PI) * fabs(check_normal(seed));
        if (check_uniform(seed) < 0.125)
            overlap = -2 * check_uniform(seed);
        *loaded += fmax(overlap, 0) * (2 * RADIUS - overlap) * PX * PX;
        g.x[k] = g.x[k - 1] + (2 * RADIUS - overlap) * PX;
    }
    return g;
}

/* Error and stated error of the offset over many draws, px; root of the mean square of their ratio. */
struct spread {
    double error, stated, ratio;
    int doubtful;
};

static struct spread try_rows(double understated, int with_loads)
{
    struct spread sum = {0};
    uint64_t seed = 21;
    for (int k = 0; k < SEEDS; k++) {
        double loaded, window, offset = check_uniform(&seed) - 0.5;
        struct grains g = rows_of_rods(offset, understated, &seed, &loaded);
        struct overlap_choice choice = {.farthest = 4 * PX, .kind = CORRECT_OFFSET};
        struct pairs pairs;
        struct radius_correction found;
        check_done(candidates_between_grains(&g, 4, 4 * PX, &pairs, &window));
        check_done(radius_correction_estimate(&g, &pairs, &choice, with_loads ? loaded : 0, &found));
        assert_int_equal(found.decided, 1);
        double error = found.value / PX + offset, stated = found.error / PX;
        sum.error += error * error / SEEDS;
        sum.stated += stated * stated / SEEDS;
        sum.ratio += pow(error / stated, 2) / SEEDS;
        sum.doubtful += found.doubt != NULL;
        pairs_free(&pairs);
        table_free(&GRAINS, &g);
    }
    return (struct spread){sqrt(sum.error), sqrt(sum.stated), sqrt(sum.ratio), sum.doubtful};
}

/* The loads give the mean overlap: the middle of some 400 overlaps is known to LARGE_ERROR / sqrt(400) = 0.01 px, the
 * offset to half of it; and whether the errors are as stated does not matter. */
static void test_small_overlaps_with_loads(void **state)
{
    (void)state;
    for (int understated = 1; understated <= 2; understated++) {
        struct spread spread = try_rows(understated, 1);
        check_at_most(spread.ratio, 1.3);
        check_at_most(0.5, spread.ratio);
        check_at_most(spread.stated, 0.011 * understated);
        assert_int_equal(spread.doubtful, SEEDS); /* the zero is known no better than the mean overlap */
    }
}

/* Without them the overlaps may be anything from nothing to about an error, and the stated error says so, also when
 * errors are 1.4 times those stated. */
static void test_small_overlaps_without_loads(void **state)
{
    (void)state;
    struct spread spread = try_rows(1, 0);
    check_at_most(spread.ratio, 1.3);
    check_at_most(spread.error, 0.5 * LARGE_ERROR);
    spread = try_rows(1.4, 0);
    check_at_most(spread.ratio, 1.5);
}

/* ---- what the loads say ---- */

#define LOADS "test_radius_offset_loads.csv"
#define KN 1e7

/* A box of 1000 x 800 px, pressed with 500 N from the side and 800 N from above: sum x l = (500 N 0.1 m + 800 N 0.08 m)
 * / kn, less what walls carry. */
static void test_overlaps_from_loads(void **state)
{
    (void)state;
    static const char *const columns[] = {"x", "y", "radius", "flags", NULL};
    FILE *file = fopen(LOADS, "w");
    assert_non_null(file);
    fputs("index,wall,fx_N,fy_N\n3,right,-500,0\n3,top,0,-800\n", file);
    assert_int_equal(fclose(file), 0);
    char path[] = LOADS;
    struct scene scene = {.scale = PX, .loads = path, .contact_given = 1};
    scene.contact = (struct contact_law){.row = &linear_law, .kn = KN};
    scene.grains.length = NAN;
    scene.frame.given = 1;
    scene.frame.corners_px[CORNER_TOP_LEFT] = vec(0, 0);
    scene.frame.corners_px[CORNER_TOP_RIGHT] = vec(1000, 0);
    scene.frame.corners_px[CORNER_BOTTOM_RIGHT] = vec(1000, 800);
    scene.frame.corners_px[CORNER_BOTTOM_LEFT] = vec(0, 800);
    struct grains g;
    check_done(table_alloc(&GRAINS, &g, 1, columns));
    g.radius[0] = 20 * PX;
    g.x[0] = g.y[0] = 0;
    g.flags[0] = 0;
    struct contact_input input = {.scene = &scene, .index = 3, .is_reference = 1};
    double sum, walls = 2 * 20 / sqrt(1000 * 800);
    check_done(loaded_overlaps(&input, &g, &sum));
    check_near(sum, (500 * 0.1 + 800 * 0.08) / KN * (1 - walls), 1e-12);
    scene.contact.kn = NAN;
    check_done(loaded_overlaps(&input, &g, &sum));
    check_near(sum, 0, 0);
    scene.contact.kn = KN;
    input.index = 4; /* no row */
    assert_int_equal(loaded_overlaps(&input, &g, &sum), -1);
    table_free(&GRAINS, &g);
    remove(LOADS);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_shapes_in_equilibrium),     cmocka_unit_test(test_shapes_at_random),
        cmocka_unit_test(test_small_overlaps_with_loads), cmocka_unit_test(test_small_overlaps_without_loads),
        cmocka_unit_test(test_overlaps_from_loads),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
