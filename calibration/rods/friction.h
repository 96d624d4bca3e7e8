/* Interparticle friction from the three-rod test (thesis Appendix B, after Calvetti et al. 1997): rod C rests on two
 * fixed rods A and B and carries two weights at equal arms; one weight grows until C turns and slides. */
#ifndef CALIBRATION_FRICTION_H
#define CALIBRATION_FRICTION_H

#include <stddef.h>

struct friction_test {
    double p1, p2; /* N: the weights when C begins to turn */
    double arm;    /* m: L, of each weight about the centre of C */
    double radius; /* m: R of C */
    double alpha;  /* rad: between the vertical and the lines of centres C-A and C-B */
};

/* phi from sin 2 phi = 2 (P2 - P1) / (P2 + P1) (L / R) cos alpha (thesis eq. B.1), rad. The branch phi < 45 degrees is
 * the only one: sliding beyond it would need tan phi > 1. Refused (status EXIT_INPUT): numbers that are not positive,
 * a sine above 1, and alpha <= phi, where one of the contacts opens before C slides and the formula does not hold. */
int friction_angle(const struct friction_test *test, double *phi);

struct friction {
    size_t tests;
    double phi, s_phi; /* rad: mean and standard error of the mean; s NaN for a single test */
    double mu, s_mu;   /* tan phi; d mu = (1 + mu2) d phi */
};
/* Mean over tests. An error names the test (counted from 1). */
int friction_estimate(const struct friction_test *tests, size_t count, struct friction *friction);

/* The friction coefficient from contact forces: |ft| / fn of the contacts ends sharply at mu where some are about to
 * slide. */
struct mobilised {
    double mu, s_mu;     /* where it ends; mean distance of the last contacts */
    double width;        /* of the piece below the end that was looked at */
    size_t sliding;      /* contacts in it */
    size_t contacts;     /* all that were looked at */
    double significance; /* of the end: standard deviations */
    double quantile[5];  /* |ft| / fn at 10, 50, 90, 95, 99 % of the contacts */
};
#define MOBILISED_LEAST_FORCE 0.3 /* contacts with less than this share of the mean fn are too noisy */
#define MOBILISED_SIGNIFICANT 4.0
/* fn, ft of any number of contacts of one or more states (NaN: left out). Error (EXIT_INPUT): no such end. */
int friction_mobilised(const double *fn, const double *ft, size_t count, struct mobilised *mobilised);

#endif
