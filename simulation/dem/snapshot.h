/* A state of the simulation as a packing: grains, walls, contacts, forces. */
#ifndef SIMULATION_SNAPSHOT_H
#define SIMULATION_SNAPSHOT_H

#include "pipeline/packing/packing.h"
#include "simulation/dem/dem_motion.h"

/* What motions since the reference and since the previous state need. */
struct snapshot {
    int given;
    size_t count;
    struct dem_grain *grains;
    struct dem_box box;
    struct dem_pair *pairs; /* the touching ones, in the order of the list */
    size_t pair_count;
};
int snapshot_take(const struct dem *dem, struct snapshot *snapshot);
void snapshot_free(struct snapshot *snapshot);

/* The packing now. reference may be NULL (then this state is it); previous may be NULL (then dun dut are left out). */
int snapshot_packing(const struct dem *dem, const struct servo *servo, const struct snapshot *reference,
                     const struct snapshot *previous, double length_m, struct packing *packing);

#endif
