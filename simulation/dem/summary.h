/* A state in a few numbers. */
#ifndef SIMULATION_SUMMARY_H
#define SIMULATION_SUMMARY_H

#include "pipeline/packing/packing.h"
#include "simulation/dem/dem_motion.h"
#include "simulation/dem/simulation.h"

/* Stresses, fabric, indeterminacy, sliding, energies of the packing that was made of the dem. */
void summary_fill(const struct dem *dem, const struct servo *servo, const struct packing *packing,
                  struct simulation_state *state);

#endif
