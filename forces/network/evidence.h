/* What is known about the forces besides equilibrium and friction, in working units, for map:
 *
 *     fn + B e + r = m      per measured contact: m = kn overlap; e the errors of places, radii and walls, which
 *                           neighbouring contacts share; r what is left, of variance `slack`
 *     f ~ N(prior, variance) a wide belief for contacts that say nothing
 */
#ifndef FORCES_EVIDENCE_H
#define FORCES_EVIDENCE_H

#include "forces/network/force_options.h"
#include "forces/network/equations.h"

enum { EVIDENCE_WIDTH = 6 }; /* x, y, radius of two grains, or of a grain and the offset of a wall */

struct evidence {
    size_t count, dofs;
    double *store;                   /* all arrays of doubles below */
    double *prior, *variance;        /* f0 and its variance, (fn, ft) per contact */
    double *measured;                /* m; NaN: none */
    double *slack;                   /* variance of r */
    size_t errors;                   /* standardised error unknowns, each N(0, 1) */
    int (*place)[EVIDENCE_WIDTH];    /* -1: none */
    double (*share)[EVIDENCE_WIDTH]; /* B times the standard error of that unknown */
    double *probability;             /* that the contact is closed */
    int friction;                    /* nothing is known of ft but Coulomb's law */
    int barrier;                     /* the mean of the posterior is sought; 0: the forces nearest to the start */
    double *soft;                    /* per degree of freedom: variance of an unknown load (a partner was missed) */
};

/* 0; -1, with nothing to free: an overlap is not finite, or memory is gone.
 * Evidence of the packing's overlaps; with options->start zero or mean there are none. A start that is not made of
 * overlaps (previous, file, cem) is the prior. f: the start forces. */
int evidence_build(const struct packing *packing, const struct network *network, const struct force_options *options,
                   const double *f, struct evidence *evidence);
/* Nothing is known: no overlaps, no belief yet, every contact certain. */
int evidence_blank(const struct network *network, struct evidence *evidence);
/* All of `from`, in arrays of its own. */
int evidence_copy(const struct evidence *from, struct evidence *to);
void evidence_free(struct evidence *evidence); /* accepts a zeroed struct */

#endif
