/* How small and how large a normal force can be at all: over every set of forces that is in equilibrium with the loads
 * and inside the cones, whatever the overlaps say. */
#ifndef FORCES_RANGE_H
#define FORCES_RANGE_H

#include "forces/methods/method.h"

/* Adds fn_low and fn_high (N; INFINITY: no limit; NaN: not asked, or no admissible forces were found) for the contacts
 * in `options->range`: rows and spans of rows, "3,10-14", or "all". */
int range_forces(const struct packing *packing, const struct force_options *options, enum force_method method,
                 struct forces *forces);

#endif
