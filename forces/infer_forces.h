/* Contact forces of one packing by one method (docs/forces.md). The packing is not changed. */
#ifndef FORCES_INFER_FORCES_H
#define FORCES_INFER_FORCES_H

#include "forces/methods/method.h"

/* Names of the starts and of the parts that can be held, in the order of their enumerations, then NULL. */
extern const char *const FORCE_STARTS[], *const FORCE_FIXES[];

/* A method that does not converge is not a failure: forces->converged is 0 and the imbalance says how far it is. */
int infer_forces(const struct packing *packing, const struct force_options *options, enum force_method method,
                 struct forces *forces);

/* Grains whose unbalanced force or moment (over the mean radius) exceeds `share` of the mean normal force, or is not
 * known. */
size_t forces_unbalanced_grains(const struct packing *packing, const struct forces *forces, double share);

#endif
