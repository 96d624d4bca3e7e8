/* Where the grains start. */
#ifndef SIMULATION_PLACEMENT_H
#define SIMULATION_PLACEMENT_H

#include "simulation/dem/dem.h"
#include "simulation/dem/simulation.h"

/* The grains of the grading, in an order drawn by the seed, on a loose grid without contacts, in a box of the wanted
 * aspect; or the discs that were placed by hand. Masses and the box are set. */
int placement(const struct simulation *simulation, struct dem *dem);

#endif
