/* Pair search of contacts against brute force. */
#include <math.h>
#include <stdlib.h>

#include "contacts/network/cell_list.h"
#include "tests/check.h"

struct discs {
    size_t count;
    double *x, *y, *radius;
};

static struct discs discs_new(size_t count)
{
    struct discs d = {count, calloc(count + 1, sizeof(double)), calloc(count + 1, sizeof(double)),
                      calloc(count + 1, sizeof(double))};
    assert_true(d.x && d.y && d.radius);
    return d;
}

static void discs_free(struct discs *d)
{
    free(d->x);
    free(d->y);
    free(d->radius);
}

/* Every pair, in order, must be what the definition says. */
static void compare_with_definition(const struct discs *d, double margin)
{
    struct near_pairs pairs;
    size_t at = 0;
    check_done(near_pairs_find(d->x, d->y, d->radius, NULL, d->count, margin, &pairs));
    for (size_t i = 0; i < d->count; i++)
        for (size_t j = i + 1; j < d->count; j++) {
            double reach = d->radius[i] + d->radius[j] + margin;
            double dx = d->x[j] - d->x[i], dy = d->y[j] - d->y[i];
            if (!(d->radius[i] > 0 && d->radius[j] > 0) || !(dx * dx + dy * dy <= reach * reach))
                continue;
            assert_true(at < pairs.count);
            assert_int_equal(pairs.i[at], i);
            assert_int_equal(pairs.j[at], j);
            at++;
        }
    assert_int_equal(at, pairs.count);
    near_pairs_free(&pairs);
}

static void test_random_discs(void **state)
{
    (void)state;
    uint64_t seed = 1;
    for (int round = 0; round < 20; round++) {
        struct discs d = discs_new(300);
        for (size_t k = 0; k < d.count; k++) {
            d.x[k] = 40 * check_uniform(&seed) - 20;
            d.y[k] = 30 * check_uniform(&seed) + 1000;
            d.radius[k] = 0.1 * pow(20, check_uniform(&seed));
        }
        compare_with_definition(&d, round % 2 ? 0 : 0.3);
        discs_free(&d);
    }
}

static void test_missing_numbers_and_far_discs(void **state)
{
    (void)state;
    uint64_t seed = 2;
    struct discs d = discs_new(200);
    for (size_t k = 0; k < d.count; k++) {
        d.x[k] = 10 * check_uniform(&seed);
        d.y[k] = 10 * check_uniform(&seed);
        d.radius[k] = 0.5;
    }
    d.x[3] = NAN;
    d.y[50] = INFINITY;
    d.radius[70] = NAN;
    d.radius[71] = 0;
    d.radius[72] = -1;
    d.x[80] = 1e200;
    d.y[90] = -1e30;
    compare_with_definition(&d, 0.1);
    discs_free(&d);
}

/* One disc that covers all others, and cells of theirs beyond counting; places whose differences overflow. */
static void test_absurd_discs(void **state)
{
    (void)state;
    uint64_t seed = 3;
    struct discs d = discs_new(200);
    for (size_t k = 0; k < d.count; k++) {
        d.x[k] = 40 * check_uniform(&seed);
        d.y[k] = 40 * check_uniform(&seed);
        d.radius[k] = 0.5 + check_uniform(&seed);
    }
    d.radius[17] = 3e7;
    compare_with_definition(&d, 0.1);
    d.x[17] = 2e7; /* covers all from afar */
    compare_with_definition(&d, 0.1);
    d.radius[17] = 1e100;
    compare_with_definition(&d, 0);
    d.radius[17] = 1;
    d.x[17] = 1.5e308;
    d.x[18] = -1.5e308;
    d.y[19] = -1.5e308;
    compare_with_definition(&d, 0.1);
    discs_free(&d);
}

static void test_nothing_and_one(void **state)
{
    (void)state;
    struct discs d = discs_new(1);
    struct near_pairs pairs;
    d.radius[0] = 1;
    check_done(near_pairs_find(d.x, d.y, d.radius, NULL, 0, 0, &pairs));
    assert_int_equal(pairs.count, 0);
    near_pairs_free(&pairs);
    compare_with_definition(&d, 1);
    discs_free(&d);
}

static void test_skipped_rows(void **state)
{
    (void)state;
    double x[] = {0, 1, 2}, y[] = {0, 0, 0}, r[] = {1, 1, 1};
    unsigned char skip[] = {0, 1, 0};
    struct near_pairs pairs;
    check_done(near_pairs_find(x, y, r, skip, 3, 0, &pairs));
    assert_int_equal(pairs.count, 1);
    assert_int_equal(pairs.i[0], 0);
    assert_int_equal(pairs.j[0], 2);
    near_pairs_free(&pairs);
}

/* A square lattice whose number of contacts is known: a million discs, or 40 000 under the sanitizers. */
static void test_a_million(void **state)
{
    (void)state;
#if defined(__SANITIZE_ADDRESS__)
    size_t side = 200;
#else
    size_t side = 1000;
#endif
    struct discs d = discs_new(side * side);
    struct near_pairs pairs;
    for (size_t k = 0; k < d.count; k++) {
        size_t shuffled = (k * 7919) % d.count; /* neighbours far apart in memory */
        d.x[k] = (double)(shuffled % side);
        d.y[k] = (double)(shuffled / side);
        d.radius[k] = 0.5;
    }
    check_done(near_pairs_find(d.x, d.y, d.radius, NULL, d.count, 0.01, &pairs));
    assert_int_equal(pairs.count, 2 * side * (side - 1));
    near_pairs_free(&pairs);
    discs_free(&d);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_random_discs), cmocka_unit_test(test_missing_numbers_and_far_discs),
        cmocka_unit_test(test_absurd_discs), cmocka_unit_test(test_nothing_and_one),
        cmocka_unit_test(test_skipped_rows), cmocka_unit_test(test_a_million),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
