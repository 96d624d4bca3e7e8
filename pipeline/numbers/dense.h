/* Linear systems of a few unknowns in dense matrices. Element (i, j) of a matrix stands at m[i * apart + j]: `apart` is
 * the length of a row as declared, so that the leading n rows and columns of a larger array are used in place.
 *
 * All are for symmetric positive definite matrices, those of least squares; rows are not exchanged. `least` is what a
 * pivot, the diagonal element that elimination has left, must exceed to be more than rounding. All return 0, or -1
 * without an error line when a pivot does not (the matrix is singular, or not finite): its content is undefined then.
 */
#ifndef PIPELINE_DENSE_H
#define PIPELINE_DENSE_H

#include <stddef.h>

enum { DENSE_MOST = 8 }; /* unknowns of dense_invert() */

/* m = L L' (Cholesky): the lower triangle, which alone is read, becomes L. least: a share of the diagonal element. */
int dense_factorise(double *m, size_t n, size_t apart, double least);
/* x becomes (L L')^-1 x, with L of dense_factorise(). */
void dense_substitute(const double *m, size_t n, size_t apart, double *x);
/* m becomes its inverse. n <= DENSE_MOST. least: a share of the diagonal element. */
int dense_invert(double *m, size_t n, size_t apart, double least);
/* Solves the system of the first n columns for the right-hand side in column n, where it leaves the solution. least:
 * in the unit of the diagonal. */
int dense_solve(double *m, size_t n, size_t apart, double least);

#endif
