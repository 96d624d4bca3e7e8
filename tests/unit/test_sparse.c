/* Sparse systems of contact blocks: solved and multiplied back by the blocks themselves. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "forces/algebra/sparse.h"
#include "pipeline/numbers/random.h"
#include "tests/check.h"

enum { WIDTH = 4 };

/* Blocks of random places and values; `bodies` unknowns. Each block is M M' of a random M, so that their sum is
 * positive semi-definite; the second half of the unknowns is turned negative for a quasi-definite matrix. */
struct system {
    size_t unknowns, blocks;
    int *place;
    double *value; /* WIDTH x WIDTH per block */
};

static int negative(const struct system *system, int place, int indefinite)
{
    return indefinite && place >= (int)system->unknowns / 2;
}

static void draw_block(struct system *system, size_t b, int indefinite)
{
    double m[WIDTH][WIDTH];
    const int *place = system->place + b * WIDTH;
    for (int i = 0; i < WIDTH * WIDTH; i++)
        m[i / WIDTH][i % WIDTH] = random_normal(b + 17, (uint64_t)i);
    for (int i = 0; i < WIDTH; i++)
        for (int j = 0; j < WIDTH; j++) {
            double sum = 0;
            int p = negative(system, place[i], indefinite), q = negative(system, place[j], indefinite);
            for (int k = 0; k < WIDTH; k++)
                sum += m[i][k] * m[j][k];
            system->value[(b * WIDTH + (size_t)i) * WIDTH + (size_t)j] = p != q ? m[i][j] + m[j][i] : p ? -sum : sum;
        }
}

/* reach: how far apart the unknowns of a block may be numbered; all of them: a dense matrix. */
static void draw_system(size_t unknowns, size_t blocks, size_t reach, int indefinite, struct system *system)
{
    *system = (struct system){unknowns, blocks, malloc(blocks * WIDTH * sizeof(int)),
                              malloc(blocks * WIDTH * WIDTH * sizeof(double))};
    for (size_t b = 0; b < blocks; b++) {
        size_t base = random_bits(3, b) % unknowns;
        for (size_t k = 0; k < WIDTH; k++) /* all different; the last one is sometimes none */
            system->place[b * WIDTH + k] =
                k == 3 && b % 5 == 0
                    ? -1
                    : (int)((base + k * (reach / WIDTH) + random_bits(4 + k, b) % (reach / WIDTH)) % unknowns);
        draw_block(system, b, indefinite);
    }
}

static void forget(struct system *system)
{
    free(system->place), free(system->value);
}

/* out = (sum of blocks + diagonal) x. */
static void multiply(const struct system *system, const double *diagonal, const double *x, double *out)
{
    for (size_t d = 0; d < system->unknowns; d++)
        out[d] = diagonal[d] * x[d];
    for (size_t b = 0; b < system->blocks; b++)
        for (size_t i = 0; i < WIDTH; i++)
            for (size_t j = 0; j < WIDTH; j++) {
                int p = system->place[b * WIDTH + i], q = system->place[b * WIDTH + j];
                if (p >= 0 && q >= 0)
                    out[p] += system->value[(b * WIDTH + i) * WIDTH + j] * x[q];
            }
}

static void check_system(size_t unknowns, size_t blocks, size_t reach, int indefinite)
{
    struct system system;
    double *diagonal = calloc(4 * unknowns, sizeof *diagonal), *right = diagonal + unknowns, *x = right + unknowns,
           *back = x + unknowns, largest = 0;
    draw_system(unknowns, blocks, reach, indefinite, &system);
    struct sparse *sparse = sparse_create(unknowns, blocks, WIDTH, system.place);
    assert_non_null(sparse);
    for (int again = 0; again < 2; again++) { /* new values, the same analysis */
        sparse_clear(sparse);
        for (size_t b = 0; b < blocks; b++)
            sparse_add(sparse, b, system.value + b * WIDTH * WIDTH);
        for (size_t d = 0; d < unknowns; d++) {
            diagonal[d] = (negative(&system, (int)d, indefinite) ? -1 : 1) * (1 + again);
            right[d] = random_normal(99, d);
        }
        sparse_add_diagonal(sparse, diagonal, 0);
        assert_int_equal(indefinite ? sparse_factorise_indefinite(sparse) : sparse_factorise(sparse), 0);
        check_done(sparse_solve(sparse, right, x));
        multiply(&system, diagonal, x, back);
        for (size_t d = 0; d < unknowns; d++)
            largest = fmax(largest, fabs(back[d] - right[d]));
        assert_true(largest < 1e-9);
    }
    sparse_free(sparse);
    forget(&system);
    free(diagonal);
}

static void systems_of_all_shapes_are_solved(void **state)
{
    (void)state;
    for (int indefinite = 0; indefinite < 2; indefinite++) {
        check_system(5, 3, 4, indefinite);
        check_system(1000, 2500, 24, indefinite); /* a band: narrow supernodes */
        check_system(700, 500, 700, indefinite);  /* sparse */
        check_system(150, 8000, 150, indefinite); /* dense: one supernode of several panels */
    }
}

static void a_matrix_that_is_not_positive_definite_is_told(void **state)
{
    static const int place[WIDTH] = {0, 1, 2, 3};
    double block[WIDTH * WIDTH] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, -1, 0, 0, 0, 0, 1}, right[WIDTH] = {1, 2, 3, 4},
                         x[WIDTH];
    (void)state;
    struct sparse *sparse = sparse_create(WIDTH, 1, WIDTH, place);
    sparse_clear(sparse);
    sparse_add(sparse, 0, block);
    assert_int_equal(sparse_factorise(sparse), -1);
    assert_int_equal(sparse_factorise_indefinite(sparse), 0);
    check_done(sparse_solve(sparse, right, x));
    assert_true(x[0] == 1 && x[1] == 2 && x[2] == -3 && x[3] == 4);
    block[2 * WIDTH + 2] = 0; /* singular: shifted, and the shift is told */
    sparse_clear(sparse);
    sparse_add(sparse, 0, block);
    assert_int_equal(sparse_factorise_indefinite(sparse), -1);
    assert_int_equal(sparse_factorise(sparse), 1);
    block[2 * WIDTH + 2] = NAN;
    sparse_clear(sparse);
    sparse_add(sparse, 0, block);
    assert_int_equal(sparse_factorise(sparse), -1);
    assert_int_equal(sparse_factorise_indefinite(sparse), -1);
    sparse_free(sparse);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(systems_of_all_shapes_are_solved),
        cmocka_unit_test(a_matrix_that_is_not_positive_definite_is_told),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
