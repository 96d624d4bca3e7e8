/* States and disturbances for the benches of forces. */
#ifndef BENCH_FORCE_STATES_H
#define BENCH_FORCE_STATES_H

#include "forces/infer_forces.h"
#include "pipeline/packing.h"

/* Saved states of one virtual test with the grading of the thesis (Table 4.1), kn = kt = 1.09e7 N/m, mu = 0.5. */
struct states {
    struct packing *state;
    size_t count;
};
/* `grains` of about 1850; `steps` saved states after the isotropic one, each `strain` further (vertical biaxial). */
int states_simulate(double grains, double kappa, uint64_t seed, long steps, double strain, struct states *states);
void states_free(struct states *states);

/* Errors of a measurement, in units of the overlap <fn> / kn. */
struct disturbance {
    double place;  /* standard error of x and y of each grain */
    double radius; /* and of its radius */
    int network;   /* 1: contacts are found again from the disturbed geometry, with candidates; 0: the true ones */
    uint64_t seed;
};
/* The packing as measured, with standard errors in its columns. */
int states_disturb(const struct packing *truth, const struct disturbance *disturbance, struct packing *measured);

double states_mean_force(const struct packing *truth);
/* Pearson r with the truth over its contacts, those that are missing counting as 0; `walls` 1: with wall contacts. */
double states_r(const struct packing *truth, const struct packing *packing, const double *true_force,
                const double *force, int walls);
double states_cpu(void); /* s, of this process */

#endif
