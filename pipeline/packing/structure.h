/* What the network of contacts is made of: how many, how they lie, and how much of their forces equilibrium leaves
 * open. One definition for all stages; candidates (docs/contacts.md) are no contacts here. */
#ifndef PIPELINE_STRUCTURE_H
#define PIPELINE_STRUCTURE_H

#include "pipeline/packing/packing.h"

struct fabric {
    size_t contacts, wall_contacts, rattlers;
    double z; /* contacts of a grain in the mean over all grains, rattlers too: (2 Nc - Nw) / Np, Nc with the Nw wall
               * contacts, which have a grain on one side only (2 Nc / Np of thesis eq. 3.2 where there are none) */
    double solid;        /* packing fraction: area of the discs, overlaps counted twice, over that of the specimen */
    double void_ratio;   /* of voids to solid: 1 / solid - 1 */
    double tensor[2][2]; /* fabric <n n>, trace 1; 0 without contacts */
};
/* `area`: of the specimen, m2 (packing_area(); NaN: solid and void_ratio are). z is NaN without grains. */
void packing_fabric(const struct packing *packing, double area, struct fabric *fabric);

/* The mechanisms k and the degree of force indeterminacy h = Nu - rank = Nu + k - Nf of the equations of equilibrium
 * (docs/theory.md 1), into `out`. Unknowns Nu: the forces of contacts whose bodies both carry, two each, one where the
 * coefficient of friction, mu between grains and mu_wall at walls, is 0. Equations Nf: three per grain that is neither
 * a rattler nor fixed nor without finite numbers, one along the normal of each wall that moves (wall_moves()), where
 * the contacts of corner discs enter those of their two walls. Rattlers add three mechanisms each, and nothing to h.
 *
 * The rank is exact but for mechanisms softer than some 1e-5 (see the .c). It costs some N^1.5 operations for N grains:
 * 0.02 s for 2,000, 3 s and 200 MB for 100,000, 2 minutes for a million. 0, or -1 when out of memory. */
int packing_indeterminacy(const struct packing *packing, double mu, double mu_wall, struct indeterminacy *out);

#endif
