/* The equations of a plate behind a lens: what one measured point says of the eight unknowns and of its photo's motion.
 */
#ifndef CALIBRATION_LENS_MODEL_H
#define CALIBRATION_LENS_MODEL_H

#include "calibration/lens/lens_points.h"
#include "pipeline/scene/lens.h"

enum { MOTION = 3, SIZE_MAX_UNKNOWNS = LENS_UNKNOWNS + MOTION * LENS_PHOTOS_MAX };

struct problem {
    const struct lens_points *points;
    double half;        /* R, px */
    struct vec middle;  /* of the photo */
    const char *inside; /* photos * count: measurements that are used */
    size_t unknowns;
};

/* One measurement: residual (px) and its derivatives for the lens and for its photo's motion. */
struct row {
    struct vec residual, lens[LENS_UNKNOWNS], motion[MOTION];
};

/* `q` begins with the unknowns of the lens: centre offset / R, K1 R^2, K2 R^4, K3 R^6, P1 R, P2 R, P3 R^2. */
struct lens lens_of(const struct problem *problem, const double *q);
/* Derivatives of the corrected position with respect to the eight. */
void slopes_of(const struct problem *problem, const double *q, struct vec seen, struct vec slopes[LENS_UNKNOWNS]);
/* Of measurement m; `q`: the unknowns of the lens, then the motion of each photo (u, v, angle: px, px, rad). slopes 0:
 * the residual only. */
struct row row_of(const struct problem *problem, const double *q, size_t m, int slopes);
/* Normal equations: matrix (unknowns^2, row-major) and right-hand side, NULL: not needed; returns the weighted sum of
 * squares, priors included. */
double normal_equations(const struct problem *problem, const double *q, double *matrix, double *right);

#endif
