/* What the solution of series leaves open (series_spread.c). */
#ifndef FORCES_SERIES_SPREAD_H
#define FORCES_SERIES_SPREAD_H

#include "forces/series/series_state.h"

/* Into the summary: standard errors of the offset and of kn, each photo's information; with 2 draws or more, into the
 * forces: s_fn, s_ft, fn_min, fn_max. */
int series_spread(struct series *series, int draws, struct forces *forces, struct series_summary *summary);

#endif
