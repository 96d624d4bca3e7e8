/* A state in a few numbers. */
#ifndef SIMULATION_SUMMARY_H
#define SIMULATION_SUMMARY_H

#include "pipeline/packing/packing.h"
#include "simulation/dem/dem_motion.h"
#include "simulation/dem/simulation.h"

/* Stresses, fabric, indeterminacy (also into the packing), sliding, energies of the packing that was made of the dem.
 * 0, or -1 when out of memory. */
int summary_fill(const struct dem *dem, struct packing *packing, struct simulation_state *state);

#endif
