/* From file to file: the packing that was read, with the forces of each method added. */
#ifndef FORCES_ADD_FORCES_H
#define FORCES_ADD_FORCES_H

#include "forces/forces_file.h"
#include "forces/options.h"

struct force_request {
    const struct scene *scene;
    const char *input, *previous, *from, *output, *fclib; /* paths; previous, from, fclib: NULL: not given */
    struct method_list methods;
    struct force_options options;
};

struct force_outcome {
    size_t unbalanced; /* grains out of balance by more than 1 % of <fn>, in the worst of the methods that seek
                          equilibrium */
                       /* (all but cem) */
    size_t grains;
    double overlaps_over_loads; /* stress.h; NaN: not known */
    struct verdict_seen verdict;
};

/* Reads, infers, writes. -1, with an error that names the file: no file of forces was written. A previous state must be
 * one before this one, of the same series. */
int add_forces(const struct force_request *request, struct force_outcome *outcome);

#endif
