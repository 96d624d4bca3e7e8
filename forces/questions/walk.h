/* Force variability by a random walk (thesis 3.5.6; Unger and Kertesz 2003): from admissible forces every fn and ft
 * jumps by up to <fn>, uniformly, and the method leads back to admissible forces, from which the next jump starts. */
#ifndef FORCES_WALK_H
#define FORCES_WALK_H

#include "forces/methods/method.h"

#define WALK_JUMP 1.0 /* lambda, over <fn> (thesis 3.7) */

/* options->walk jumps from the forces of this method, which are not changed; adds s_fn s_ft (standard deviations over
 * the states of the walk), fn_min fn_max (their 5 % and 95 % quantiles) and forces->walk. States that are out of
 * balance by more than the tolerance are no states: the walk stays. Needs 2 states; else everything is NaN. */
int walk_forces(const struct packing *packing, const struct force_options *options, enum force_method method,
                struct forces *forces);

#endif
