#include "pipeline/contact_law.h"

#include <float.h>
#include <math.h>

#include "pipeline/forces.h"

int contact_law_read(const struct json *json, const cJSON *object, struct contact_law *law)
{
    static const char *const keys[] = {"law", "kn_N_per_m", "kt_over_kn", "mu", "mu_wall", NULL};
    static const char *const laws[] = {"linear", NULL};
    struct contact_law read = {.kind = LAW_LINEAR, .kn = NAN, .kt_over_kn = 1, .mu = NAN, .mu_wall = 0};
    int kind = LAW_LINEAR;
    if (json_check_keys(json, object, keys) || json_choice(json, object, "law", laws, &kind) < 0 ||
        json_number(json, object, "kn_N_per_m", DBL_MIN, 1e15, &read.kn) < 0 ||
        json_number(json, object, "kt_over_kn", 0, 10, &read.kt_over_kn) < 0 ||
        json_number(json, object, "mu", 0, 10, &read.mu) < 0 ||
        json_number(json, object, "mu_wall", 0, 10, &read.mu_wall) < 0)
        return -1;
    read.kind = (enum contact_law_kind)kind;
    *law = read;
    return 0;
}

double contact_law_normal(const struct contact_law *law, double overlap)
{
    return overlap > 0 ? law->kn * overlap : 0;
}

int contact_law_advance(const struct contact_law *law, double mu, double dun, double dut, double *fn, double *ft)
{
    *fn -= law->kn * dun;
    *ft -= law->kt_over_kn * law->kn * dut;
    return coulomb_clip(mu, fn, ft);
}

int coulomb_clip(double mu, double *fn, double *ft)
{
    if (isnan(*fn) || isnan(*ft)) {
        *fn = *ft = NAN;
        return STATUS_NOT_USED;
    }
    if (*fn <= 0) {
        *fn = *ft = 0;
        return STATUS_OPEN;
    }
    if (fabs(*ft) <= mu * *fn)
        return STATUS_STICK;
    *ft = copysign(mu * *fn, *ft);
    return STATUS_SLIP;
}
