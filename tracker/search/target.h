/* One thing that is followed: a grain, a piece of fixed paper, a marker on a wall. An attempt starts IC-GN from a guess
 * and keeps the better of what it found and what was known. */
#ifndef TRACKER_TARGET_H
#define TRACKER_TARGET_H

#include <stdint.h>

#include "tracker/search/icgn.h"
#include "tracker/search/search.h"

enum { TARGET_NEIGHBOURS = 8 };

struct target {
    struct shape shape;                         /* in the reference, as seen */
    int given;                                  /* 0: its circle is not finite */
    int kept;                                   /* is `subset` built? */
    struct subset subset;                       /* of the whole shape */
    struct shape neighbours[TARGET_NEIGHBOURS]; /* rims of other grains that reach into the shape */
    size_t neighbour_count;
};

/* What is known of a target in one photo so far. */
struct outcome {
    int found; /* 0: nothing yet; 1: something, doubtful; 2: good */
    struct fit fit;
    double rival;     /* ZNCC of the best other place that a search saw, refined; 0: none */
    int ambiguous;    /* the rival fits as well */
    int contradicted; /* by the other grains (consistency.h) */
    int searched;     /* by the blind search */
    int masked;       /* the subset was cut by the photo's border; */
    double used;      /* share of the subset that was used */
};

/* ZNCC from which a match is good, and from which it is anything at all. A wrong place reaches k / sqrt(specks) by
 * chance, k growing with the number of places tried (docs/tracker.md); what a search finds is good or nothing. */
double target_good_zncc(const struct target *target, int searched);
double target_lost_zncc(const struct target *target, int searched);

/* The two photos that are compared. */
struct target_photos {
    const struct photo *reference, *photo;
    const struct pyramid *reference_pyramid, *photo_pyramid; /* NULL before the first search */
    uint16_t saturation;
};

/* Build the subset that every photo shares (no effect when it is there); drop its pixels, keep its summary. */
int target_keep(struct target *target, const struct photo *reference, uint16_t saturation);
void target_drop(struct target *target);

/* IC-GN from `start`; *outcome is replaced when the new place is better: converged, above the limit below which nothing
 * is found, and more like the reference than what was there. 0, or -1 when memory is gone. The subset was kept
 * (target_keep); `patch` is a thread's own. */
int target_attempt(const struct target *target, const struct target_photos *photos, struct motion start,
                   struct patch *patch, struct outcome *outcome);
/* Search around `around`, then IC-GN from the best places. */
int target_search(const struct target *target, const struct target_photos *photos, struct motion around,
                  const struct search_reach *reach, struct search_workspace *workspace, struct outcome *outcome);

#endif
