/* The photo with the circles that were found and the number of their row inside, where there is room for it: sky blue,
 * flagged ones vermillion, dashed and thicker; the frame yellow; ticks in px of the photo around it, a caption below.
 */
#ifndef FINDGRAINS_OVERLAY_H
#define FINDGRAINS_OVERLAY_H

#include "pipeline/packing/grains.h"
#include "pipeline/scene/photo.h"
#include "findgrains/find_grains.h"

/* Pictures are PNG: an error for other endings, to be asked before the work. NULL (no picture) is fine. */
int overlay_check_path(const char *path);
/* A whole PNG or none: px are shown as they are, so that a place in the picture is one in the photo (overlay_scale.h).
 * -1: disk, memory, or a picture larger than cairo makes. */
int overlay_write(const char *path, const struct photo *photo, const struct photo_grains *grains,
                  const struct find_notes *notes);

#endif
