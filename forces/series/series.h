/* All states of a test together (docs/series_forces.md): the errors of the reference photo are the same in each of
 * them, and every change of the network tells more about these errors. */
#ifndef FORCES_SERIES_H
#define FORCES_SERIES_H

#include "forces/network/force_options.h"
#include "forces/series/series_summary.h"

void series_summary_free(struct series_summary *summary); /* accepts a zeroed struct */

/* Forces of each state; forces has `count` elements. One state: the same as map. */
int infer_series(const struct packing *const *packings, size_t count, const struct force_options *options,
                 const struct series_options *series_options, struct forces *forces, struct series_summary *summary);

#endif
