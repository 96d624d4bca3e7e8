/* The photo with the circles that were found: green, flagged ones red, the specimen zone blue. */
#ifndef FINDGRAINS_OVERLAY_H
#define FINDGRAINS_OVERLAY_H

#include "pipeline/grains.h"
#include "pipeline/photo.h"
#include "findgrains/find_grains.h"

#define OVERLAY_SIDE 4000 /* px of the picture's longer side at most; small photos are magnified up to 4 times */

int overlay_write(const char *path, const struct photo *photo, const struct photo_grains *grains,
                  const struct find_notes *notes);

#endif
