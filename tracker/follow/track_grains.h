/* Follow the grains of a reference photo into other photos. Every photo is compared with the same reference, so errors
 * do not add up; the photo before only says where to look. */
#ifndef TRACKER_TRACK_GRAINS_H
#define TRACKER_TRACK_GRAINS_H

#include "pipeline/packing/grains.h"
#include "pipeline/scene/lens.h"
#include "pipeline/packing/patches.h"
#include "pipeline/scene/photo.h"
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

/* The same rows as the reference's grains; patches: drift first, then walls. */
struct tracks {
    struct photo_grains grains;
    struct patches patches;
};
void tracks_free(struct tracks *tracks); /* accepts a zeroed struct */

/* One reference, any number of photos. The reference photo and the grains (as seen) are borrowed. */
struct tracker;
struct tracker *tracker_open(const struct photo *reference, const struct photo_grains *grains,
                             const struct tracker_options *options);
/* `previous`: what this or an earlier run found in the photo before; NULL: none. `tracks` is empty before. */
int tracker_follow(struct tracker *tracker, const struct photo *photo, const struct photo_grains *previous,
                   struct tracks *tracks);
void tracker_close(struct tracker *tracker); /* NULL is fine */

/* All three for one photo. */
int track_grains(const struct photo *reference, const struct photo_grains *grains, const struct photo *photo,
                 const struct photo_grains *previous, const struct tracker_options *options, struct tracks *tracks);

/* Rows that are not to be trusted. */
size_t tracks_flagged(const struct tracks *tracks);

#endif
