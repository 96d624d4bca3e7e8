/* All grains of a photo, roughly: votes and capture at coarse pixels, octave by octave of the radius. */
#ifndef FINDGRAINS_DETECT_H
#define FINDGRAINS_DETECT_H

#include "findgrains/rim.h"
#include "findgrains/threshold.h"

#define DETECT_OVERLAP 0.88 /* centres of two grains are at least this share of R_i + R_j apart */

/* Rims in photo coordinates, thinned. `peaks` counts the places that were looked at. */
int detect_grains(const struct photo *photo, const struct zone *zone, const struct grey_levels *levels,
                  double radius_min, double radius_max, struct candidates *found, size_t *peaks);

#endif
