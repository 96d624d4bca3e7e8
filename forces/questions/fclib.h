/* The contact problem of cdm as a file in the Local form of FCLib (Acary, Bremond, Koziara, Perignon 2014), which
 * Siconos and other solvers read: u = W r + q, Signorini's and Coulomb's laws between u and r. */
#ifndef FORCES_FCLIB_H
#define FORCES_FCLIB_H

#include "forces/network/force_options.h"
#include "forces/network/network.h"

/* W = A' M^-1 A in compressed columns (sorted rows), q = A' M^-1 b; rows 2 c (normal) and 2 c + 1 (tangential) of
 * contact c of the network, in working units. */
struct local_problem {
    int rows, entries;
    int *start, *row; /* rows + 1, entries */
    double *value;    /* entries */
    double *q, *mu;   /* per row, per contact */
};
/* 0, or -1 with an empty problem. */
int local_problem_build(const struct network *network, struct local_problem *problem);
void local_problem_free(struct local_problem *problem); /* accepts a zeroed struct */

/* Write the problem of a packing; the file is whole or absent. */
int fclib_write(const char *path, const struct packing *packing, const struct force_options *options);

#endif
