/* The contact law of one contact of a packing, linear or not (docs/theory.md section 5). */
#ifndef FORCES_ELASTIC_H
#define FORCES_ELASTIC_H

#include "pipeline/laws/contact_law.h"
#include "pipeline/laws/contact_spring.h"
#include "pipeline/packing/packing.h"

/* Is the stiffness given: kn, or the modulus of the other laws? */
int elastic_known(const struct contact_law *law);
/* The law for the radii of contact `row`. */
struct contact_pair elastic_pair(const struct packing *packing, const struct contact_law *law, size_t row);
/* The tangent of the law at an overlap (m), which may be a gap: force and stiffness there (N, N/m). */
struct elastic_tangent {
    double force, stiffness;
};
struct elastic_tangent elastic_tangent(const struct contact_law *law, const struct contact_pair *pair, double overlap);
/* Move (fn, ft) by the relative motion (dun, dut): along the law from the overlap that fn stands for (virgin loading),
 * then cut at Coulomb's cone. */
void elastic_advance(const struct contact_law *law, const struct contact_pair *pair, double mu, double dun, double dut,
                     double *fn, double *ft);

#endif
