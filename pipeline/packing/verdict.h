/* What the forces of one method on one state are worth, in one word and with the reasons: the one judgement that
 * forces, series, pictures, page and drivers share.
 *
 *     balanced   nothing speaks against them
 *     doubtful   they may be right; a reader must know the reasons
 *     void       they are not the forces of this packing, or nobody can know: not to be used
 */
#ifndef PIPELINE_VERDICT_H
#define PIPELINE_VERDICT_H

#include "pipeline/packing/packing.h"

/* Measured wall loads balance to a per cent or so; with more, some load is wrong. Share of the mean load of an axis. */
#define LOAD_TOLERANCE 0.02
#define LOADS_VOID 0.1
/* In equilibrium the Weber stress is the applied one. */
#define STRESS_NOTED 0.1
#define STRESS_VOID 0.3
/* Mean unbalanced force of a grain over <fn>: a few grains that miss a contact leave less. */
#define UNBALANCED_VOID 0.1
/* Overlaps times k_n over loads, or the inverse: a wrong scale, stiffness or load. */
#define OVERLAPS_NOTED 1.4

/* Fill in forces->verdict and forces->reasons, the gravest first; and forces->converged, which is taken back where the
 * loads themselves are out of balance by more than LOAD_TOLERANCE. Looked at: convergence, proofs that no forces
 * balance the loads, the balance of the loads, loaded walls that nothing carries, the sign of the applied stress, Weber
 * against applied stress, what is left unbalanced, overlaps against loads (linear laws: kn known). A method that seeks
 * no equilibrium (no iterations: cem) is doubtful at most for what it leaves unbalanced. */
void verdict_find(const struct packing *packing, struct forces *forces);

/* The wall's load along its inward normal, N; NaN where it is not known. A tangential component that is not given
 * counts as 0, however the wall is tilted. */
double wall_normal_load(const struct walls *walls, size_t w);

/* What the loads on all four walls leave over, as a share of the mean load of that axis, the worse of the two axes; NaN
 * where a wall bears no load. misfit: x and y, N. */
double loads_misfit_share(const struct walls *walls, const double misfit[2]);

#endif
