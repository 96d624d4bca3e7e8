/* The automatic radius offset on rows of elliptic rods: with shapes that are in equilibrium, and with shapes that
 * overlap at random. */
#include <math.h>

#include "contacts/candidates.h"
#include "contacts/radius_offset.h"
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
    double window;
    check_done(candidates_between_grains(&g, 4, 4 * PX, &pairs, &window));
    check_done(radius_correction_estimate(&g, &pairs, NULL, CORRECT_OFFSET, &found));
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

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_shapes_in_equilibrium),
        cmocka_unit_test(test_shapes_at_random),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
