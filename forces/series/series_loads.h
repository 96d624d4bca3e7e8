/* What the loads say about all overlaps together, before anything else: sum of kn (overlap - offsets) times branch
 * length = virial of the loads, in every state. */
#ifndef FORCES_SERIES_LOADS_H
#define FORCES_SERIES_LOADS_H

#include "forces/network/force_options.h"

struct series_loads {
    double force;            /* N: <fn> of the most loaded state */
    double kn, s_kn;         /* N/m */
    double offset, s_offset; /* m: of each radius, measured less true */
    const char *refused;     /* why kn was not fitted; NULL: it was, or need not be */
};

/* The packings have overlaps; options->law.kn is given. offset, stiffness: 1: it is unknown. Where the loads of all
 * states are nearly the same, kn and the offset cannot be told apart: kn stays, and `refused` says why. 0; -1: as a
 * network is refused, or memory is gone. */
int series_loads_fit(const struct packing *const *packings, size_t count, const struct force_options *options,
                     int offset, int stiffness, struct series_loads *loads);

#endif
