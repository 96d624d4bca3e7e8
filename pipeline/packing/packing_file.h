/* A packing as a state file (docs/files.md). */
#ifndef PIPELINE_PACKING_FILE_H
#define PIPELINE_PACKING_FILE_H

#include "pipeline/packing/packing.h"

/* Read /grains, /walls, /contacts and every /forces/METHOD of an SI-side file. Checked here, once for all stages:
 * x y radius mass inertia flags of grains; 0 <= i < j < grains + walls, unit normals, finite geometry of contacts that
 * are not flagged. Errors name the file. A missing /walls or /forces is an empty table.
 * 0, to be freed by packing_free(); or -1 with a line (EXIT_INPUT, or out of memory) and nothing to be freed. */
int packing_read(const char *path, struct packing *packing);

/* Write the whole packing (tables, forces, the VTKHDF view) as one state file, atomically. The fabric stands in
 * attributes of /contacts: z, wall_contacts, rattlers, solid_fraction, void_ratio, fabric_tensor (xx xy yx yy), h and
 * mechanisms where they are known, directions and directions_approaching (36 bins of 5 degrees from the x axis,
 * contacts; those with dun < 0). 0, or -1 with a line and no new file at `path`. */
int packing_write(const char *path, const struct packing *packing, const struct provenance *provenance);

#endif
