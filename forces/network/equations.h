/* The packing as equations: one balance per degree of freedom, one pair (fn, ft) per contact.
 *
 * Degrees of freedom: x, y, rotation of every free grain that carries something; one motion along its normal of every
 * free wall. A f + b = 0 is equilibrium (thesis 2.40): b the loads from outside, A gathers the contact forces; the
 * transposed A gives the relative motion (un, ut) of each contact. Corner discs act in the equations of their walls.
 * The columns of A stand with their contacts, since each has six entries at most.
 *
 * Working units: forces in `force` (an estimate of <fn> from the loads), lengths in `radius` (the mean radius), so that
 * a moment divided by both stands beside a force; masses in the mean mass of a grain. */
#ifndef FORCES_EQUATIONS_H
#define FORCES_EQUATIONS_H

#include <stddef.h>

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

/* out += A_c (fn, ft): what these forces of one contact do on its degrees of freedom; `out` has one number of each. */
static inline void contact_push(const struct network_contact *contact, double fn, double ft, double *out)
{
    for (int e = 0; e < NETWORK_WIDTH && contact->dof[e] >= 0; e++)
        out[contact->dof[e]] += contact->n[e] * fn + contact->t[e] * ft;
}

/* The lower triangle of A_c H A_c', H the symmetric 2 x 2 matrix {nn, nt, tt}; rows of the block are `width` apart. */
static inline void contact_block(const struct network_contact *contact, const double h[3], int width, double *block)
{
    for (int i = 0; i < NETWORK_WIDTH; i++) {
        double a = contact->n[i] * h[0] + contact->t[i] * h[1], b = contact->n[i] * h[1] + contact->t[i] * h[2];
        for (int j = 0; j <= i; j++)
            block[i * width + j] = a * contact->n[j] + b * contact->t[j];
    }
}

#endif
