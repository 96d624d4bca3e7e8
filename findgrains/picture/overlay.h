/* The photo with the circles that were found and the number of their row inside, where there is room for it: sky blue,
 * flagged ones vermillion, dashed and thicker; the frame yellow; ticks in px of the photo around it, a caption below.
 */
#ifndef FINDGRAINS_OVERLAY_H
#define FINDGRAINS_OVERLAY_H

#include "pipeline/packing/grains.h"
#include "pipeline/scene/photo.h"
#include "findgrains/find_grains.h"

#define OVERLAY_SIDE                                                                                                   \
    4000.0 /* px of the longer side of the drawn photo at most; larger photos are shrunk to 1/2, 1/3 ... */
#define OVERLAY_ZOOM 4.0 /* smaller ones are magnified so many times at most */

/* Of the colours that people with any colour vision tell apart (Okabe and Ito 2008), as report map has them. */
#define OVERLAY_SKY 0.337, 0.706, 0.914
#define OVERLAY_VERMILLION 0.835, 0.369, 0.000
#define OVERLAY_YELLOW 0.941, 0.894, 0.259
#define OVERLAY_INK 0.133, 0.133, 0.133

/* Pictures are PNG: an error for other endings, to be asked before the work. NULL (no picture) is fine. */
int overlay_check_path(const char *path);
int overlay_write(const char *path, const struct photo *photo, const struct photo_grains *grains,
                  const struct find_notes *notes);
/* Give back the fonts that cairo keeps for the life of a process; call it last. */
void overlay_forget_fonts(void);

#endif
