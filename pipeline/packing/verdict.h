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

/* Fill in forces->verdict and forces->reasons, the gravest first; and forces->converged, which is taken back where the
 * loads themselves are out of balance by more than LIMIT_LOADS. Looked at: convergence, proofs that no forces
 * balance the loads, the balance of the loads, loaded walls that nothing carries, the sign of the applied stress, Weber
 * against applied stress, what is left unbalanced, overlaps against loads (linear laws: kn known). A method that seeks
 * no equilibrium (no iterations: cem) is doubtful at most for what it leaves unbalanced. 0, or -1 when out of memory.
 */
int verdict_find(const struct packing *packing, struct forces *forces);

#endif
