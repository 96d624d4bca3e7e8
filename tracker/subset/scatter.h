/* How the residual of a match scatters: standard errors that hold when it is not white noise.
 *
 * The estimate solves Z'e = 0, so its covariance is H^-1 Var(Z'e) H^-T. White noise has Var(Z'e) = s2 Z'Z. What a
 * change of focus leaves has hardly any; noise that a camera has smoothed has more. Var(Z'e) is the sum over tiles,
 * each larger than the residual's correlation, of (Z'e over the tile)^2 (White, Econometrica 1980; Conley, J.
 * Econometrics 1999). */
#ifndef TRACKER_SCATTER_H
#define TRACKER_SCATTER_H

#include "tracker/subset/bspline.h"
#include "tracker/subset/rigid_motion.h"
#include "tracker/subset/subset.h"

struct scatter {
    double focus; /* share of the residual's square that a multiple of the Laplacian explains: a change of focus */
    double ratio; /* Var(Z'e) over s2 Z'Z, the mean of the three components, s2 the variance of what focus leaves */
};

/* e = photo - gain * reference - offset at `motion`; the patch must cover it. Where there are few tiles the ratio is
 * drawn towards `expected`, what white pixel noise gives. Fails only for lack of memory. */
int scatter_measure(const struct subset *subset, const struct patch *patch, const struct motion *motion, double gain,
                    double offset, double expected, struct scatter *scatter);

#endif
