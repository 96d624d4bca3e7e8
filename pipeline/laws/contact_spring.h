/* The force of one contact through its history, for every contact law (docs/theory.md section 5). R is the reduced
 * radius, 1/R = 1/R_i + 1/R_j (R_i at a wall); both bodies are of one material: E* = E / (2 (1 - nu^2)).
 *
 * linear               F = kn x
 * Hertz                F = 4/3 E* R^1/2 x^3/2, k = dF/dx = 2 E* (R x)^1/2 = (6 E*^2 R F)^1/3
 * rough (Pohrt and     k = C F^a below F_H, a = 0.2567 D_f, C = (pi/10) D_f E* A0^1/2 (h E* A0^1/2)^-a, hence
 *  Popov)              F = ((1 - a) C x)^(1/(1 - a)); Hertz's k above F_H
 * rough, plastic       this on virgin loading; Hertz's k on unloading from the largest force and on reloading to it
 * tangential           kt = k kt_over_kn */
#ifndef PIPELINE_CONTACT_SPRING_H
#define PIPELINE_CONTACT_SPRING_H

#include "pipeline/laws/contact_law.h"

/* What the law makes of one pair of radii: computed once. */
struct contact_pair {
    double kn;                /* linear: N/m */
    double hertz;             /* F = hertz x^3/2 */
    double cube;              /* k = cube F^1/3: (6 E*^2 R)^1/3 */
    double exponent;          /* a */
    double factor;            /* C */
    double area, threshold;   /* m2, N: A0 and F_H(A0) */
    double threshold_overlap; /* m: x at F_H on virgin loading */
};
struct contact_pair contact_pair_of(const struct contact_law *law, double reduced_radius);

struct contact_spring {
    double fn, ft;    /* N */
    double stiffness; /* N/m: dF/dx now */
    double peak;      /* N: largest normal force so far */
};

/* Normal force and stiffness at an overlap > 0; the peak is taken into account and kept up. */
void contact_spring_press(const struct contact_law *law, const struct contact_pair *pair, double overlap,
                          struct contact_spring *spring);
/* Tangential motion dut after contact_spring_press; `before`: the normal stiffness at the last one (0: new contact).
 * The force is not yet cut at Coulomb's limit. */
void contact_spring_slide(const struct contact_law *law, double before, double dut, struct contact_spring *spring);

/* Virgin loading: force of an overlap, overlap of a force, stiffness at a force. */
double contact_pair_force(const struct contact_law *law, const struct contact_pair *pair, double overlap);
double contact_pair_overlap(const struct contact_law *law, const struct contact_pair *pair, double force);
double contact_pair_stiffness(const struct contact_law *law, const struct contact_pair *pair, double force);
/* Energy that the normal spring would give back, and that of the tangential one; J. */
double contact_spring_energy(const struct contact_law *law, const struct contact_pair *pair, double overlap,
                             const struct contact_spring *spring);

#endif
