/* The scene's part of the tracker: {"tracker": {"subset": 0.8, "search_px": 64, "search_deg": 60}}, the patches of
 * paper and the markers of the walls. */
#ifndef TRACKER_TRACKER_OPTIONS_H
#define TRACKER_TRACKER_OPTIONS_H

#include "tracker/follow/track_grains.h"

/* The rectangles stay the scene's; the lens, a file of its own, is not read here. */
int tracker_options_read(const struct scene *scene, struct tracker_options *options);
/* JSON text of what changes numbers, to be freed with free(). NULL: out of memory. */
char *tracker_options_print(const struct tracker_options *options);

#endif
