/* The contacts of a packing that a test draws, made to fit its circles and walls. */
#ifndef TESTS_TOUCH_H
#define TESTS_TOUCH_H

#include <math.h>

#include "pipeline/packing/packing.h"

/* Normals along the branches, overlaps R_i + R_j - d, points in their middles; i and j stand. */
static inline void touch(struct packing *p)
{
    for (size_t c = 0; c < p->contacts.count; c++) {
        size_t i = (size_t)p->contacts.i[c], wall;
        struct vec branch = packing_branch(p, c), n = vec_unit(branch);
        double partner = packing_is_wall(p, c, &wall) ? p->walls.radius[wall] : p->grains.radius[p->contacts.j[c]];
        p->contacts.overlap[c] = p->grains.radius[i] + partner - vec_norm(branch);
        double arm = p->grains.radius[i] - p->contacts.overlap[c] / 2;
        p->contacts.nx[c] = n.x, p->contacts.ny[c] = n.y;
        p->contacts.x[c] = p->grains.x[i] + arm * n.x, p->contacts.y[c] = p->grains.y[i] + arm * n.y;
    }
}

#endif
