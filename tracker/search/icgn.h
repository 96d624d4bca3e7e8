/* Inverse-compositional Gauss-Newton (Baker and Matthews 2004) for a rigid motion of a subset, with exact gain and
 * offset, on a B-spline of the searched photo. The estimate stands on the Cramer-Rao bound (note "tracking"). */
#ifndef TRACKER_ICGN_H
#define TRACKER_ICGN_H

#include "tracker/subset/bspline.h"
#include "tracker/subset/rigid_motion.h"
#include "tracker/subset/subset.h"

struct icgn_options {
    double tolerance; /* px: the iteration stops when a step moves the rim by less */
    double reach;     /* px: it gives up when it leaves its start by more, at the rim */
    int iterations;   /* at most */
    int coarse;       /* never take the quintic spline */
};
#define ICGN_TOLERANCE 0.01
#define ICGN_REACH 8.0
#define ICGN_ITERATIONS 25
#define ICGN_DEFAULT                                                                                                   \
    {                                                                                                                  \
        .tolerance = ICGN_TOLERANCE, .reach = ICGN_REACH, .iterations = ICGN_ITERATIONS                                \
    }

/* A match: where the subset is, how well that is known, and how like the photo is to the reference there. */
struct fit {
    struct motion motion;
    double covariance[3][3]; /* of u, v, angle: px, px, rad */
    double zncc;
    double gain;          /* of the photo over the reference */
    double offset, white; /* of its grey values; Var(Z'e) over s2 Z'Z that white pixel noise would give (scatter.h) */
    double noise;         /* grey values: pixel noise in each of the two photos, from what is left */
    int iterations;
    int near;      /* the last step was short: what is left is noise */
    int fine;      /* finished on the quintic spline */
    int converged; /* 0: zncc is what the last position had, the motion is not to be trusted */
};

/* The largest error of phase that the spline's shortcomings cause in nearly pure translation, px, measured on drawn
 * speckle (bench_tracker --only bias) as a power of its correlation length. */
double icgn_cubic_bias(double speckle);

/* Half the width and height of the box around the shape turned by `angle`. */
void icgn_extent(const struct shape *shape, double angle, double *half_w, double *half_h);
/* Is every pixel of the moved shape inside the photo, with room for the spline? */
int icgn_inside(const struct shape *shape, const struct motion *motion, const struct photo *photo);

/* From `start` to the nearest match. fit->converged 0 is no failure: the iteration strayed by more than options->reach,
 * took too many steps, or found nothing to follow. -1: memory is gone. The subset is usable (subset_usable); where its
 * warp leaves the photo, mirrored pixels stand. `patch` is workspace, a thread's own; it may hold a patch of another
 * photo. */
int icgn_fit(const struct subset *subset, const struct photo *photo, struct motion start,
             const struct icgn_options *options, struct patch *patch, struct fit *fit);

#endif
