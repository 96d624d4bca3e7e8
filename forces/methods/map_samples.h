/* How far the forces of map are determined: draws from what the evidence leaves open (randomise, then optimise: the
 * overlaps, their shared errors and the beliefs are disturbed by their own errors and the problem solved again). */
#ifndef FORCES_MAP_SAMPLES_H
#define FORCES_MAP_SAMPLES_H

#include "forces/methods/method.h"
#include "forces/network/evidence.h"

/* options->samples draws, 2 or more, around the most likely forces for that evidence. 0 or -1; spread is to be freed.
 */
int map_sample(const struct network *network, const struct force_options *options, const struct evidence *evidence,
               struct spread *spread);

#endif
