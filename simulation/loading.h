/* What the machine does to the packing: compress it to a pressure, strain it, let it rest. */
#ifndef SIMULATION_LOADING_H
#define SIMULATION_LOADING_H

#include "simulation/motion.h"
#include "simulation/simulate.h"

struct loading {
    struct dem dem;
    const struct simulation *simulation;
    double pressure;           /* N/m */
    double time_step;          /* s */
    double strain_rate;        /* 1/s, from the inertial number */
    double size[BOX_FREEDOMS]; /* of the box in state 0: strains refer to it */
    struct servo servo;
    long steps;
};

/* Compress the loose packing until both walls carry the pressure, then relax: state 0. 1: static; 0: not; -1. */
int loading_compress(struct loading *loading);
/* Strain by one step of the test, then relax. 1, 0, -1 as above. */
int loading_strain(struct loading *loading, double strain);

#endif
