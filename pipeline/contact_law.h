/* Contact laws (theory.md section 5). */
#ifndef PIPELINE_CONTACT_LAW_H
#define PIPELINE_CONTACT_LAW_H

#include "pipeline/json.h"

enum contact_law_kind { LAW_LINEAR };

struct contact_law {
    enum contact_law_kind kind;
    double kn;         /* N/m; NaN: not given */
    double kt_over_kn; /* 1 */
    double mu;         /* NaN: not given */
    double mu_wall;
};

/* The scene's "contact" object: law, kn_N_per_m, kt_over_kn, mu, mu_wall. */
int contact_law_read(const struct json *json, const cJSON *object, struct contact_law *law);

/* Normal force of an overlap (m); 0 for a gap. N. */
double contact_law_normal(const struct contact_law *law, double overlap);
/* Move (fn, ft) by the relative motion (dun, dut) of theory.md section 1: dfn = -kn dun, dft = -kt dut, then fn >= 0
 * and |ft| <= mu fn. Returns the enum contact_status. */
int contact_law_advance(const struct contact_law *law, double mu, double dun, double dut, double *fn, double *ft);
/* Nearest point of the Coulomb wedge fn >= 0, |ft| <= mu fn along ft (vertical projection; tensile: both zero).
 * A missing number makes both NaN and the status STATUS_NOT_USED. */
int coulomb_clip(double mu, double *fn, double *ft);

#endif
