/* Contact laws (docs/theory.md section 5). */
#ifndef PIPELINE_CONTACT_LAW_H
#define PIPELINE_CONTACT_LAW_H

#include "pipeline/files/json.h"

/* What Coulomb says of a contact; the column `status` of /forces/METHOD. */
enum contact_status { STATUS_OPEN = 0, STATUS_STICK = 1, STATUS_SLIP = 2, STATUS_NOT_USED = 3 };

enum contact_law_kind {
    LAW_LINEAR,
    LAW_HERTZ_MINDLIN,      /* ft shrinks with the normal force on unloading: no energy is created */
    LAW_HERTZ_PFC,          /* the same stiffnesses, ft left as it is on unloading */
    LAW_POHRT_POPOV,        /* rough, elastic */
    LAW_POHRT_POPOV_PLASTIC /* rough on virgin loading, Hertz on unloading and reloading */
};

/* No law is better known than this: share of <fn> that is the least error of a force from an overlap. */
#define LEAST_FORCE_ERROR 0.01

struct contact_law {
    enum contact_law_kind kind;
    double kn;         /* N/m; NaN: not given, and always so for the other laws: their stiffness grows with the force */
    double kt_over_kn; /* linear: 1 unless given; the others: 2 (1 - nu) / (2 - nu) */
    double mu;         /* NaN: not given */
    double mu_wall;
    double young, poisson;     /* Pa, 1: of the grains; NaN for the linear law */
    double fractal, roughness; /* 1, m: fractal dimension D_f and height h of Pohrt and Popov; NaN for the others */
};

/* The scene's "contact" object: law, mu, mu_wall; linear: kn_N_per_m, kt_over_kn; the others: young_Pa, poisson; rough:
 * fractal_dimension, roughness_m. */
int contact_law_read(const struct json *json, const cJSON *object, struct contact_law *law);

/* Normal force of an overlap (m); 0 for a gap. N. */
double contact_law_normal(const struct contact_law *law, double overlap);
/* Move (fn, ft) by the relative motion (dun, dut) of docs/theory.md section 1: dfn = -kn dun, dft = -kt dut, then fn >=
 * 0 and |ft| <= mu fn. Returns the enum contact_status. */
int contact_law_advance(const struct contact_law *law, double mu, double dun, double dut, double *fn, double *ft);
/* Nearest point of the Coulomb wedge fn >= 0, |ft| <= mu fn along ft (vertical projection; tensile: both zero).
 * A missing number makes both NaN and the status STATUS_NOT_USED. */
int coulomb_clip(double mu, double *fn, double *ft);

#endif
