/* What must be added to every radius, from the photo alone. A grey threshold that is a little off moves every rim
 * alike, so every overlap by the same amount (two radii), and the pile-up of contacts no longer begins at zero. The
 * density of pair_statistics.h, its zero moved along, is fitted to the overlaps near the pile-up for a row of trial
 * corrections; mean and deviation of the likelihood are the estimate and its standard error. Free grains rest at zero
 * within the errors, which blurs the edge: once the network is known, they are left out. A factor on the radii is
 * found in the same way with the lever R_i + R_j instead of 2.
 *
 * Pairs that share a grain share the error of its radius: their scores g (derivatives of the log density along the
 * fitted profile) do not add up like independent ones. The deviation is multiplied by the root of
 * sum_pq g_p g_q / sum_p g_p^2, p and q sharing a grain or equal (Godambe 1960; Varin, Reid and Firth 2011).
 *
 * Where errors are larger than the overlaps, the width of the pile-up is theirs and only its middle can be seen: the
 * zero is the middle less the mean overlap. That is not in the photo but in the loads (loaded_overlaps.h): it is held,
 * every overlap gets the further error (a blur) with which the pile-up has its width, and the error of the mean
 * overlap is added. Without loads there remain the stated errors; that they are 1.4 times as large is the other
 * possibility: the distance of the readings is an error. */
#ifndef CONTACTS_RADIUS_OFFSET_H
#define CONTACTS_RADIUS_OFFSET_H

#include "contacts/radii/overlap_sample.h"

struct radius_correction {
    int decided;       /* 0: the data cannot tell, value is 0 */
    double value;      /* m to add to every radius; or the factor less 1 */
    double error;      /* its standard error */
    const char *why;   /* when undecided */
    const char *doubt; /* when decided: why it should not be relied on; NULL: nothing speaks against it */
    int unbalanced;    /* overlaps of the rims as circles have the sharper edge: the shapes are not in equilibrium */
    double overlap;    /* m: mean overlap of what touches, as fitted, */
    double loaded;     /* and as the loads give it; 0: not known */
    double blur;       /* m: further error of the overlaps, as fitted; 0 where the photo does not tell it */
};

/* loaded: what the overlaps times their branches add up to, m2 (loaded_overlaps.h); 0: not known. */
/* The pairs are near ones, gaps included, of the radii as they are (candidates_between_grains). 0 also where nothing is
 * decided (correction->why); -1 when memory is gone. */
int radius_correction_estimate(const struct grains *grains, const struct pairs *pairs,
                               const struct overlap_choice *choice, double loaded,
                               struct radius_correction *correction);

#endif
