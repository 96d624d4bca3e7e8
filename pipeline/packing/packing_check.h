/* Is a packing that was read one that can be? Geometry, errors and loads are held against each other, in one place. */
#ifndef PIPELINE_PACKING_CHECK_H
#define PIPELINE_PACKING_CHECK_H

#include "pipeline/packing/packing.h"

/* Refuse (-1, EXIT_INPUT, one line that names the file and the row) a packing with
 *   - a pair of bodies in two rows of /contacts,
 *   - a normal more than 26 degrees off the branch (cos < 0.9; rims of real rods turn it by a few degrees),
 *   - a contact point more than a quarter of a radius off the middle of the overlap, R_i - overlap / 2 along the
 * normal,
 *   - an overlap more than a quarter of a radius off R_i + R_j - d,
 *   - a rod length that is not positive, a standard error below zero, a load that is infinite.
 * Rows that their flags say not to trust are not looked at; NaN is "not known". */
int packing_check(const char *path, const struct packing *packing);

/* Refuse a previous state whose rows are other grains than those of `now`: another count, or radii that differ by more
 * than a tenth in more than one row of twenty. */
int packing_check_previous(const char *path, const struct packing *previous, const struct packing *now);

#endif
