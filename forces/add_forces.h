/* From file to file: the packing that was read, with the forces of each method added. */
#ifndef FORCES_ADD_FORCES_H
#define FORCES_ADD_FORCES_H

#include "forces/options.h"

struct force_request {
    const struct scene *scene;
    const char *input, *previous, *from, *output, *fclib; /* paths; previous, from, fclib: NULL: not given */
    struct method_list methods;
    struct force_options options;
};

/* *unbalanced: grains out of balance by more than 1 % of <fn>, in the worst of the methods that seek equilibrium (all
 * but cem), out of *grains. */
int add_forces(const struct force_request *request, size_t *unbalanced, size_t *grains);

#endif
