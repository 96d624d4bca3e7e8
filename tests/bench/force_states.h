/* States and disturbances for the benches of forces. */
#ifndef BENCH_FORCE_STATES_H
#define BENCH_FORCE_STATES_H

#include "forces/infer_forces.h"
#include "pipeline/packing/packing.h"

/* Saved states of one virtual test with the grading of the thesis (Table 4.1), kn = kt = 1.09e7 N/m, mu = 0.5. */
struct states {
    struct packing *state;
    size_t count;
};
/* `grains` of about 1850; `steps` saved states after the isotropic one, each `strain` further (vertical biaxial). */
int states_simulate(double grains, double kappa, uint64_t seed, long steps, double strain, struct states *states);
/* The same with every choice. patience: steps of one relaxation, 0: as many as simulate allows. 1: a state is not
 * static to `tolerance` (of <fn>). */
struct states_test {
    double grains, kappa;
    uint64_t seed;
    long steps;
    double strain, tolerance;
    long patience;
};
int states_make(const struct states_test *test, struct states *states);
/* From files in the folder when they are there, else made and written there. folder NULL: made. 0 or -1. */
int states_keep(const char *folder, const struct states_test *test, struct states *states);
void states_free(struct states *states);
int packing_copy(const struct packing *from, struct packing *to);

/* Errors of a measurement, in units of the overlap <fn> / kn. */
struct disturbance {
    double place;  /* standard error of x and y of each grain */
    double radius; /* and of its radius */
    double scale;  /* every radius grows by this share */
    int network;   /* 1: contacts are found again from the disturbed geometry, with candidates; 0: the true ones */
    uint64_t seed;
};
/* The packing as measured, with standard errors in its columns. */
int states_disturb(const struct packing *truth, const struct disturbance *disturbance, struct packing *measured);

double states_mean_force(const struct packing *truth);
/* Pearson r with the truth over its contacts, those that are missing counting as 0; `walls` 1: with wall contacts. */
double states_r(const struct packing *truth, const struct packing *packing, const double *true_force,
                const double *force, int walls);
/* The force of contact (i, j); 0: there is none. near: row to look at first. */
double states_force_at(const struct contacts *contacts, const double *force, int64_t i, int64_t j, size_t near);
double states_cpu(void); /* s, of this process */

#endif
