/* A matrix in compressed columns (lower triangle), whose pattern never changes: each block knows the slots of its
 * entries, so that assembling is a loop of additions. CHOLMOD orders the unknowns, so that the factor fills little, and
 * finds the supernodes; its numeric factorisation is not used, since in supernodes it
 * knows definite matrices only, and rounds as its BLAS does. */
#include "forces/algebra/sparse.h"

#include <limits.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <suitesparse/cholmod.h>

#include "forces/algebra/supernodal.h"
#include "pipeline/speak/error.h"

enum { REFINEMENTS = 2 }; /* each leaves shift / (eigenvalue + shift) of the error */

struct sparse {
    cholmod_common common;
    cholmod_sparse *matrix; /* lower triangle, columns sorted */
    struct supernodal *factor;
    double *defect, *correction; /* of a refinement */
    int *slot;                   /* per block: where its lower triangle goes */
    int width, triangle;         /* of a block: its columns, the entries of its lower triangle */
    int shifted;                 /* the factor is that of the matrix with a shift on its diagonal */
};

/* One entry for each pair of a block and one on each diagonal; CHOLMOD sorts them and joins what stands there twice.
 * The diagonal comes first in its column, the triangle being the lower one. */
static cholmod_sparse *pattern(struct sparse *sparse, size_t unknowns, size_t blocks, int width, const int *place)
{
    size_t pairs = (size_t)sparse->triangle, n = 0;
    cholmod_triplet *entries =
        cholmod_allocate_triplet(unknowns, unknowns, unknowns + blocks * pairs, -1, CHOLMOD_PATTERN, &sparse->common);
    if (!entries)
        return NULL;
    int *row = entries->i, *column = entries->j;
    for (; n < unknowns; n++)
        row[n] = column[n] = (int)n;
    for (const int *block = place; block < place + blocks * (size_t)width; block += width)
        for (int i = 0; i < width; i++)
            for (int j = 0; j <= i; j++)
                if (block[i] >= 0 && block[j] >= 0) {
                    row[n] = block[i] > block[j] ? block[i] : block[j];
                    column[n++] = block[i] > block[j] ? block[j] : block[i];
                }
    entries->nnz = n;
    cholmod_sparse *matrix = cholmod_triplet_to_sparse(entries, 0, &sparse->common);
    cholmod_free_triplet(&entries, &sparse->common);
    return matrix;
}

static int build_matrix(struct sparse *sparse, size_t unknowns, size_t blocks, int width, const int *place)
{
    sparse->width = width;
    sparse->triangle = width * (width + 1) / 2;
    if (unknowns > INT_MAX || blocks > (INT_MAX - unknowns) / (size_t)sparse->triangle)
        return error_input("%zu equations: cut the packing", unknowns);
    sparse->matrix = pattern(sparse, unknowns, blocks, width, place);
    if (!sparse->matrix || !cholmod_sparse_xtype(CHOLMOD_REAL, sparse->matrix, &sparse->common))
        return error_memory("matrix");
    return 0;
}

/* Where the entry (p, q) stands among the values; -1: the block has no such unknown. */
static int find_slot(const struct sparse *sparse, int p, int q)
{
    if (p < 0 || q < 0)
        return -1;
    int row = p > q ? p : q, column = p > q ? q : p;
    const int *starts = sparse->matrix->p, *rows = sparse->matrix->i;
    return sorted_find(rows, starts[column], starts[column + 1], row);
}

static int find_slots(struct sparse *sparse, size_t blocks, int width, const int *place)
{
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
    if (!sparse) {
        error_set(EXIT_FAILED, "out of memory: matrix");
        return NULL;
    }
    cholmod_start(&sparse->common);
    if (!build_matrix(sparse, unknowns, blocks, width, place) && !find_slots(sparse, blocks, width, place) &&
        !analyse(sparse))
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
    const int *first = sparse->matrix->p;
    for (size_t d = 0; d < sparse->matrix->nrow; d++)
        x[first[d]] += (values ? values[d] : 0) + constant;
}

double sparse_largest(const struct sparse *sparse)
{
    const double *x = sparse->matrix->x;
    const int *first = sparse->matrix->p;
    double largest = 0;
    for (size_t d = 0; d < sparse->matrix->nrow; d++)
        largest = fmax(largest, fabs(x[first[d]]));
    return largest;
}

/* A packing with a mechanism (a grain that can move without any contact resisting) has a singular stiffness; so has one
 * whose pivots differ by more than rounding allows. The shift makes both solvable and refinement takes its error away
 * in every motion that meets stiffness. */
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
