/* All rims of a photo together: each fit knows its neighbours; blur and band width are those of the photo. */
#ifndef FINDGRAINS_REFINE_ALL_H
#define FINDGRAINS_REFINE_ALL_H

#include "findgrains/refine_circle.h"

struct rims {
    struct refined *items;
    struct candidate *origin; /* where each comes from; origin[k].spread: px, how far it may still be off */
    size_t count;
};

struct rims_state {
    double blur, window, sector;           /* px */
    double least_step;                     /* grey levels */
    double void_level, void_spread, noise; /* grey levels */
    double texture;                        /* in units of the noise */
    double correlation;                    /* factor on the standard errors */
    int ellipse;
};

int rims_make(const struct candidates *found, struct rims *rims);
void rims_free(struct rims *rims); /* accepts a zeroed struct */

/* From a rough place to within reach of the fine fit; then blur, ellipses or circles, band width; then the result. */
int rims_approach(const struct photo *photo, const struct zone *zone, const struct rims_state *state,
                  struct rims *rims);
int rims_estimate_blur(const struct photo *photo, const struct zone *zone, struct rims_state *state, struct rims *rims);
int rims_choose_window(const struct photo *photo, const struct zone *zone, struct rims_state *state,
                       const struct rims *rims);
int rims_iterate(const struct photo *photo, const struct zone *zone, const struct rims_state *state, struct rims *rims);
/* Factor on standard errors from the correlation of neighbouring sectors, over all rims. */
double rims_correlation(const struct rims *rims);

#endif
