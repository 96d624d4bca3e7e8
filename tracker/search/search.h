/* Where can this piece of the reference be? Normalised cross-correlation over every shift and angle in reach, on a
 * level of the pyramid where the disc is small, then IC-GN from the best places down to full size. */
#ifndef TRACKER_SEARCH_H
#define TRACKER_SEARCH_H

#include "tracker/search/icgn.h"
#include "tracker/subset/pyramid.h"

struct search_reach {
    double px;    /* shifts up to here, to each side */
    double angle; /* rad, to each side */
};

enum { SEARCH_CANDIDATES = 4 };

struct search_workspace {
    float *values;
    size_t capacity;
    struct patch patch;
};
void search_workspace_free(struct search_workspace *workspace); /* accepts a zeroed struct */

/* The best distinct places, at most SEARCH_CANDIDATES, best first by their ZNCC where they were last refined; good
 * enough to start IC-GN on the photo itself. */
struct search_place {
    struct motion motion;
    double zncc;
};
/* Of `shape` (reference, px) around the motion `around`; *count: how many places; 0 when the shape shows no texture. 0,
 * or -1 when memory is gone. The workspace is a thread's own. */
int search_places(const struct pyramid *reference, const struct pyramid *photo, const struct shape *shape,
                  struct motion around, const struct search_reach *reach, struct search_workspace *workspace,
                  struct search_place places[SEARCH_CANDIDATES], int *count);

#endif
