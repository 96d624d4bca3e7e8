/* From what was found in the photo to the columns of the file. */
#ifndef TRACKER_FILL_TRACKS_H
#define TRACKER_FILL_TRACKS_H

#include "tracker/follow/drift.h"
#include "tracker/search/target.h"
#include "pipeline/packing/grains.h"
#include "pipeline/packing/patches.h"
#include "tracker/follow/track_options.h"

/* Rows for the `grains` of the reference, one target and one outcome each, into the empty table `tracks`. lens NULL:
 * none. camera->known 0: drift is not known, and every grain is lost. previous NULL: no dx_px, dy_px, dangle. 0, or -1
 * when memory is gone; the caller frees the table in any case. */
int tracks_of_grains(const struct photo_grains *grains, const struct target *targets, const struct outcome *outcomes,
                     const struct lens *lens, const struct camera *camera, const struct photo_grains *previous,
                     struct photo_grains *tracks);
/* The same for drift patches (which show the camera's motion and keep it), then the markers of the walls. */
int tracks_of_patches(const struct tracker_options *options, const struct target *targets,
                      const struct outcome *outcomes, const struct camera *camera, struct patches *patches);

#endif
