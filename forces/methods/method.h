/* What the methods share: the network in working units, forces as (fn, ft) pairs, and how an iteration ended. */
#ifndef FORCES_METHOD_H
#define FORCES_METHOD_H

#include "forces/infer_forces.h"
#include "forces/network/network.h"

struct outcome {
    int iterations;
    int converged;    /* imbalance <= tolerance */
    double imbalance; /* network_judge() of the returned forces */
};

/* Which contacts a method works on. */
struct network_options method_network(const struct force_options *options, enum force_method method);

/* Each takes the start in f and leaves admissible forces there. */
int cdm_solve(const struct network *network, const struct force_options *options, double *f, struct outcome *outcome);
int qsm_solve(const struct network *network, const struct force_options *options, double *f, struct outcome *outcome);
/* One contact of cdm: forces that stop the relative velocity (un, ut), under Signorini's and Coulomb's laws, given the
 * inverse mass matrix w = {Wnn, Wnt, Wtt} (thesis 2.14, 2.24). relaxation 1: exactly; more: beyond. */
void cdm_contact(const double w[3], double mu, double un, double ut, double relaxation, double *fn, double *ft);

/* Forces in working units that a method starts from (start.c). */
int start_forces(const struct packing *packing, const struct network *network, const struct force_options *options,
                 enum force_method method, double *f);
/* Contact elasticity (thesis 2.1.1): forces of the previous state, or of the overlaps, moved by the measured motions.
 */
int cem_forces(const struct packing *packing, const struct network *network, const struct force_options *options,
               double *f);
/* For each contact its row in the previous packing, the same (i, j), or -1. Caller frees. */
long *match_contacts(const struct contacts *contacts, const struct contacts *previous);

/* Bring f inside the Coulomb cones: along ft (vertical) or to the nearest point (orthogonal); with `fix`, only the
 * component that is not held moves. `held` are the start forces (NULL without fix). */
void admit(const struct network *network, const struct force_options *options, const double *held, double *f);

#endif
