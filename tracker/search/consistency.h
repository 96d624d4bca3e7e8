/* What one grain cannot know: is its match as good as that of the others in this photo, does it move with its
 * neighbours, is its place free? */
#ifndef TRACKER_CONSISTENCY_H
#define TRACKER_CONSISTENCY_H

#include "tracker/search/neighbours.h"

/* A match that leaves far more than the usual noise of this photo (three times the median of the good ones, where there
 * are eight or more) is doubtful, unless its ZNCC is beyond doubt: found 2 becomes 1. 0, or -1 when memory is gone;
 * nothing is changed then. */
int consistency_demote(struct outcome *outcomes, size_t count);

/* Sets `contradicted` where a grain that a search brought in sits on another one, or has left its neighbours by more
 * than its radius. `grain_radius[k]`: rim, px. */
void consistency_check(const struct target *targets, const double *grain_radius, const long *nearest,
                       struct outcome *outcomes, size_t count);

#endif
