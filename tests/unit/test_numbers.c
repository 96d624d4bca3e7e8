/* Order statistics, golden sections, small dense systems and the grid of points against their definitions. */
#include <math.h>
#include <stdlib.h>

#include "pipeline/numbers/cell_grid.h"
#include "pipeline/numbers/dense.h"
#include "pipeline/numbers/golden.h"
#include "pipeline/numbers/quantiles.h"
#include "pipeline/numbers/random.h"
#include "tests/check.h"

static void quantiles_are_ranks_with_straight_lines_between(void **state)
{
    (void)state;
    const double sorted[] = {1, 2, 4, 8, 16};
    assert_true(quantile(sorted, 5, 0) == 1 && quantile(sorted, 5, 1) == 16 && quantile(sorted, 5, 0.5) == 4);
    check_near(quantile(sorted, 5, 0.3), 2.4, 1e-15); /* rank 1.2 */
    check_near(quantile(sorted, 5, 0.95), 14.4, 1e-14);
    assert_true(quantile(sorted, 1, 0.95) == 1 && isnan(quantile(sorted, 0, 0.5)));
}

static double parabola(double x, void *user)
{
    return (x - *(double *)user) * (x - *(double *)user);
}

static void golden_sections_find_the_least(void **state)
{
    (void)state;
    double inside = 0.3, outside = 5;
    check_near(golden_section(parabola, &inside, -1, 2, 1e-7), 0.3, 1e-7);
    check_near(golden_section(parabola, &outside, -1, 2, 1e-7), 2, 1e-7);
}

/* A = B B' + 1 of random B: x, the inverse and L L' must give A x = b, A A^-1 = 1. */
static void dense_systems_are_solved(void **state)
{
    (void)state;
    enum { N = 5, APART = 7 };
    double b[N][N], a[N][APART], factor[N][APART], inverse[N][APART], system[N][APART], x[N];
    for (int i = 0; i < N * N; i++)
        b[i / N][i % N] = 2 * random_uniform(7, (uint64_t)i) - 1;
    for (int i = 0; i < N; i++) {
        for (int j = 0; j < N; j++) {
            a[i][j] = i == j;
            for (int k = 0; k < N; k++)
                a[i][j] += b[i][k] * b[j][k];
            factor[i][j] = inverse[i][j] = system[i][j] = a[i][j];
        }
        system[i][N] = x[i] = i - 1.5;
    }
    assert_int_equal(dense_factorise(&factor[0][0], N, APART, 1e-14), 0);
    dense_substitute(&factor[0][0], N, APART, x);
    assert_int_equal(dense_invert(&inverse[0][0], N, APART, 1e-9), 0);
    assert_int_equal(dense_solve(&system[0][0], N, APART, 1e-9), 0);
    for (int i = 0; i < N; i++) {
        double by_factor = 0, by_elimination = 0;
        for (int j = 0; j < N; j++) {
            double one = 0;
            for (int k = 0; k < N; k++)
                one += a[i][k] * inverse[k][j];
            check_near(one, i == j, 1e-13);
            by_factor += a[i][j] * x[j];
            by_elimination += a[i][j] * system[j][N];
        }
        check_near(by_factor, i - 1.5, 1e-13);
        check_near(by_elimination, i - 1.5, 1e-13);
    }
}

static void singular_matrices_are_refused(void **state)
{
    (void)state;
    double one[2][3] = {{1, 2, 1}, {2, 4, 1}}, two[2][3] = {{1, 2, 1}, {2, 4, 1}}, three[2][3] = {{1, 2, 1}, {2, 4, 1}};
    assert_int_equal(dense_factorise(&one[0][0], 2, 3, 1e-14), -1);
    assert_int_equal(dense_invert(&two[0][0], 2, 3, 1e-9), -1);
    assert_int_equal(dense_solve(&three[0][0], 2, 3, 1e-9), -1);
}

/* Points over 12 decades, some not finite: each search must find every point that is near, once. */
static void the_grid_misses_no_point_and_finds_none_twice(void **state)
{
    (void)state;
    enum { N = 400 };
    double x[N], y[N];
    struct cell_grid grid;
    check_done(cell_grid_open(&grid, N, 0.1));
    for (int k = 0; k < N; k++) {
        double size = k % 4 ? 1 : pow(10, 12 * random_uniform(2, (uint64_t)k));
        x[k] = k == 7 ? NAN : k == 9 ? 1e200 : size * (2 * random_uniform(3, (uint64_t)k) - 1);
        y[k] = size * (2 * random_uniform(4, (uint64_t)k) - 1);
        cell_grid_add(&grid, (size_t)k, x[k], y[k]);
    }
    for (int k = 0; k < N; k++)
        for (double reach = 0.01; reach < 1e4; reach *= 7) {
            int seen[N] = {0};
            double at = k == 7 || k == 9 ? 0 : x[k];
            struct cell_search search = cell_grid_near(&grid, at, y[k], reach);
            for (size_t m; (m = cell_grid_next(&search)) != CELL_GRID_END;)
                seen[m]++;
            for (int m = 0; m < N; m++) {
                int near = fabs(x[m] - at) <= reach && fabs(y[m] - y[k]) <= reach;
                assert_true(near ? seen[m] == 1 : seen[m] <= 1);
            }
            assert_true(!seen[7] && !seen[9]);
        }
    cell_grid_free(&grid);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(quantiles_are_ranks_with_straight_lines_between),
        cmocka_unit_test(golden_sections_find_the_least),
        cmocka_unit_test(dense_systems_are_solved),
        cmocka_unit_test(singular_matrices_are_refused),
        cmocka_unit_test(the_grid_misses_no_point_and_finds_none_twice),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
