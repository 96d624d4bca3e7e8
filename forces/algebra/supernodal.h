/* Numeric factorisation A = L D L' without pivoting (quasi-definite matrices: Vanderbei 1995) and solves, in dense
 * blocks: left-looking over the supernodes of a symbolic analysis (Ng and Peyton 1993). Rods have three unknowns, or
 * six with their errors, so that even small packings are made of dense blocks. The result does not depend on threads or
 * on a BLAS. */
#ifndef FORCES_SUPERNODAL_H
#define FORCES_SUPERNODAL_H

#include <stddef.h>

struct supernodal;

/* Where `row` stands among the ascending rows[begin] .. rows[end - 1], of which it is one. */
static inline int sorted_find(const int *rows, int begin, int end, int row)
{
    while (begin < end - 1) {
        int middle = begin + (end - 1 - begin) / 2;
        begin = rows[middle] < row ? middle + 1 : begin;
        end = rows[middle] < row ? end : middle + 1;
    }
    return begin;
}

/* A symbolic analysis: supernode s holds the columns first[s] .. first[s + 1] - 1 of the ordered matrix; its rows are
 * row[begin[s]] .. row[begin[s + 1] - 1], ascending, its own columns among them. */
struct supernodes {
    size_t unknowns, count;
    const int *first, *begin, *row;
    const int *order; /* column k of the ordered matrix is unknown order[k] */
};

/* For a matrix whose lower triangle has the compressed columns (start, row). NULL: out of memory. */
struct supernodal *supernodal_create(const struct supernodes *supernodes, const int *start, const int *row);
void supernodal_free(struct supernodal *factor); /* NULL is fine */

/* Of the values of that lower triangle, plus `shift` on the diagonal. 0; 1: a pivot was zero or not finite, or, when
 * `definite`, not positive. */
int supernodal_factorise(struct supernodal *factor, const double *values, double shift, int definite);
/* L D L' x = right, with the last factor, which must have been successful. */
void supernodal_solve(struct supernodal *factor, const double *right, double *solution);
/* Smallest over largest pivot: a rough reciprocal condition number. */
double supernodal_rcond(const struct supernodal *factor);

#endif
