/* Part grains that overlap too much (Karrech and others, section 4): minimise
 *     Phi = sum psi(overlap) - sum (m g + F) u
 * over the grains that do not touch a wall; those that do, and the walls, stay. psi is the work of the contact law's
 * normal force on first loading; friction is left out. */
#ifndef CALIBRATION_UNPRESS_H
#define CALIBRATION_UNPRESS_H

#include "simulation/dem/dem.h"

struct unpress {
    double overlap[2]; /* m: largest, before and after */
    double energy[2];  /* J: Phi, before and after; falls at every iteration */
    double force[2];   /* N: largest unbalanced component, before and after */
    int iterations;
    int done; /* 1: force below the tolerance */
};
#define UNPRESS_TOLERANCE 1e-6 /* of the largest contact force */
#define UNPRESS_ITERATIONS 5000

/* Limited-memory BFGS (Nocedal 1980) with a line search that only goes down. `history` (NULL: none) takes Phi of every
 * iteration, up to `room`. Friction springs keep what they hold; Coulomb's
 * law cuts them at the new normal forces. */
int unpress(struct dem *dem, double *history, size_t room, struct unpress *result);

/* After all grains and the walls were put elsewhere: move the grains on a little so that every contact keeps the
 * overlap that it had (its force stays, the packing stays near equilibrium), and as near as that allows to where they
 * were put: minimise sum k (overlap - overlap before)^2 / 2 + sum t |x - x put|^2 / 2; pairs that were not in contact
 * repel. */
int carry_contacts(struct dem *dem, struct unpress *result);

#endif
