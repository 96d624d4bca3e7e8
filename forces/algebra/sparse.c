#include "forces/algebra/sparse.h"

#include <limits.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <suitesparse/cholmod.h>

#include "forces/algebra/supernodal.h"
#include "pipeline/speak/error.h"

enum { REFINEMENTS = 2 };

struct sparse {
    cholmod_common common;
    cholmod_sparse *matrix; /* lower triangle, columns sorted */
    struct supernodal *factor;
    double *defect, *correction;
    int *slot;     /* per block: where its lower triangle goes */
    int *diagonal; /* per unknown */
    int width, triangle;
    int shifted;
};

/* Rows of the lower triangle, bucketed by column: starts[c] .. starts[c + 1]. */
struct pattern {
    size_t *starts;
    int *rows;
};

static int compare_ints(const void *a, const void *b)
{
    int x = *(const int *)a, y = *(const int *)b;
    return (x > y) - (x < y);
}

static void for_each_entry(size_t blocks, int width, const int *place, size_t *starts, int *rows)
{
    for (size_t b = 0; b < blocks; b++)
        for (int i = 0; i < width; i++)
            for (int j = 0; j <= i; j++) {
                int p = place[b * (size_t)width + (size_t)i], q = place[b * (size_t)width + (size_t)j];
                if (p < 0 || q < 0)
                    continue;
                int row = p > q ? p : q, column = p > q ? q : p;
                if (rows)
                    rows[starts[column]] = row;
                starts[column]++;
            }
}

/* Counting sort of all entries by column; the diagonal is always there. */
static int pattern_fill(size_t unknowns, size_t blocks, int width, const int *place, struct pattern *pattern)
{
    size_t *starts = calloc(unknowns + 2, sizeof *starts);
    if (!starts)
        return error_memory("matrix pattern");
    pattern->starts = starts;
    for_each_entry(blocks, width, place, starts, NULL);
    size_t total = 0;
    for (size_t c = 0; c < unknowns; c++) {
        size_t here = starts[c] + 1;
        starts[c] = total;
        total += here;
    }
    starts[unknowns] = total;
    pattern->rows = malloc((total + 1) * sizeof(int));
    if (!pattern->rows)
        return error_memory("matrix pattern");
    for (size_t c = 0; c < unknowns; c++)
        pattern->rows[starts[c]++] = (int)c;
    for_each_entry(blocks, width, place, starts, pattern->rows);
    for (size_t c = unknowns; c > 0; c--) /* each start has moved to the next one's place */
        starts[c] = starts[c - 1];
    starts[0] = 0;
    return 0;
}

/* Sort each column and drop repeated rows in place; returns the number of entries that stay. */
static size_t pattern_compress(size_t unknowns, struct pattern *pattern)
{
    size_t kept = 0;
    for (size_t c = 0; c < unknowns; c++) {
        size_t begin = pattern->starts[c], end = pattern->starts[c + 1];
        qsort(pattern->rows + begin, end - begin, sizeof(int), compare_ints);
        pattern->starts[c] = kept;
        for (size_t k = begin; k < end; k++)
            if (k == begin || pattern->rows[k] != pattern->rows[k - 1])
                pattern->rows[kept++] = pattern->rows[k];
    }
    pattern->starts[unknowns] = kept;
    return kept;
}

static int matrix_from_pattern(struct sparse *sparse, size_t unknowns, const struct pattern *pattern, size_t entries)
{
    if (entries > INT_MAX || unknowns > INT_MAX)
        return error_input("%zu equations: cut the packing", unknowns);
    sparse->matrix = cholmod_allocate_sparse(unknowns, unknowns, entries, 1, 1, -1, CHOLMOD_REAL, &sparse->common);
    sparse->diagonal = malloc((unknowns + 1) * sizeof(int));
    if (!sparse->matrix || !sparse->diagonal)
        return error_memory("matrix");
    int *p = sparse->matrix->p, *rows = sparse->matrix->i;
    for (size_t c = 0; c <= unknowns; c++)
        p[c] = (int)pattern->starts[c];
    memcpy(rows, pattern->rows, entries * sizeof(int));
    memcpy(sparse->diagonal, p, unknowns * sizeof(int)); /* rows are sorted: the diagonal comes first */
    return 0;
}

