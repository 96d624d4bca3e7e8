#include "pipeline/laws/contact_law.h"

#include <float.h>
#include <math.h>

static const char *const LAWS[] = {"linear", "hertz_mindlin", "hertz_pfc", "pohrt_popov", "pohrt_popov_plastic", NULL};

static int read_linear(const struct json *json, const cJSON *object, struct contact_law *law)
{
    static const char *const keys[] = {"law", "kn_N_per_m", "kt_over_kn", "mu", "mu_wall", NULL};
    if (json_check_keys(json, object, keys) || json_number(json, object, "kn_N_per_m", DBL_MIN, 1e15, &law->kn) < 0 ||
        json_number(json, object, "kt_over_kn", 0, 10, &law->kt_over_kn) < 0)
        return -1;
    return 0;
}

static int read_elastic(const struct json *json, const cJSON *object, struct contact_law *law)
{
    static const char *const smooth[] = {"law", "young_Pa", "poisson", "mu", "mu_wall", NULL};
    static const char *const rough[] = {"law",         "young_Pa", "poisson", "fractal_dimension",
                                        "roughness_m", "mu",       "mu_wall", NULL};
    int is_rough = law->kind == LAW_POHRT_POPOV || law->kind == LAW_POHRT_POPOV_PLASTIC;
    if (json_check_keys(json, object, is_rough ? rough : smooth))
        return -1;
    int young = json_number(json, object, "young_Pa", DBL_MIN, 1e15, &law->young);
    int poisson = young < 0 ? -1 : json_number(json, object, "poisson", 0, 0.5, &law->poisson);
    if (poisson < 0)
        return -1;
    if (!young || !poisson)
        return json_error(json, object, "law '%s' needs young_Pa and poisson: add them to 'contact'", LAWS[law->kind]);
    law->kt_over_kn = 2 * (1 - law->poisson) / (2 - law->poisson);
    if (!is_rough)
        return 0;
    int fractal = json_number(json, object, "fractal_dimension", 2, 3, &law->fractal);
    int roughness = fractal < 0 ? -1 : json_number(json, object, "roughness_m", DBL_MIN, 1, &law->roughness);
    if (roughness < 0)
        return -1;
    if (!fractal || !roughness)
        return json_error(json, object, "law '%s' needs fractal_dimension and roughness_m: add them to 'contact'",
                          LAWS[law->kind]);
    return 0;
}

int contact_law_read(const struct json *json, const cJSON *object, struct contact_law *law)
{
    struct contact_law read = {
        .kn = NAN, .kt_over_kn = 1, .mu = NAN, .young = NAN, .poisson = NAN, .fractal = NAN, .roughness = NAN};
    int kind = LAW_LINEAR;
    if (json_choice(json, object, "law", LAWS, &kind) < 0)
        return -1;
    read.kind = (enum contact_law_kind)kind;
    if ((kind == LAW_LINEAR ? read_linear : read_elastic)(json, object, &read) ||
        json_number(json, object, "mu", 0, 10, &read.mu) < 0 ||
        json_number(json, object, "mu_wall", 0, 10, &read.mu_wall) < 0)
        return -1;
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
