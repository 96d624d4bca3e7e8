/* Where a simulation leaves its states: DIR/0000.truth.hdf, DIR/0001.truth.hdf, ... (named like the
 * photos of the scene) and DIR/loads.csv. */
#ifndef SIMULATION_SERIES_FOLDER_H
#define SIMULATION_SERIES_FOLDER_H

#include <stdio.h>

#include "simulation/simulate.h"

struct series_folder {
    const char *path;       /* borrowed */
    const char *parameters; /* borrowed: JSON text */
    const struct scene *scene;
    char *loads; /* text of loads.csv so far */
    size_t loads_size;
    FILE *loads_stream;
    size_t states, unrelaxed;
};

/* Make the folder when it is missing. */
int series_folder_open(struct series_folder *folder, const struct scene *scene, const char *parameters,
                       const char *path);
simulation_save series_folder_save; /* user: struct series_folder * */
/* Write loads.csv and free. */
int series_folder_close(struct series_folder *folder);

#endif
