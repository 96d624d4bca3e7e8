/* What a run of the tracker is told beside photos and grains. Defaults: TRACKER_DEFAULT; the command line and the scene
 * keep the numbers in range (tracker_options.h). */
#ifndef TRACKER_TRACK_OPTIONS_H
#define TRACKER_TRACK_OPTIONS_H

#include <stddef.h>

#include "pipeline/scene/lens.h"
#include "pipeline/scene/scene.h"

struct tracker_options {
    double subset;            /* radius of the subset over that of the grain */
    double search_px;         /* a lost grain is searched this far from where it is expected, to each side */
    double search_deg;        /* and turned this far */
    const struct rect *drift; /* fixed speckled paper in the reference; borrowed */
    size_t drift_count;
    const struct scene_marker *markers; /* speckled marks on walls; borrowed */
    size_t marker_count;
    const struct lens *lens; /* NULL: none; borrowed */
    int keep;                /* keep the subsets of the reference for the next photo: 16 bytes per pixel */
};
#define TRACKER_SUBSET 0.8
#define TRACKER_SEARCH_PX 64
#define TRACKER_SEARCH_DEG 60
#define TRACKER_DEFAULT                                                                                                \
    {                                                                                                                  \
        .subset = TRACKER_SUBSET, .search_px = TRACKER_SEARCH_PX, .search_deg = TRACKER_SEARCH_DEG                     \
    }

#endif
