/* loads.csv (docs/scene.md): what the machine pushes with, for each photo. */
#ifndef PIPELINE_LOADS_H
#define PIPELINE_LOADS_H

#include <stddef.h>
#include <stdint.h>

#include "pipeline/packing/walls.h"

/* Put the loads of photo `index` into the fx, fy of the walls. Headers: "index,wall,fx_N,fy_N" (a wall that is not
 * listed keeps NaN), "index,sxx_Pa,syy_Pa,sxy_Pa" (force on each wall = -stress . outward normal . length .
 * length_m), "index,corner,fx_N,fy_N" (hinge forces; each wall takes half of the two hinges at its ends; the fourth
 * follows from equilibrium). An empty cell is NaN. Unknown walls, indices that do not parse, no row for this index, two
 * for one load, or loads that pull outwards: an error with file and line. */
int loads_apply(const char *path, int64_t index, double length_m, struct walls *walls);
/* The most that any photo's loads press with: the mean over the walls whose load is known. */
struct loads_press {
    double most;  /* N on a wall; Pa where the file holds stresses */
    int per_area; /* 1: Pa */
};
/* Can the file be read, and does it say of each of these photos (in ascending order) what loads_apply() needs? The same
 * errors; walls are not looked at. */
int loads_check(const char *path, const int64_t *photos, size_t count, struct loads_press *press);
/* Refuse (-1, naming `file`) walls that hold other loads than the table gives to this photo now. */
int loads_check_same(const char *path, int64_t index, double length_m, const struct walls *walls, const char *file);

#endif
