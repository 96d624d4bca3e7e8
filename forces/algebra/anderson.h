/* Anderson's acceleration of a fixed-point iteration x <- g(x) (Anderson 1965; Walker and Ni 2011, type II): the next
 * point is the combination of the last m images whose residual g - x is smallest in the least-squares sense. */
#ifndef FORCES_ANDERSON_H
#define FORCES_ANDERSON_H

#include <stddef.h>

enum { ANDERSON_MOST = 32 };

struct anderson {
    size_t n;                                  /* unknowns */
    int m;                                     /* columns at the most, ANDERSON_MOST or fewer; 0: no acceleration */
    int count, next;                           /* columns held, where the following one goes */
    int primed;                                /* is there a last residual? */
    double *dg, *dr;                           /* m columns: differences of images and of residuals */
    double *g, *r;                             /* last image and residual */
    double gram[ANDERSON_MOST][ANDERSON_MOST]; /* products of the columns of dr */
};

/* Without history; 0, or -1 when memory is gone (nothing is to be freed then). */
int anderson_begin(struct anderson *state, size_t n, int m);
void anderson_free(struct anderson *state);    /* accepts a zeroed struct */
void anderson_restart(struct anderson *state); /* forget the history: the next step is plain */
/* From x and its image g: the accelerated point into `out` (which may be x). */
void anderson_step(struct anderson *state, const double *x, const double *g, double *out);

#endif
