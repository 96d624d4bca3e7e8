/* Where the grains start: a loose random arrangement without contacts. */
#ifndef SIMULATION_PLACEMENT_H
#define SIMULATION_PLACEMENT_H

#include "simulation/dem.h"
#include "simulation/simulate.h"

/* Allocate the grains of the grading, in an order drawn by the seed, on a loose grid inside a box of the wanted
 * aspect; give them masses and the box its size. */
int placement_loose(const struct simulation *simulation, struct dem *dem);

#endif
