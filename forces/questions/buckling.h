/* Does the equilibrium hold against small pushes? The second-order work of a motion U is U . K U (thesis 3.2; Roux and
 * Combe 2011), K the stiffness matrix of the contacts that carry force; a state is stable when it is positive for every
 * U. */
#ifndef FORCES_STABILITY_H
#define FORCES_STABILITY_H

#include "forces/network/force_options.h"

/* Needs a stiffness of the contacts, and forces->contact of that packing. 0 or -1.
 * Fills forces->stability and forces->softest from the forces of this method. */
int stability_of_forces(const struct packing *packing, const struct force_options *options, struct forces *forces);

#endif
