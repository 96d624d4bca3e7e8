/* What is decided between the stages of series. */
#ifndef FORCES_SERIES_STATUS_H
#define FORCES_SERIES_STATUS_H

#include "forces/series_state.h"

/* A contact that carries nothing and whose most likely overlap is negative opens; an open one whose overlap is
 * positive, or which equilibrium wants more than its gap costs, closes. Returns how many changed. */
size_t series_open_and_close(struct series *series);

/* Divide the photos' tangential motions into segments (series_segments.c), by the present estimate. */
int series_find_segments(struct series *series);

#endif
