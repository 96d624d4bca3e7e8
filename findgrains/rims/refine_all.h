/* All rims of a photo together: each fit knows its neighbours; blur and band width are those of the photo. */
#ifndef FINDGRAINS_REFINE_ALL_H
#define FINDGRAINS_REFINE_ALL_H

#include "findgrains/capture/candidates.h"
#include "findgrains/rims/refine_circle.h"
#include "findgrains/look/threshold.h"

/* The rims of a photo while they are measured. */
struct rims {
    struct refined *items;
    struct candidate *origin; /* where each comes from; origin[k].spread: px, how far it may still be off */
    size_t count;
};

/* What is known of the photo so far. */
struct rims_state {
    double blur, window, sector;           /* px */
    double least_step;                     /* grey levels */
    double void_level, void_spread, noise; /* grey levels */
    double texture;                        /* in units of the noise */
    double correlation;                    /* factor on the standard errors */
    int ellipse;
};

/* Before anything is learnt from the rims. */
struct rims_state rims_first_guess(const struct grey_levels *levels);
int rims_make(const struct candidates *found, struct rims *rims);
void rims_free(struct rims *rims); /* accepts a zeroed struct */

/* Rows of rims: all of them, or a list. */
struct rows {
    const size_t *list; /* NULL: 0, 1, 2 ... */
    size_t count;
    int leave_still; /* leave out those that stand still */
};
enum { RIMS_SAMPLE = 96 };
#define RIMS_STILL 0.004 /* px of the last step: far below any standard error */

struct rows rims_all(const struct rims *rims);
/* Up to RIMS_SAMPLE rows spread evenly over the larger half of the rims. */
int rims_sample(const struct rims *rims, size_t sample[RIMS_SAMPLE], struct rows *rows);

/* From captured places to within reach of the fine fit; with small steps while the blur is a guess. */
int rims_approach(const struct photo *photo, const struct zone *zone, const struct rims_state *state, int blur_is_known,
                  struct rims *rims, struct rows rows);
/* The photo's blur, from a sample (which moves on the way). */
int rims_estimate_blur(const struct photo *photo, const struct zone *zone, struct rims_state *state, struct rims *rims,
                       struct rows rows);
/* Texture and width of the band, from a sample. */
int rims_choose_window(const struct photo *photo, const struct zone *zone, struct rims_state *state,
                       const struct rims *rims, struct rows rows);
/* Fine fits until every rim stands still, `most` times at most. */
int rims_iterate(const struct photo *photo, const struct zone *zone, const struct rims_state *state, int most,
                 struct rims *rims, struct rows rows);
/* Factor on standard errors from the correlation of neighbouring sectors, over all rims. */
double rims_correlation(const struct rims *rims);

#endif
