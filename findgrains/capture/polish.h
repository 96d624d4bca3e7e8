/* From a rim captured at coarse pixels to within a few tenths of a pixel, on the photo itself: along rays the place
 * where it falls most from inside to outside, and a robust circle through those places. */
#ifndef FINDGRAINS_POLISH_H
#define FINDGRAINS_POLISH_H

#include "findgrains/capture/candidates.h"
#include "findgrains/look/threshold.h"

/* Moves the rims of the list and tightens their spreads; a rim that is not confirmed stays as it is. Sets `captured`
 * and `sure`. */
void polish_rims(const struct photo *photo, const struct grey_levels *levels, struct candidates *list);

#endif
