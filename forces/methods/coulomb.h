/* Forces back into the Coulomb cones. */
#ifndef FORCES_COULOMB_H
#define FORCES_COULOMB_H

#include "forces/network/force_options.h"
#include "forces/network/equations.h"

/* Bring f inside the cones: along ft (vertical: fn stays) or to the nearest point (options->orthogonal); with
 * options->fix, only the component that is not held moves. `held` are the start forces (NULL without fix). */
void admit(const struct network *network, const struct force_options *options, const double *held, double *f);

#endif
