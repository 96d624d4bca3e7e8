/* The scene's section "simulation" (docs/simulate.md). */
#ifndef SIMULATION_SIMULATE_SCENE_H
#define SIMULATION_SIMULATE_SCENE_H

#include "pipeline/scene/scene.h"
#include "simulation/dem/simulation.h"

/* A simulation whose lists are owned. */
struct simulation_plan {
    struct simulation simulation;
    struct grade *grading;
    struct placed_disc *discs;
    struct loading_steps *steps;
};

/* The test that the scene describes; every mistake is an error with line and column. */
int simulation_read(const struct scene *scene, struct simulation_plan *plan);
void simulation_plan_free(struct simulation_plan *plan); /* accepts a zeroed struct */
/* What changes numbers, as JSON: the scene's section, contact law, density, length, gravity. To be freed. */
char *simulation_parameters(const struct scene *scene);

#endif
