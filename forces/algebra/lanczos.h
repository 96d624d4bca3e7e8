/* The smallest eigenvalue of a large symmetric matrix K, with its motion, by shifted inverse Lanczos iteration
 * (Ericsson and Ruhe 1980). */
#ifndef FORCES_LANCZOS_H
#define FORCES_LANCZOS_H

#include <stddef.h>

struct lanczos {
    size_t n; /* unknowns */
    /* out = K x; out = (K + shift)^-1 x, the shift such that K + shift is positive definite. 0 or -1. */
    int (*multiply)(void *user, const double *x, double *out);
    int (*solve)(void *user, const double *x, double *out);
    void *user;       /* handed to both */
    double tolerance; /* of |K x - value x|, |x| = 1 */
};

/* Ends when *defect is within the tolerance, or after a fixed number of steps: the caller judges *defect. x has |x|
 * = 1. With n = 0 *value is NaN. 0; -1: memory is gone, or a product or solve failed. *value: Rayleigh's quotient of x,
 * never below the smallest eigenvalue; its error is about *defect squared over the gap to the next one, *defect = |K x
 * - value x|. */
int lanczos_smallest(const struct lanczos *problem, double *value, double *x, double *defect);

#endif
