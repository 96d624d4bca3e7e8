/* How near the grains stand that should touch and do not: what a photo with radii too small looks like. */
#ifndef CONTACTS_NEAR_GAPS_H
#define CONTACTS_NEAR_GAPS_H

#include "pipeline/packing/grains.h"

struct near_gaps {
    size_t pairs;  /* pairs of grains whose gap is below `reach` */
    double reach;  /* m: twice the median gap between a grain and its nearest neighbour, a quarter radius at most */
    double median; /* m: of the gaps of these pairs; below 0: they overlap; NaN without pairs */
};

/* Gaps between the rims of all grains with a place and a radius. 0, or -1 when two grains have one centre or memory is
 * gone. */
int near_gaps_find(const struct grains *grains, struct near_gaps *gaps);

#endif
