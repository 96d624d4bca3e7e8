/* The packing as equations: one balance per degree of freedom, one pair (fn, ft) per contact.
 *
 * Degrees of freedom: x, y, rotation of every free grain that carries something; one motion along its normal of every
 * free wall. A f + b = 0 is equilibrium (thesis 2.40): b the loads from outside, A gathers the contact forces; the
 * transposed A gives the relative motion (un, ut) of each contact. Corner discs act in the equations of their walls.
 *
 * Working units: forces in `force` (an estimate of <fn> from the loads), lengths in `radius` (the mean radius), so that
 * a moment divided by both stands beside a force; masses in the mean mass of a grain. */
#ifndef FORCES_NETWORK_H
#define FORCES_NETWORK_H

#include "pipeline/packing/packing.h"
#include "pipeline/laws/contact_law.h"

enum { NETWORK_WIDTH = 6 }; /* a contact touches at most two bodies of three degrees of freedom */

struct network_contact {
    int dof[NETWORK_WIDTH];                    /* -1: none */
    double n[NETWORK_WIDTH], t[NETWORK_WIDTH]; /* what fn = 1, ft = 1 do on that degree of freedom */
    double mu;                                 /* 0: no tangential force */
    double length;                             /* of the branch, in radii */
    size_t row;                                /* in the packing */
};

struct network {
    size_t count; /* contacts that may carry force */
    struct network_contact *contact;
    size_t dofs;
    double *load;          /* b */
    double *inverse_mass;  /* of each degree of freedom, for cdm */
    long *grain_dof;       /* first of three; -1: fixed or peeled */
    long *wall_dof;        /* -1: fixed, or a corner disc */
    unsigned char *peeled; /* per grain: rattler, carries nothing */
    size_t grains, walls;
    double force, radius; /* N, m: the units */
    double virial;        /* sum of fn times branch length that the loads impose, in units; NaN: reactions unknown */
    double misfit[2];     /* N: sum of all wall and grain loads, x and y, when every wall is loaded; else NaN */
};

struct network_options {
    int candidates;   /* take in contacts with CONTACT_CANDIDATE */
    double wall_mass; /* of a free wall, in mean grain masses */
};

/* Refuses a packing that nothing holds, numbers that are not finite, and a law without mu. */
int network_build(const struct packing *packing, const struct contact_law *law, const struct network_options *options,
                  struct network *network);
/* The sum of all wall and grain loads in N when every wall is loaded, else NaN. Left and bottom are then reactions,
 * which take up this misfit. Returns its size over the largest wall load, or NaN. */
double network_load_misfit(const struct packing *packing, double misfit[2]);
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

#endif
