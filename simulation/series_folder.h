/* Where a simulation leaves its states: DIR/0000.truth.hdf, DIR/0001.truth.hdf, ... (named like the
 * photos of the scene), DIR/loads.csv, and DIR/states.csv: one row of summary per state. */
#ifndef SIMULATION_SERIES_FOLDER_H
#define SIMULATION_SERIES_FOLDER_H

#include <stdio.h>

#include "pipeline/scene/scene.h"
#include "pipeline/speak/progress.h"
#include "simulation/dem/simulate.h"

struct series_folder {
    const char *path;       /* borrowed */
    const char *parameters; /* borrowed: JSON text */
    const struct scene *scene;
    struct text_table {
        char *text; /* so far */
        size_t size;
        FILE *stream;
    } loads, summary;
    struct progress progress;
    size_t states, unrelaxed;
};

/* Make the folder when it is missing; `states`: how many will come. */
int series_folder_open(struct series_folder *folder, const struct scene *scene, const char *parameters,
                       const char *path, long states);
simulation_save series_folder_save; /* user: struct series_folder * */
/* Write loads.csv and states.csv of the states so far, and free. */
int series_folder_close(struct series_folder *folder);

#endif
