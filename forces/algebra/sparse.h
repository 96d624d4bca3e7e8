/* Sparse symmetric systems that are sums of small dense blocks, one per contact. The pattern is analysed once by
 * CHOLMOD (Chen, Davis, Hager and Rajamanickam 2008), which is called only here; values change as often as needed and
 * are factorised by supernodal.c. */
#ifndef FORCES_SPARSE_H
#define FORCES_SPARSE_H

#include <stddef.h>

struct sparse;

/* A system of `unknowns` equations, all zero; NULL, with an error: no memory, or more entries than integers. Block b
 * couples the unknowns place[b * width .. + width - 1], -1: none. */
struct sparse *sparse_create(size_t unknowns, size_t blocks, int width, const int *place);
void sparse_free(struct sparse *sparse); /* NULL is fine */

void sparse_clear(struct sparse *sparse); /* all values 0, the pattern stays */
/* Add a symmetric width x width block (only j <= i is read). */
void sparse_add(struct sparse *sparse, size_t block, const double *values);
/* Add to the diagonal: value[d] (NULL: none) + constant. */
void sparse_add_diagonal(struct sparse *sparse, const double *values, double constant);
/* Largest diagonal entry as assembled. */
double sparse_largest(const struct sparse *sparse);

/* 0: factorised as it is; 1: not positive definite, so the diagonal was shifted by SPARSE_SHIFT times its largest
 * entry; -1: failed. sparse_solve() then refines against the matrix without the shift. */
#define SPARSE_SHIFT 1e-10
int sparse_factorise(struct sparse *sparse);
/* Quasi-definite (Vanderbei 1995): factorised as L D L' without pivoting. 0 or -1. */
int sparse_factorise_indefinite(struct sparse *sparse);
/* With the last factor; `right` stays as it is and may not be `solution`. 0 or -1. */
int sparse_solve(struct sparse *sparse, const double *right, double *solution);
/* Rough reciprocal condition number of the last factor: smallest over largest pivot. */
double sparse_rcond(struct sparse *sparse);

#endif
