/* The public call of the tracker (CONTRIBUTING.md, "Public headers"): the scene says everything, no options are needed.
 */
#ifndef TRACKER_TRACK_PHOTO_H
#define TRACKER_TRACK_PHOTO_H

#include "pipeline/packing/grains.h"
#include "pipeline/packing/patches.h"
#include "pipeline/scene/photo.h"
#include "pipeline/scene/scene.h"

/* Where are the grains of the reference photo in `photo`, of the same size? grains: x_px y_px radius_px as seen in the
 * reference (grains_in_photo()). previous: what this call found in the photo before, the same rows, which only says
 * where to look first; NULL: none. From the scene: drift_patches_px, frame.markers_px, lens, section "tracker".
 *
 * Fills the empty tables `tracked`, the same rows as grains: x_px y_px (px) and angle (rad, counter-clockwise as seen)
 * with lens and camera undone, the same as seen (x_seen_px ...), motions since the photo before (dx_px dy_px dangle),
 * standard errors, zncc; and `patches`: paper, then markers. A grain that is lost keeps its row, NaN, and is flagged.
 * Images are matched by the zero-mean normalised cross-correlation with the inverse-compositional Gauss-Newton method
 * (Baker and Matthews 2004; docs/tracker.md).
 *
 * Inputs stay the caller's; the results are to be freed by table_free() with PHOTO_GRAINS and PATCHES; after a failure
 * they are empty. 0, or -1 with a line (pipeline/speak/error.h): tables or photos that do not fit each other, a wrong
 * scene or lens (EXIT_INPUT); memory is gone (EXIT_FAILED). */
int track_photo(const struct scene *scene, const struct photo *reference, const struct photo_grains *grains,
                const struct photo *photo, const struct photo_grains *previous, struct photo_grains *tracked,
                struct patches *patches);

#endif
