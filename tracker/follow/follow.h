/* The tracker's own data, shared by its three stories: what is kept of the reference (reference.c), how the grains of
 * one photo are found, round by round (rounds.c), and what becomes of it (track_grains.c). */
#ifndef TRACKER_FOLLOW_H
#define TRACKER_FOLLOW_H

#include "pipeline/packing/grains.h"
#include "tracker/follow/track_options.h"
#include "tracker/search/target.h"

/* A piece of paper alone is cut into 2 x 2. */
enum { QUARTERS = 4 };

struct tracker {
    const struct photo *reference;
    const struct photo_grains *grains;
    struct tracker_options options;
    struct target *targets; /* patches first, then grains */
    size_t patch_count, count;
    size_t first_quarter; /* one piece of paper alone is followed in quarters too, which show the zoom; up to
                             patch_count */
    long *nearest;        /* among the grains */
    struct pyramid reference_pyramid;
    uint16_t saturation;
    struct search_workspace *workspaces; /* one per thread */
    int threads;
};

/* Everything of one photo. expected, has_expected and outcomes have one entry per target. */
struct follow {
    struct tracker *tracker;
    struct target_photos photos;
    struct pyramid pyramid;
    struct motion *expected; /* where each target is expected */
    int *has_expected;
    struct outcome *outcomes;
};

/* Look for every target: from where it is expected, from its neighbours, from nothing. Fills follow->outcomes. 0, or -1
 * when memory is gone. */
int rounds_find(struct follow *follow);
/* The reference photo in itself: no motion, exactly. */
int rounds_stay(struct follow *follow);

#endif
