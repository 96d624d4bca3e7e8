/* From the solved series to the forces of each state. */
#ifndef FORCES_SERIES_RESULT_H
#define FORCES_SERIES_RESULT_H

#include "forces/series/series_loads.h"
#include "forces/series/series_state.h"

int series_results(struct series *series, const struct series_loads *loads, struct forces *forces,
                   struct series_summary *summary);

#endif
