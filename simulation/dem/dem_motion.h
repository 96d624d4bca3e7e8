/* How the grains and the walls move: in true time under a servo, or as fast as possible to static equilibrium. */
#ifndef SIMULATION_MOTION_H
#define SIMULATION_MOTION_H

#include "simulation/dem/dem.h"

/* What holds each freedom of the box. */
enum hold { HOLD_SIZE, HOLD_RATE, HOLD_STRESS };

struct servo {
    enum hold hold[BOX_FREEDOMS];
    double rate[BOX_FREEDOMS]; /* HOLD_RATE: m/s, m/s, 1/s */
    double stress_x, stress_y; /* N/m, compression positive: HOLD_STRESS of width and height */
    double stress_xy;          /* N/m: HOLD_STRESS of the shear */
    double fastest;            /* 1/s: limit of the strain rates that a servo may ask for; INFINITY: none */
};

/* Force from outside on the freedom of the box, where it is held by a stress. */
double servo_load(const struct dem *dem, const struct servo *servo, int freedom);

/* The stress with which the grains push a freedom of the box: N/m, compression positive. In equilibrium under
 * HOLD_STRESS it is the servo's. */
double box_stress(const struct dem *dem, int freedom);

/* One leapfrog step: forces at x, then v += dt F/m, x += dt v. drag (1/s) brakes the motion relative to the affine
 * motion of the box when follow is set, else the motion itself. */
struct stepping {
    double dt;   /* s */
    double drag; /* 1/s */
    int follow;  /* 1: the grains are carried along by the box (homogeneous strain) */
};
int dem_step(struct dem *dem, const struct servo *servo, const struct stepping *stepping);

/* How far from static equilibrium: the largest unbalanced component (moments over radius) over all grains that are
 * not fixed and over the walls under a stress, and the mean normal force (at least the dust). dem_forces_static() comes
 * first. */
struct imbalance {
    double largest, mean_fn; /* N */
    size_t contacts;
};
struct imbalance dem_imbalance(const struct dem *dem, const struct servo *servo);

/* When to stop relaxing. */
struct patience {
    double tolerance; /* largest <= tolerance * mean_fn */
    long max_steps;
    double stiffness; /* N/m: what a contact may have, to begin with */
};
/* Relax to static equilibrium. 1: reached; 0: not within max_steps; -1: failed. *steps are added. */
int dem_relax(struct dem *dem, const struct servo *servo, const struct patience *patience, long *steps);

#endif
