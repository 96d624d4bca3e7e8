/* The contact stiffness that makes the Weber stress of a whole series equal to the measured one (thesis 2.1.1, 3.3):
 * forces of the contact elasticity method are proportional to k_n at a fixed k_t / k_n, friction included, because
 * Coulomb's law knows no scale. */
#ifndef CALIBRATION_RESCALE_H
#define CALIBRATION_RESCALE_H

#include "pipeline/laws/contact_law.h"
#include "pipeline/packing/packing.h"

struct rescale_options {
    struct contact_law law; /* linear: mu, mu_wall and kt_over_kn; its kn does not matter */
    int fit_kt;             /* 1: kt_over_kn is sought too */
    int increments;         /* 1: stress changes since the first state: what it was does not matter */
    const char *method;     /* not NULL: scale the forces of this method in the files instead */
};

/* Stresses of one state, compression positive: xx, yy, xy; NaN: not measured. Pa (N/m without a length). */
struct rescale_state {
    int64_t index;
    double measured[3], weber[3]; /* weber: with the stiffness found */
};

struct rescale {
    double ratio, s_ratio;           /* measured over Weber stress with the stiffness before */
    double kn, s_kn;                 /* N/m; NaN: the forces in the file have none */
    double kt_over_kn, s_kt_over_kn; /* s NaN: not sought */
    double rms;                      /* of the stresses left over, over the RMS of the measured ones */
    struct rescale_state *states;
    size_t count;
};
void rescale_free(struct rescale *rescale);

/* States of one series in order. Errors (EXIT_INPUT): fewer than 1 (increments, kt: 2) states, loads missing on the
 * walls, a stiffness that is not positive, k_t that no stress tells. */
int rescale_fit(struct packing *states, size_t count, const struct rescale_options *options, struct rescale *rescale);

#endif
