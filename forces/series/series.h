/* All states of a test together (docs/series_forces.md): the errors of the reference photo are the same in each of
 * them, and every change of the network tells more about these errors. */
#ifndef FORCES_SERIES_H
#define FORCES_SERIES_H

#include "forces/network/force_options.h"
#include "forces/series/series_summary.h"

void series_summary_free(struct series_summary *summary); /* accepts a zeroed struct */

/* Forces of each state (method "series"); forces has `count` elements, all to be freed by forces_free() after 0. The
 * packings have overlaps (m), and, where they are known, standard errors of places, radii, walls and rims; they have
 * the same grains in the same rows. One state: the same as map. -1: an input is refused or memory is gone; then only
 * the summary is to be freed. A series that does not converge is no failure: summary->converged says so. */
int infer_series(const struct packing *const *packings, size_t count, const struct force_options *options,
                 const struct series_options *series_options, struct forces *forces, struct series_summary *summary);

#endif
