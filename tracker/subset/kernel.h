/* The inner loop of an iteration: the searched photo interpolated at the warped pixels of a subset, and its products
 * with the subset's planes. */
#ifndef TRACKER_KERNEL_H
#define TRACKER_KERNEL_H

#include "tracker/subset/bspline.h"
#include "tracker/subset/interpolate.h"
#include "tracker/subset/rigid_motion.h"
#include "tracker/subset/subset.h"

struct kernel_sums {
    double one, square;          /* sums of the interpolated values T and of T^2 */
    double plane[SUBSET_PLANES]; /* sums of T times each plane */
};

/* Sums over all pixels of the subset at `motion`. The patch must cover the warped subset (patch_covers); its order
 * chooses the spline. */
void kernel_sums(const struct subset *subset, const struct patch *patch, const struct motion *motion,
                 struct kernel_sums *sums);

/* Where the pixels of a run land in the patch. */
struct line kernel_line(const struct subset *subset, const struct patch *patch, const struct motion *motion,
                        const struct run *run);

#endif
