/* From files to files: the states of a test together, each with its forces of method "series". */
#ifndef FORCES_ADD_SERIES_H
#define FORCES_ADD_SERIES_H

#include "forces/forces_file.h"
#include "forces/series/series.h"
#include "pipeline/scene/scene.h"

struct series_request {
    const struct scene *scene;
    char *const *inputs;
    size_t count;
    const char *output; /* a folder, made where there is none; one state: may be the file itself */
    struct force_options options;
    struct series_options series_options;
};

/* What is to be said of a finished series. */
struct series_outcome {
    size_t unbalanced, grains; /* grains out of balance by more than 1 % of <fn> in their state, of all in all states */
    double misfit;             /* 2 F over the number of data: below 1 where the data fit together; 0 for one photo */
    const char *worst;         /* the input whose own misfit is the largest */
    double worst_misfit;
    struct verdict_seen verdict;
};

/* One N.forces.hdf per input N.contacts.hdf, and series.csv: what each photo contributed. */
int add_series(const struct series_request *request, struct series_outcome *outcome);

#endif
