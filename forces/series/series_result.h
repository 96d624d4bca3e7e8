/* From the solved series to the forces of each state. */
#ifndef FORCES_SERIES_RESULT_H
#define FORCES_SERIES_RESULT_H

#include "forces/series/series_loads.h"
#include "forces/series/series_state.h"

/* Cleans the forces (what carries next to nothing is 0, what slides is on its edge), fills `forces` and `summary`. -1:
 * memory is gone; the caller frees both. */
int series_results(struct series *series, const struct series_loads *loads, struct forces *forces,
                   struct series_summary *summary);

#endif
