/* A loading test on a virtual packing (docs/simulate.md): discs are placed by their grading or one by one, compressed
 * to a pressure, relaxed to static equilibrium, then loaded step by step; every saved state is a packing whose contact
 * forces (method "dem") are in equilibrium.
 *
 *     struct simulation simulation = SIMULATION_DEFAULT;
 *     simulation.grading = (struct grade[]){{52, 8e-3}, {28, 12e-3}};
 *     simulation.grade_count = 2;
 *     simulation.law = (struct contact_law){.kn = 1.09e7, .kt_over_kn = 1, .mu = 0.53};
 *     simulation.kappa = 200;
 *     simulate(&simulation, save, user);      // save() is called with each state */
#ifndef SIMULATION_SIMULATE_H
#define SIMULATION_SIMULATE_H

#include "pipeline/packing/packing.h"
#include "simulation/dem/simulation.h"

/* Called with each state; the packing is borrowed. Not 0: stop with this failure. */
typedef int simulation_save(const struct packing *packing, const struct simulation_state *state, void *user);

/* 0; 1 when a state could not be relaxed (it was saved, relaxed = 0), with a line that says so; -1 on failure. */
int simulate(const struct simulation *simulation, simulation_save *save, void *user);
/* How many states it will save. */
long simulation_states(const struct simulation *simulation);

#endif
