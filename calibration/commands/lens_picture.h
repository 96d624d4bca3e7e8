/* The lens as a picture: what it corrects, and what is left at the followed points. */
#ifndef CALIBRATION_LENS_PICTURE_H
#define CALIBRATION_LENS_PICTURE_H

#include "calibration/lens/lens_fit.h"

/* Two panels of the photo with arrows: the correction, rigid motion and scale aside, and the residual of every point,
 * the mean over its photos; magnified so that the longest arrow fills its place, as the captions say. A PNG, SVG or PDF
 * by the path's ending, whole or not at all. */
int lens_picture(const char *path, const struct lens_points *points, const struct lens_fitted *fitted);

#endif
