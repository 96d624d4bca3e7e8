/* All grains of a photo, roughly: votes and capture at coarse pixels, octave by octave of the radius, from the largest
 * down. What is sure in one octave is covered in the next, so that specks inside grains cost nothing there. */
#ifndef FINDGRAINS_DETECT_H
#define FINDGRAINS_DETECT_H

#include "findgrains/capture/candidates.h"
#include "findgrains/look/threshold.h"

#define DETECT_OVERLAP 0.88    /* centres of two grains are at least this share of R_i + R_j apart */
#define DETECT_VOTE_RADIUS 7.0 /* pixels of an octave's smallest radius while voting */
#define DETECT_SMALLEST 3.0    /* px: radii below are never looked for unless they are given */

/* Rims in photo coordinates, thinned. range: radii to look for, px; NaN: from half the zone's smaller side down to the
 * first octave that shows hardly any grain while larger ones did (or DETECT_SMALLEST), and the range that was searched
 * is put there. `peaks` counts the places that were looked at. */
int detect_grains(const struct photo *photo, const struct zone *zone, const struct grey_levels *levels, double range[2],
                  struct candidates *found, size_t *peaks);
/* The same at another pixel of the votes (vote_radius: pixels of the smallest radius of an octave): speed against
 * error, for benches. */
int detect_grains_at(double vote_radius, const struct photo *photo, const struct zone *zone,
                     const struct grey_levels *levels, double range[2], struct candidates *found, size_t *peaks);

#endif
