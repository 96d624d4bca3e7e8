/* Every pair worth a look: grains near each other, grains near a wall. */
#ifndef CONTACTS_CANDIDATES_H
#define CONTACTS_CANDIDATES_H

#include "contacts/network/pair.h"

struct pairs {
    struct pair *pair;
    size_t count, room;
};

/* All pairs of grains with a gap below some window, sorted by i, then j; the window within which the density of gaps
 * may be taken as constant goes into *window. It is at least `sigmas` standard errors of an overlap, but no wider than
 * the largest radius; gaps up to `reach` are always seen. Two grains in one place are an error. */
int candidates_between_grains(const struct grains *grains, double sigmas, double reach, struct pairs *pairs,
                              double *window);
/* Add the pairs of grains and walls within the same window; the sorting holds. */
int candidates_with_walls(const struct grains *grains, const struct walls *walls, double window, struct pairs *pairs);
/* Median standard error of the overlaps, m; 0 without pairs. -1: out of memory. */
int pairs_median_error(const struct pairs *pairs, double *error);
void pairs_free(struct pairs *pairs); /* accepts a zeroed struct */

#endif
