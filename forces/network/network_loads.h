/* Inside of the network: the loads from outside, and the units of force and length that they set. */
#ifndef FORCES_NETWORK_LOADS_H
#define FORCES_NETWORK_LOADS_H

#include "forces/network/equations.h"
#include "pipeline/laws/contact_law.h"
#include "pipeline/packing/packing.h"

double network_radius(const struct grains *grains); /* m: the mean */
/* N: the unit of force; sets the virial, still in N m. For the contacts and degrees of freedom of `network`. */
double network_force(const struct packing *packing, const struct contact_law *law, struct network *network);
/* The sum of all wall and grain loads in N when every wall is loaded, else NaN. Left and bottom are then reactions,
 * which take up this misfit. Returns its size over the largest wall load, or NaN. */
double network_load_misfit(const struct packing *packing, double misfit[2]);
/* Fills network->load, in these units. */
void network_loads(const struct packing *packing, struct network *network);

#endif
