/* How many contact forces equilibrium leaves open. */
#ifndef REPORT_INDETERMINACY_H
#define REPORT_INDETERMINACY_H

#include "pipeline/packing/packing.h"

/* h: unknown forces less equations (docs/theory.md 1; mechanisms are not counted). Unknown: two per contact, one where
 * friction is absent; candidates and contacts of rattlers are left out. Equations: three per grain that is neither a
 * rattler nor fixed, one per direction in which a wall is loaded. Friction on the walls is absent when no wall contact
 * of these forces bears any; forces NULL: friction everywhere. */
double indeterminacy(const struct packing *packing, const struct forces *forces);

#endif
