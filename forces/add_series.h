/* From files to files: the states of a test together, each with its forces of method "series". */
#ifndef FORCES_ADD_SERIES_H
#define FORCES_ADD_SERIES_H

#include "forces/infer_forces.h"
#include "forces/series.h"
#include "pipeline/scene.h"

struct series_request {
    const struct scene *scene;
    char *const *inputs;
    size_t count;
    const char *output; /* a folder, made where there is none; one state: may be the file itself */
    struct force_options options;
    struct series_options series_options;
};

/* One N.forces.hdf per input N.contacts.hdf, and series.csv: what each photo contributed. *unbalanced: grains out of
 * balance by more than 1 % of <fn> in their state, out of *grains, over all states. */
int add_series(const struct series_request *request, size_t *unbalanced, size_t *grains);

#endif
