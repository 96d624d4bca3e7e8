/* The packing in SI units: what contacts writes, simulate writes as truth, forces and report read. */
#ifndef PIPELINE_PACKING_H
#define PIPELINE_PACKING_H

#include "pipeline/packing/contacts.h"
#include "pipeline/packing/forces.h"
#include "pipeline/packing/grains.h"
#include "pipeline/state/state.h"
#include "pipeline/packing/walls.h"

/* How much of the forces equilibrium leaves open: packing_indeterminacy() of structure.h. */
struct indeterminacy {
    int known;
    double h;          /* independent self-balanced sets of forces */
    double mechanisms; /* k: independent motions that no contact resists */
};

struct packing {
    struct grains grains;
    struct walls walls;
    struct contacts contacts;
    struct forces *forces; /* one per method in the file */
    size_t force_count;
    struct indeterminacy indeterminacy;
    double length_m; /* of the rods, for stresses in Pa; NaN: not known, stresses in N/m */
    struct state_info info;
};

void packing_free(struct packing *packing); /* accepts a zeroed struct */

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
