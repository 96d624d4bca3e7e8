/* Measured rims as the table that crosses the stage boundary. */
#ifndef FINDGRAINS_RIMS_TABLE_H
#define FINDGRAINS_RIMS_TABLE_H

#include "findgrains/look/zone.h"
#include "findgrains/rims/refine_all.h"
#include "pipeline/packing/grains.h"

/* Fill the empty table with one row per rim: from top to bottom, or in the order of the rims (keep_order). px; standard
 * errors times state->correlation; shapes counter-clockwise as seen (the rims' own are clockwise, y down). 0, or -1
 * when memory is gone. */
int rims_table(const struct zone *zone, const struct rims_state *state, const struct rims *rims, int keep_order,
               struct photo_grains *grains);

#endif
