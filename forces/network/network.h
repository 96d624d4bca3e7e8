/* The equations of a packing (equations.h): how they are built, and the products that every method needs. */
#ifndef FORCES_NETWORK_H
#define FORCES_NETWORK_H

#include "forces/algebra/sparse.h"
#include "forces/network/equations.h"
#include "pipeline/laws/contact_law.h"
#include "pipeline/packing/packing.h"

/* From a packing with positions and radii (m), normals, contact points, loads (N, N m) and walls. 0; -1: refused.
 * Refuses a packing that nothing holds, numbers that are not finite, and a law without mu. */
int network_build(const struct packing *packing, const struct contact_law *law, const struct network_options *options,
                  struct network *network);
void network_free(struct network *network); /* accepts a zeroed struct */

/* out = b + A f: what is out of balance; f holds (fn, ft) of each contact. */
void network_unbalance(const struct network *network, const double *f, double *out);
/* u = A' motion: relative motion (un, ut) of each contact. */
void network_motion(const struct network *network, const double *motion, double *u);
/* Mean of the positive fn; 1 (the estimate from the loads) when there is none. */
double network_mean_force(const struct network *network, const double *f);
/* The judge, the same for every method: largest unbalanced component over <fn>, f being admissible. `work` holds one
 * number per degree of freedom and returns what is out of balance. NaN when a force is: nobody knows the balance. */
double network_judge(const struct network *network, const double *f, double *work);
/* A symmetric matrix with the pattern of A A', one block of NETWORK_WIDTH per contact; NULL, with an error. */
struct sparse *network_matrix(const struct network *network);

#endif
