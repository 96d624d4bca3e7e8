/* What must be added to every radius, from the photo alone. A grey threshold that is a little off moves every rim
 * alike, so every overlap by the same amount (two radii), and the pile-up of contacts no longer begins at zero. The
 * density of pair_statistics.h, its zero moved along, is fitted to the overlaps near the pile-up for a row of trial
 * corrections; mean and deviation of the likelihood are the estimate and its standard error. Free grains rest at zero
 * within the errors, which blurs the edge: once the network is known, they are left out. A factor on the radii is
 * found in the same way with the lever R_i + R_j instead of 2. */
#ifndef CONTACTS_RADIUS_OFFSET_H
#define CONTACTS_RADIUS_OFFSET_H

#include "contacts/candidates.h"

enum correction_kind { CORRECT_OFFSET, CORRECT_SCALE };

struct radius_correction {
    int decided;     /* 0: the data cannot tell, value is 0 */
    double value;    /* m to add to every radius; or the factor less 1 */
    double error;    /* its standard error */
    const char *why; /* when undecided */
    int unbalanced;  /* overlaps of the rims as circles have the sharper edge: the shapes are not in equilibrium */
};

/* Every pair counts whose grains are trusted and not idle (NULL: no grain is; network.h). */
int radius_correction_estimate(const struct grains *grains, const struct pairs *pairs, const unsigned char *idle,
                               enum correction_kind kind, struct radius_correction *correction);

#endif
