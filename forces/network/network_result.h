/* From the working units of a network to the columns of the file: one row per contact and grain of the packing. */
#ifndef FORCES_NETWORK_RESULT_H
#define FORCES_NETWORK_RESULT_H

#include "forces/network/equations.h"
#include "pipeline/packing/packing.h"

/* Fills the tables of contacts and residuals (N, N m), the misfit of the loads, and Weber's stress. f: (fn, ft) per
 * contact of the network; unbalance: what is out of balance on each degree of freedom (network_judge()); margin: how
 * near to the corner (in <fn>) and to the edges (as a share) of its cone a contact counts as open or slipping. Contacts
 * of the packing that the network does not use carry 0 and STATUS_NOT_USED; grains that it does not move keep their
 * load as their residual, or 0 when they are fixed. */
int result_store(const struct packing *packing, const struct network *network, double margin, const double *f,
                 const double *unbalance, struct forces *forces);

/* The larger of the force and the moment over the radius (m) that grain k has left, N; NaN: not known. */
double result_unbalance(const struct residuals *residual, size_t k, double radius);

/* What is said of forces whose columns, imbalance, iterations, stiffness and proof stand: the mean of what the grains
 * have left, how far the forces are outside their cones, whether they converged (imbalance <= tolerance) and the
 * verdict (packing/verdict.h). 0, or -1 when out of memory. */
int result_sum_up(const struct packing *packing, const struct contact_law *law, double tolerance,
                  struct forces *forces);

/* How far forces are determined: one number per contact of the network, in working units. */
struct spread {
    double *s_fn, *s_ft;     /* standard deviations */
    double *fn_min, *fn_max; /* 5 % and 95 % quantiles */
};
int spread_alloc(size_t contacts, struct spread *spread); /* zeros; free it even after -1 */
void spread_free(struct spread *spread);                  /* accepts a zeroed struct */
/* Of contact c: fn and its standard deviations, the quantiles being those of a normal distribution cut at 0. */
void spread_set(struct spread *spread, size_t c, double fn, double s_fn, double s_ft);
/* The columns s_fn, s_ft, fn_min, fn_max, all NaN. */
int result_add_spread(struct contact_forces *out);
/* Adds and fills these columns; contacts that the network does not use keep NaN. */
int result_store_spread(const struct network *network, const struct spread *spread, struct contact_forces *out);

#endif
