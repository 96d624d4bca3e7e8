/* The lens from photos of one plate that is moved rigidly: what deviates from a rigid motion is distortion. */
#ifndef CALIBRATION_LENS_FIT_H
#define CALIBRATION_LENS_FIT_H

#include "calibration/lens/lens_points.h"
#include "pipeline/scene/lens.h"

struct lens_fitted {
    struct lens lens;
    double covariance[LENS_UNKNOWNS][LENS_UNKNOWNS]; /* of centre x y, K1-K3, P1-P3 in the file's units */
    double rms;                                      /* px: what is left per component, over the points used */
    double s_map;   /* px: standard error of the corrected positions over the photo, rigid motions aside */
    double largest; /* px: largest correction in the photo, rigid motions and scale aside */
    double motions[LENS_PHOTOS_MAX][3]; /* of the plate in each photo, about the middle of the photo: px, px, rad */
    size_t used, left_out;              /* measurements; left out: more than LENS_OUTLIER errors off */
};
#define LENS_OUTLIER 5.0

/* Largest s_map that is worth a file, px. */
#define LENS_USEFUL 0.1

/* Levenberg and Marquardt over lens and motions together. Refused with a reason: too few photos or points, motions
 * that do not determine the lens (s_map above LENS_USEFUL). */
int lens_fit(const struct lens_points *points, struct lens_fitted *fitted);

/* What is left of point k in a photo: corrected position less where the plate's motion carries it, px. */
struct vec lens_residual(const struct lens_points *points, const struct lens_fitted *fitted, size_t photo, size_t k);

#endif
