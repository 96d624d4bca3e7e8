/* What is found in one photo. */
#ifndef TRACKER_TRACKS_H
#define TRACKER_TRACKS_H

#include "pipeline/packing/grains.h"
#include "pipeline/packing/patches.h"

/* grains: the same rows as the reference's, px and rad, lens and camera undone (x_px, y_px, angle) and as the photo
 * shows them (x_seen_px, y_seen_px, angle_seen); dx_px, dy_px, dangle since the photo before; NaN where a grain is
 * lost, and flags that say why. patches: paper first, then the markers of the walls. */
struct tracks {
    struct photo_grains grains;
    struct patches patches;
};
void tracks_free(struct tracks *tracks); /* accepts a zeroed struct */

/* Number of grains that are not to be trusted (GRAIN_DISTRUST). */
size_t tracks_flagged(const struct tracks *tracks);

#endif
