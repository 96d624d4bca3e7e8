/* What the machine does to the packing: compress it to a pressure, load it step by step, let it rest. */
#ifndef SIMULATION_LOADING_H
#define SIMULATION_LOADING_H

#include "simulation/dem/dem_motion.h"
#include "simulation/dem/simulation.h"

struct loading {
    struct dem dem;
    const struct simulation *simulation;
    double pressure;           /* N/m; 0: the walls are fixed */
    double stiffness;          /* N/m: that a contact may have */
    double time_step;          /* s */
    double time_unit;          /* s: sqrt(m / p), m the mean mass */
    double strain_rate;        /* 1/s, from the inertial number */
    double size[BOX_FREEDOMS]; /* of the box in state 0: strains refer to it */
    double turns;              /* cyclic: cycles so far */
    double fastest;            /* 1/s: largest strain rate of the last step */
    struct servo servo;
    long steps;
};

extern const char *const LOADING_TEST_NAMES[TESTS + 1]; /* as the scene has them; NULL at the end */

/* Compress the loose packing until both walls carry the pressure, then relax: state 0. 1: static; 0: not; -1. */
int loading_begin(struct loading *loading);
/* One step of the test by `amount` (struct loading_steps), then relax. 1, 0, -1 as above. */
int loading_step(struct loading *loading, double amount);
/* Relax under what the servo holds now, to the simulation's tolerance. 1, 0, -1 as above; counts its steps. */
int loading_relax(struct loading *loading);

#endif
