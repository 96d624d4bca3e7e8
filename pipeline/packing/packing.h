/* The packing in SI units: what contacts writes, simulate writes as truth, forces and report read. */
#ifndef PIPELINE_PACKING_H
#define PIPELINE_PACKING_H

#include "pipeline/packing/contacts.h"
#include "pipeline/packing/forces.h"
#include "pipeline/packing/grains.h"
#include "pipeline/state/state.h"
#include "pipeline/packing/walls.h"

struct packing {
    struct grains grains;
    struct walls walls;
    struct contacts contacts;
    struct forces *forces; /* one per method in the file */
    size_t force_count;
    double length_m; /* of the rods, for stresses in Pa; NaN: not known, stresses in N/m */
    struct state_info info;
};

void packing_free(struct packing *packing); /* accepts a zeroed struct */

/* Read /grains, /walls, /contacts and every /forces/METHOD of an SI-side file. Checked here, once for all stages:
 * x y radius mass inertia flags of grains; 0 <= i < j < grains + walls, unit normals, finite geometry of contacts that
 * are not flagged. Errors name the file. A missing /walls or /forces is an empty table. */
int packing_read(const char *path, struct packing *packing);

/* Write the whole packing (tables, forces, the VTKHDF view) as one state file, atomically. The fabric stands in
 * attributes of /contacts: z, wall_contacts, rattlers, solid_fraction, void_ratio, fabric_tensor (xx xy yx yy),
 * directions and directions_approaching (36 bins of 5 degrees from the x axis, contacts; those with dun < 0). */
int packing_write(const char *path, const struct packing *packing, const struct provenance *provenance);

/* The forces of that method, or NULL. */
const struct forces *packing_forces(const struct packing *packing, const char *method);

/* Position of the body that is the second partner of contact c: a grain's centre, a corner disc's centre, or the foot
 * of grain i on a wall's line. The branch l runs from grain i to here. */
struct vec packing_partner(const struct packing *packing, size_t c);
/* The branch vector of contact c, from grain i to packing_partner(). */
struct vec packing_branch(const struct packing *packing, size_t c);
/* Is the second partner of contact c a wall? Then *wall is its row. */
int packing_is_wall(const struct packing *packing, size_t c, size_t *wall);

#endif