static int find_slot(const struct sparse *sparse, int p, int q)
{
    if (p < 0 || q < 0)
        return -1;
    int row = p > q ? p : q, column = p > q ? q : p;
    const int *starts = sparse->matrix->p, *rows = sparse->matrix->i;
    int low = starts[column], high = starts[column + 1] - 1;
    while (low < high) {
        int middle = low + (high - low) / 2;
        if (rows[middle] < row)
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}

static int find_slots(struct sparse *sparse, size_t blocks, int width, const int *place)
{
    sparse->width = width;
    sparse->triangle = width * (width + 1) / 2;
    sparse->slot = malloc((blocks * (size_t)sparse->triangle + 1) * sizeof(int));
    if (!sparse->slot)
        return error_memory("matrix");
    int *slot = sparse->slot;
    for (size_t b = 0; b < blocks; b++)
        for (int i = 0; i < width; i++)
            for (int j = 0; j <= i; j++)
                *slot++ = find_slot(sparse, place[b * (size_t)width + (size_t)i], place[b * (size_t)width + (size_t)j]);
    return 0;
}

/* Fill-reducing order and supernodes. Minimum degree: for 100000 rods it costs two thirds of nested dissection. */
static int analyse(struct sparse *sparse)
{
    cholmod_common *common = &sparse->common;
    size_t unknowns = sparse->matrix->nrow;
    common->nmethods = 1;
    common->method[0].ordering = CHOLMOD_AMD;
    common->postorder = 1;
    common->supernodal = CHOLMOD_SUPERNODAL;
    common->print = 0;
    cholmod_factor *symbolic = cholmod_analyze(sparse->matrix, common);
    if (!symbolic && common->status == CHOLMOD_TOO_LARGE)
        return error_input("%zu equations: the factor of their matrix exceeds the integers of CHOLMOD: cut the packing",
                           unknowns);
    if (!symbolic)
        return error_memory("matrix factor");
    const struct supernodes supernodes = {.unknowns = unknowns,
                                          .count = symbolic->nsuper,
                                          .first = symbolic->super,
                                          .begin = symbolic->pi,
                                          .row = symbolic->s,
                                          .order = symbolic->Perm};
    sparse->factor = supernodal_create(&supernodes, sparse->matrix->p, sparse->matrix->i);
    cholmod_free_factor(&symbolic, common);
    sparse->defect = calloc(unknowns + 1, sizeof(double));
    sparse->correction = calloc(unknowns + 1, sizeof(double));
    if (!sparse->factor || !sparse->defect || !sparse->correction)
        return error_memory("matrix factor");
    return 0;
}

struct sparse *sparse_create(size_t unknowns, size_t blocks, int width, const int *place)
{
    struct sparse *sparse = calloc(1, sizeof *sparse);
    struct pattern pattern = {0};
    if (!sparse) {
        error_set(EXIT_FAILED, "out of memory: matrix");
        return NULL;
    }
    cholmod_start(&sparse->common);
    int failed = pattern_fill(unknowns, blocks, width, place, &pattern) ||
                 matrix_from_pattern(sparse, unknowns, &pattern, pattern_compress(unknowns, &pattern)) ||
                 find_slots(sparse, blocks, width, place) || analyse(sparse);
    free(pattern.starts);
    free(pattern.rows);
    if (!failed)
        return sparse;
    sparse_free(sparse);
    return NULL;
}

void sparse_free(struct sparse *sparse)
{
    if (!sparse)
        return;
    cholmod_common *common = &sparse->common;
    cholmod_free_sparse(&sparse->matrix, common);
    cholmod_finish(common);
    supernodal_free(sparse->factor);
    free(sparse->defect);
    free(sparse->correction);
    free(sparse->slot);
    free(sparse->diagonal);
    free(sparse);
}

void sparse_clear(struct sparse *sparse)
{
    const int *p = sparse->matrix->p;
    memset(sparse->matrix->x, 0, (size_t)p[sparse->matrix->ncol] * sizeof(double));
}

void sparse_add(struct sparse *sparse, size_t block, const double *values)
{
    const int *slot = sparse->slot + block * (size_t)sparse->triangle;
    double *x = sparse->matrix->x;
    for (int i = 0; i < sparse->width; i++)
        for (int j = 0; j <= i; j++, slot++)
            if (*slot >= 0)
                x[*slot] += values[i * sparse->width + j];
}

void sparse_add_diagonal(struct sparse *sparse, const double *values, double constant)
{
    double *x = sparse->matrix->x;
    for (size_t d = 0; d < sparse->matrix->nrow; d++)
        x[sparse->diagonal[d]] += (values ? values[d] : 0) + constant;
}

double sparse_largest(const struct sparse *sparse)
{
    const double *x = sparse->matrix->x;
    double largest = 0;
    for (size_t d = 0; d < sparse->matrix->nrow; d++)
        largest = fmax(largest, fabs(x[sparse->diagonal[d]]));
    return largest;
}

int sparse_factorise(struct sparse *sparse)
{
    const double *values = sparse->matrix->x;
    sparse->shifted = 0;
    if (sparse->matrix->nrow == 0)
        return 0;
    if (!supernodal_factorise(sparse->factor, values, 0, 1) && sparse_rcond(sparse) > 1e-14)
        return 0;
    double largest = sparse_largest(sparse);
    sparse->shifted = 1;
    if (!supernodal_factorise(sparse->factor, values, SPARSE_SHIFT * (largest > 0 ? largest : 1), 1))
        return 1;
    return error_input("the stiffness matrix cannot be factorised: look for absurd numbers in the file");
}

int sparse_factorise_indefinite(struct sparse *sparse)
{
    sparse->shifted = 0;
    if (sparse->matrix->nrow == 0 || !supernodal_factorise(sparse->factor, sparse->matrix->x, 0, 0))
        return 0;
    return error_input("the matrix of the joint problem cannot be factorised: look for absurd numbers in the files");
}

int sparse_solve(struct sparse *sparse, const double *right, double *solution)
{
    size_t n = sparse->matrix->nrow;
    if (n == 0)
        return 0;
    supernodal_solve(sparse->factor, right, solution);
    for (int k = 0; k < REFINEMENTS && sparse->shifted; k++) {
        cholmod_dense x = {.nrow = n, .ncol = 1, .nzmax = n, .d = n, .x = solution, .xtype = CHOLMOD_REAL};
        cholmod_dense r = {.nrow = n, .ncol = 1, .nzmax = n, .d = n, .x = sparse->defect, .xtype = CHOLMOD_REAL};
        double minus[2] = {-1, 0}, one[2] = {1, 0};
        memcpy(sparse->defect, right, n * sizeof *right);
        if (!cholmod_sdmult(sparse->matrix, 0, minus, one, &x, &r, &sparse->common))
            return error_memory("refinement");
        supernodal_solve(sparse->factor, sparse->defect, sparse->correction);
        for (size_t d = 0; d < n; d++)
            solution[d] += sparse->correction[d];
    }
    return 0;
}

double sparse_rcond(struct sparse *sparse)
{
    return supernodal_rcond(sparse->factor);
}
