/* Closed-form start of the calibration of Hertz contact parameters from small-strain moduli (Qu et al., re-derived in
 * docs/calibration.md): static hypothesis, equal grains of radius r (polydisperse: 2 r is d50). A star marks the
 * grains' own parameters, no star those of the packing. */
#ifndef CALIBRATION_HERTZ_H
#define CALIBRATION_HERTZ_H

enum { HERTZ_2D = 2, HERTZ_3D = 3 };

struct hertz_packing {
    int dimensions;            /* HERTZ_2D or HERTZ_3D */
    double radius;             /* m */
    double volume_per_contact; /* S/N_c (m2) in 2D, V/N_c (m3) in 3D */
    double confinement;        /* sigma_c: N/m in 2D, Pa in 3D */
};

/* S/N_c = 2 pi r2 / ((1 - phi) z), V/N_c = 8 pi r3 / (3 (1 - phi) z) from porosity and coordination number. */
double hertz_volume_per_contact(int dimensions, double radius, double porosity, double coordination);

/* Mean normal force at confinement: f_n = S sigma_c / (r N_c) in 2D, 3 V sigma_c / (2 r N_c) in 3D. */
double hertz_mean_force(const struct hertz_packing *packing);

/* Packing moduli of contact stiffnesses kn, ks (N/m):
 * 2D: E = (8 r2 N_c / S) kn ks / (kn + 3 ks), nu = (kn - ks) / (kn + 3 ks);
 * 3D: E = (20 r2 N_c / 3 V) kn ks / (2 kn + 3 ks), nu = (kn - ks) / (2 kn + 3 ks). */
void hertz_moduli(const struct hertz_packing *packing, double kn, double ks, double *young, double *poisson);

/* Tangent stiffnesses at force fn of grains with G*, nu*: kn = (3 R~ G*2 fn / (1 - nu*)2)^(1/3), R~ = r for equal
 * grains, ks = 2 (1 - nu*) / (2 - nu*) kn. */
void hertz_stiffness(double radius, double shear, double poisson, double fn, double *kn, double *ks);

/* nu of a packing of grains with nu*, and back: 2D nu = nu* / (8 - 7 nu*), 3D nu = nu* / (10 - 8 nu*). */
double hertz_poisson(int dimensions, double grain_poisson);
double hertz_grain_poisson(int dimensions, double poisson);

/* Grain parameters E*, nu* whose packing has the target moduli at its confinement. Error (status EXIT_INPUT) when the
 * target cannot be reached: E <= 0, or nu* outside [0, 0.5]. */
int hertz_start(const struct hertz_packing *packing, double young, double poisson, double *grain_young,
                double *grain_poisson);

#endif
