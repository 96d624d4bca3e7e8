/* The force of one contact, alone or through its history, for every contact law: what all rows have in common. */
#ifndef PIPELINE_CONTACT_SPRING_H
#define PIPELINE_CONTACT_SPRING_H

#include "pipeline/laws/contact_law.h"

/* What the law makes of a reduced radius (m). */
struct contact_pair contact_pair_of(const struct contact_law *law, double reduced_radius);

/* Virgin loading: force (N) of an overlap (m), overlap of a force, stiffness (N/m) at a force; work (J) up to an
 * overlap and its force. A gap has no force, a force that is not positive no overlap: 0. */
double contact_pair_force(const struct contact_law *law, const struct contact_pair *pair, double overlap);
double contact_pair_overlap(const struct contact_law *law, const struct contact_pair *pair, double force);
double contact_pair_stiffness(const struct contact_law *law, const struct contact_pair *pair, double force);
double contact_pair_work(const struct contact_law *law, const struct contact_pair *pair, double overlap, double force);

/* Move (fn, ft) by the relative motion (dun, dut; m) of docs/theory.md section 1, from the overlap that fn stands for
 * on virgin loading, then cut at Coulomb's cone: dfn = -k dun, dft = -k kt_over_kn dut for small motions, and for any
 * motion where the law is linear. Returns the enum contact_status. */
int contact_pair_advance(const struct contact_law *law, const struct contact_pair *pair, double mu, double dun,
                         double dut, double *fn, double *ft);

/* Normal force and stiffness at an overlap > 0; the peak is taken into account and kept up. */
void contact_spring_press(const struct contact_law *law, const struct contact_pair *pair, double overlap,
                          struct contact_spring *spring);
/* Tangential motion dut after contact_spring_press; `before`: the normal stiffness at the last one (0: new contact).
 * The force is not yet cut at Coulomb's limit. */
void contact_spring_slide(const struct contact_law *law, double before, double dut, struct contact_spring *spring);

/* Energy that the normal spring would give back, and that of the tangential one; J. */
double contact_spring_energy(const struct contact_law *law, const struct contact_pair *pair, double overlap,
                             const struct contact_spring *spring);

#endif
