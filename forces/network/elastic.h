/* The contact law of one contact of a packing, linear or not (docs/theory.md section 5). */
#ifndef FORCES_ELASTIC_H
#define FORCES_ELASTIC_H

#include "pipeline/laws/contact_spring.h"
#include "pipeline/packing/packing.h"

/* The law for the radii of contact `row`: the reduced radius is R_i R_j / (R_i + R_j), at a wall R_i (also at a disc in
 * a corner). The grains have the column radius (m). */
struct contact_pair elastic_pair(const struct packing *packing, const struct contact_law *law, size_t row);
/* The tangent of the law at an overlap (m): force and stiffness there (N, N/m). At a gap the force is 0 and the
 * stiffness that of the first touch: kn of the linear law, 0 of the others. */
struct elastic_tangent {
    double force, stiffness;
};
struct elastic_tangent elastic_tangent(const struct contact_law *law, const struct contact_pair *pair, double overlap);

#endif
