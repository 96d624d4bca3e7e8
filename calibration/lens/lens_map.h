/* What a difference of lenses looks like in the photo. */
#ifndef CALIBRATION_LENS_MAP_H
#define CALIBRATION_LENS_MAP_H

#include "calibration/lens/lens_model.h"

/* Root mean square over the photo, per component, of the difference between two lenses, after the rigid motion and
 * scale that bring them closest: what cannot be seen of a lens is not counted. *largest (may be NULL): at most. */
double lens_difference(const struct lens *a, const struct lens *b, int width, int height, double *largest);

/* Standard error of the map over the photo, rigid motion and scale aside. */
double map_error(const struct problem *problem, const double *q, double covariance[LENS_UNKNOWNS][LENS_UNKNOWNS]);

#endif
