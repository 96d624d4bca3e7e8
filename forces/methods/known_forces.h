/* Forces that are known before any method works: those of the overlaps, and those of another state. */
#ifndef FORCES_KNOWN_FORCES_H
#define FORCES_KNOWN_FORCES_H

#include "forces/methods/method.h"

/* fn of the contact law at each overlap, ft 0, in working units; with options->rescale, scaled to the loads' virial.
 * Refuses a packing without overlaps or stiffness. */
int forces_of_overlaps(const struct problem *problem, double *f);
/* The forces of another state with the same grains: those of that method, else its first ones; 0 on contacts that it
 * does not have. NaN stays NaN. */
int forces_of_state(const struct problem *problem, const struct packing *previous, const char *method, double *f);
/* For each contact its row in the previous packing, the same (i, j), or -1. Where a pair stands there several times,
 * the first goes to the first. Caller frees; NULL, with an error: out of memory. */
long *match_contacts(const struct contacts *contacts, const struct contacts *previous);

#endif
