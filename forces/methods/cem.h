/* Contact elasticity as a start of other methods. */
#ifndef FORCES_CEM_H
#define FORCES_CEM_H

#include "forces/methods/method.h"

/* The forces of cem into f, in working units; NaN where the motion of a contact that was there before is not known. */
int cem_forces(const struct problem *problem, double *f);

#endif
