/* Proof that no admissible forces balance the loads (Farkas). */
#ifndef FORCES_CERTIFICATE_H
#define FORCES_CERTIFICATE_H

#include "forces/network/equations.h"
#include "forces/network/force_options.h"

/* y, one number per degree of freedom (motions, in units): the least unbalance that admissible forces can leave. For
 * every f in the cones y . (A f + b) >= y . b - v sum fn, v the largest mu |ut| - un of A' y. *least_sum: the smallest
 * sum of fn (in units) that balanced forces could have, y . b / v; infinite: there are none. */
int certificate_find(const struct network *network, const struct force_options *options, double *y, double *least_sum);
/* Does it contradict the loads? Their virial bounds the sum of fn; where it is not known, forces a thousand times as
 * large as their estimate do not count. */
int certificate_holds(const struct network *network, double least_sum);

#endif
