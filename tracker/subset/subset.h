/* The part of the reference photo that is followed: a disc (grain) or a rectangle (paper, marker), with everything
 * that an iteration needs, computed once.
 *
 * Model: photo(W(p)) = gain * reference(p) + offset + blur * laplacian(p) + noise. With the slopes
 * J = (gx, gy, gx dy - gy dx) an iteration solves Z' (photo - model) = 0, where the instruments Z are slopes of the
 * smoothed reference, made orthogonal to {1, reference, laplacian}: gain, offset and a change of focus drop out
 * exactly, and an iteration is four dot products. Smoothing Z instead of both photos is the same estimate (Z' S T =
 * (S Z)' T): it does not see the finest detail, which pixels and splines render with the wrong phase. */
#ifndef TRACKER_SUBSET_H
#define TRACKER_SUBSET_H

#include "tracker/subset/runs.h"

enum { SUBSET_ZX, SUBSET_ZY, SUBSET_ZA, SUBSET_GREY, SUBSET_PLANES };

struct subset {
    struct shape shape;
    size_t count, run_count; /* pixels, runs; 0 pixels: nothing could be used */
    struct run *runs;
    float *planes;           /* SUBSET_PLANES arrays of `count`: Z, grey minus its mean */
    float *blur;             /* the Laplacian, orthogonal to {1, grey}, of the sampled runs one after the other */
    size_t sampled;          /* their pixels */
    int every;               /* every n-th strip is sampled; 0, 1: all */
    double mean;             /* grey */
    double energy;           /* sum of (grey - mean)^2 */
    double hessian[3][3];    /* Z'J */
    double inverse[3][3];    /* of the hessian */
    double instrument[3][3]; /* Z'Z */
    double noise_hessian[3]; /* what pixel noise of variance 1 adds to its diagonal */
    double speckle;          /* px: correlation length of the texture, sqrt(variance / mean squared slope) */
    double speckle_count;    /* independent specks: textured pixels / (pi speckle^2) */
    double used;             /* share of the shape's pixels that is used */
    size_t saturated;        /* pixels left out at the upper end of the grey range */
};

/* Strips of rows on which the scatter of the residual is measured (scatter.h). */
enum { SUBSET_STRIP = 8, SUBSET_ENOUGH = 6000 };
static inline int subset_strip(const struct subset *subset, size_t run)
{
    return (subset->runs[run].y - subset->runs[0].y) / SUBSET_STRIP;
}
static inline int subset_sampled(const struct subset *subset, size_t run)
{
    return subset->every < 2 || subset_strip(subset, run) % subset->every == 0;
}

/* A subset of the reference with everything that iterations need; to be freed. mask NULL: every pixel may be used. 0,
 * or -1 when memory is gone (nothing is to be freed then). A shape without texture, or with fewer than 16 pixels that
 * may be used, gives a subset that is not usable. */
int subset_build(const struct photo *reference, const struct shape *shape, const struct subset_mask *mask,
                 struct subset *subset);
/* Can a match be looked for? 16 pixels at least, and texture in both directions. */
int subset_usable(const struct subset *subset);
/* inverse = h^-1; 0 (and no inverse) when its determinant is not well above zero. */
int subset_invert(double (*h)[3], double (*inverse)[3]);
void subset_free(struct subset *subset); /* accepts a zeroed struct */

#endif
