/* The list of the laws, and how a scene's "contact" becomes one of them. */
#include "pipeline/laws/contact_law.h"
#include "pipeline/files/json.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { MOST_KEYS = 16 };

/* Every law that a scene may name, the default first; a new law is entered here. */
static const struct law *const LAWS[] = {&linear_law, &hertz_mindlin_law, &hertz_pfc_law, &pohrt_popov_law,
                                         &pohrt_popov_plastic_law};
enum { LAWS_COUNT = sizeof LAWS / sizeof *LAWS };

const struct law *contact_law_row(const struct contact_law *law)
{
    return law->row ? law->row : &linear_law;
}

static double *number_at(struct contact_law *law, const struct law_key *key)
{
    return (double *)(void *)((char *)law + key->at);
}

int contact_law_known(const struct contact_law *law)
{
    struct contact_law copy = *law;
    double given = *number_at(&copy, contact_law_row(law)->keys);
    return isfinite(given) && given > 0;
}

void contact_law_set_grains(struct contact_law *law, double young, double poisson)
{
    law->young = young;
    law->poisson = poisson;
    law->kt_over_kn = 2 * (1 - poisson) / (2 - poisson);
}

static int check_keys(const struct law *row, const struct json *json, const cJSON *object)
{
    const char *names[MOST_KEYS + 4] = {"law"};
    int n = 1;
    for (const struct law_key *key = row->keys; key->name && n <= MOST_KEYS; key++)
        names[n++] = key->name;
    names[n++] = "mu";
    names[n] = "mu_wall";
    return json_check_keys(json, object, names);
}

/* All that is missing is named at once. */
static int read_numbers(const struct law *row, const struct json *json, const cJSON *object, struct contact_law *law)
{
    char missing[400] = "";
    for (const struct law_key *key = row->keys; key->name; key++) {
        int there = json_number(json, object, key->name, key->min, key->max, number_at(law, key));
        size_t used = strlen(missing);
        if (there < 0)
            return -1;
        if (!there && key->needed)
            snprintf(missing + used, sizeof missing - used, "%s%s", used ? " and " : "", key->name);
    }
    return *missing
               ? json_error(json, object, "law '%s' (%s) needs %s in 'contact': add it", row->name, row->says, missing)
               : 0;
}

int contact_law_read_as(const struct law *row, const struct json *json, const cJSON *object, struct contact_law *law)
{
    struct contact_law read = CONTACT_LAW_DEFAULT;
    read.row = row;
    if (check_keys(row, json, object))
        return -1;
    if (read_numbers(row, json, object, &read))
        return -1;
    if (!isnan(read.poisson))
        contact_law_set_grains(&read, read.young, read.poisson);
    if (json_number(json, object, "mu", 0, 10, &read.mu) < 0 ||
        json_number(json, object, "mu_wall", 0, 10, &read.mu_wall) < 0)
        return -1;
    *law = read;
    return 0;
}

int contact_law_read(const struct json *json, const cJSON *object, struct contact_law *law)
{
    const char *names[LAWS_COUNT + 1] = {NULL};
    int chosen = 0;
    for (int k = 0; k < LAWS_COUNT; k++)
        names[k] = LAWS[k]->name;
    if (json_choice(json, object, "law", names, &chosen) < 0)
        return -1;
    return contact_law_read_as(LAWS[chosen], json, object, law);
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
