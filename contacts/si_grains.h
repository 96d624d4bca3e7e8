/* Grains from pixels to metres: the one place in this stage where both are known. */
#ifndef CONTACTS_SI_GRAINS_H
#define CONTACTS_SI_GRAINS_H

#include "contacts/contact_input.h"

/* Fill the empty table: positions, corrected radii and rim shapes in metres, y up; mass and moment of inertia of solid
 * rods (density and length of the scene; without a density mass = R2); weight into load_x, load_y. Rows with a
 * position or radius that is not finite are flagged GRAIN_NOT_FINITE. */
int si_grains(const struct contact_input *input, const struct contact_options *options, struct grains *grains);

/* Positions in the reference photo (NaN where not known), count entries to be freed; NULL with no error when this
 * photo is the reference or has no tracked reference positions. */
int si_reference(const struct contact_input *input, struct vec **reference);

#endif
