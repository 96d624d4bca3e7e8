/* How many contact forces equilibrium leaves open. */
#ifndef REPORT_INDETERMINACY_H
#define REPORT_INDETERMINACY_H

#include "pipeline/packing/packing.h"

/* h as the file says it, else that of packing_indeterminacy(): then the friction is that of these forces, and on the
 * walls there is none when no wall contact of them bears any; forces NULL: friction everywhere. 0, or -1 when out of
 * memory. */
int indeterminacy(const struct packing *packing, const struct forces *forces, double *h);

#endif
