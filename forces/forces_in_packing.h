/* The public calls of forces (CONTRIBUTING.md, "Public headers"): the scene says everything, no options are needed. */
#ifndef FORCES_FORCES_IN_PACKING_H
#define FORCES_FORCES_IN_PACKING_H

#include "pipeline/packing/packing.h"
#include "pipeline/scene/scene.h"

/* Infer the contact forces of one packing by one method, with the scene's contact law and section "forces" (whose
 * walks, ranges and stability are asked for by the program alone). method: "map" (most probable forces from overlaps
 * and loads), "qsm" (projections onto equilibrium and friction), "cdm" (contact dynamics) or "cem" (measured motions
 * times stiffness, no equilibrium); docs/forces.md tells each with its source. previous: the packing before with its
 * forces, where the method or the scene's forces.start asks for it; NULL: none.
 *
 * The result joins packing->forces, in the place of an older one of that method (packing_forces() finds it): a row per
 * contact, fn and ft in N (fn >= 0 in compression), what stays unbalanced on each grain, Weber's stress (thesis
 * eq. 3.5; Pa, compression positive). A method that does not converge is no failure: its `converged` is 0.
 *
 * Scene and previous stay the caller's. 0, or -1 with a line (pipeline/speak/error.h) and the packing as it was: no
 * such method, mu or stiffness missing, no overlaps, no previous state that is needed (EXIT_INPUT); memory is gone
 * (EXIT_FAILED). */
int forces_in_packing(const struct scene *scene, const char *method, const struct packing *previous,
                      struct packing *packing);

/* The forces of all `count` states of one test together, method "series" (docs/series_forces.md): the errors of the
 * reference photo are the same in each of them. The packings have the same grains in the same rows, in the order of
 * time, and overlaps. Each gets its result as above; errors as above. */
int forces_in_series(const struct scene *scene, struct packing *packings, size_t count);

#endif
