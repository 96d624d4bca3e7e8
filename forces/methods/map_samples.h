/* How far the forces of map are determined: draws from what the evidence leaves open (randomise, then optimise: the
 * overlaps, their shared errors and the beliefs are disturbed by their own errors and the problem solved again). */
#ifndef FORCES_SAMPLE_H
#define FORCES_SAMPLE_H

#include "forces/network/evidence.h"

struct spread {
    double *s_fn, *s_ft;     /* standard deviations, per contact of the network, in working units */
    double *fn_min, *fn_max; /* 5 % and 95 % quantiles */
};

int sample_forces(const struct network *network, const struct force_options *options, const struct evidence *evidence,
                  struct spread *spread);
void spread_free(struct spread *spread); /* accepts a zeroed struct */

#endif
