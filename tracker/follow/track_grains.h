/* Follow the grains of a reference photo into other photos. Every photo is compared with the same reference, so errors
 * do not add up; the photo before only says where to look. The numbers do not depend on the number of threads.
 *
 * Errors, -1 or NULL with a line (pipeline/speak/error.h): memory is gone; a photo or table does not fit the reference
 * (EXIT_INPUT). A grain that cannot be followed is no error: its row is flagged. */
#ifndef TRACKER_TRACK_GRAINS_H
#define TRACKER_TRACK_GRAINS_H

#include "pipeline/scene/photo.h"
#include "tracker/follow/track_options.h"
#include "tracker/follow/tracks.h"

/* One reference, any number of photos. The reference photo, the grains (x_px, y_px, radius_px as seen in it, px) and
 * what the options borrow must outlive the tracker; to be closed. */
struct tracker;
struct tracker *tracker_open(const struct photo *reference, const struct photo_grains *grains,
                             const struct tracker_options *options);
/* The grains in `photo`, of the reference's size. `previous`: what this or an earlier run found in the photo before
 * (the same rows); NULL: none. `tracks` is empty before, and after a failure; to be freed. */
int tracker_follow(struct tracker *tracker, const struct photo *photo, const struct photo_grains *previous,
                   struct tracks *tracks);
void tracker_close(struct tracker *tracker); /* NULL is fine */

/* All three for one photo. */
int track_grains(const struct photo *reference, const struct photo_grains *grains, const struct photo *photo,
                 const struct photo_grains *previous, const struct tracker_options *options, struct tracks *tracks);

#endif
