/* What is decided between the stages of series. */
#ifndef FORCES_SERIES_STATUS_H
#define FORCES_SERIES_STATUS_H

#include "forces/series/series_state.h"

/* A contact that carries nothing and whose most likely overlap is negative opens; an open one whose overlap is
 * positive, or which equilibrium wants more than its gap costs, closes. Returns how many changed. */
size_t series_open_and_close(struct series *series);

/* A grain whose equations cannot be met within a few standard errors lacks a contact, or bears a load that is not
 * known: its equations are believed to the size of their residual only (reweighting as for Student's t), so that it
 * does not spoil the constants of its neighbours. Returns how many grains, over all states. */
size_t series_let_go(struct series *series);

/* Divide the photos' tangential motions into segments (series_segments.c), by the present estimate. */
int series_find_segments(struct series *series);

#endif
