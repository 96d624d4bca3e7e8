#include "contacts/network/standing.h"

#include <stdlib.h>

#include "contacts/network/holding.h"
#include "pipeline/speak/error.h"

/* The contacts of each grain: those of grain k are of[start[k]] .. of[start[k + 1] - 1]. */
struct incidence {
    size_t *start, *of;
    size_t *peeled; /* grains waiting to be taken away */
};

static int counts(const struct packing *packing, size_t c)
{
    return !(packing->contacts.flags[c] & (CONTACT_CANDIDATE | CONTACT_NOT_FINITE));
}

static void incidence_free(struct incidence *incidence)
{
    free(incidence->start);
    free(incidence->of);
    free(incidence->peeled);
}

static int incidence_build(const struct packing *packing, struct incidence *incidence)
{
    size_t grains = packing->grains.count, contacts = packing->contacts.count;
    *incidence = (struct incidence){.start = calloc(grains + 2, sizeof *incidence->start),
                                    .of = malloc((2 * contacts + 1) * sizeof *incidence->of),
                                    .peeled = malloc((grains + 1) * sizeof *incidence->peeled)};
    if (!incidence->start || !incidence->of || !incidence->peeled)
        return error_memory("contacts of each grain");
    for (int pass = 0; pass < 2; pass++) {
        for (size_t c = 0; c < contacts; c++) {
            int64_t ends[2] = {packing->contacts.i[c], packing->contacts.j[c]};
            for (int e = 0; counts(packing, c) && e < 2; e++) {
                if ((size_t)ends[e] >= grains)
                    continue;
                if (pass == 0)
                    incidence->start[ends[e] + 2]++;
                else
                    incidence->of[incidence->start[ends[e] + 1]++] = c;
            }
        }
        for (size_t k = 2; pass == 0 && k < grains + 2; k++)
            incidence->start[k] += incidence->start[k - 1];
    }
    return 0;
}

static int is_loaded(const struct grains *grains, size_t k)
{
    return column_or_zero(grains->load_x, k) != 0 || column_or_zero(grains->load_y, k) != 0 ||
           column_or_zero(grains->load_m, k) != 0;
}

static int is_gone(const struct packing *packing, int64_t body)
{
    return (size_t)body < packing->grains.count && (packing->grains.flags[body] & GRAIN_RATTLER);
}

/* A grain that has not been taken away and that its contacts do not hold. */
static int falls(const struct packing *packing, const struct stability_rules *rules, const struct incidence *incidence,
                 size_t k)
{
    const struct grains *grains = &packing->grains;
    const struct contacts *contacts = &packing->contacts;
    struct hold holds[HOLDS_MOST + 1];
    size_t count = 0;
    if (grains->flags[k] & (GRAIN_FIXED | GRAIN_RATTLER | GRAIN_NOT_FINITE))
        return 0;
    for (size_t e = incidence->start[k]; e < incidence->start[k + 1] && count <= HOLDS_MOST; e++) {
        size_t c = incidence->of[e];
        int first = contacts->i[c] == (int64_t)k, wall = (size_t)contacts->j[c] >= grains->count;
        if (!is_gone(packing, first ? contacts->j[c] : contacts->i[c]))
            holds[count++] = (struct hold){vec_scale(first ? 1 : -1, vec(contacts->nx[c], contacts->ny[c])),
                                           wall ? rules->mu_wall : rules->mu};
    }
    if (rules->weightless)
        return !grain_is_held(holds, count, vec(0, 0), 0);
    struct vec load = vec(column_or_zero(grains->load_x, k), column_or_zero(grains->load_y, k));
    return !grain_is_held(holds, count, load, column_or_zero(grains->load_m, k) / grains->radius[k]);
}

/* `waiting`: grains that fall and are to be taken away; each is flagged when it joins them. */
static void let_fall(struct packing *packing, struct incidence *incidence, size_t k, size_t *waiting)
{
    struct grains *grains = &packing->grains;
    grains->flags[k] |= is_loaded(grains, k) ? GRAIN_RATTLER | GRAIN_FLOATING : GRAIN_RATTLER;
    incidence->peeled[(*waiting)++] = k;
}

/* What grain k touched may fall now. */
static void take_away(struct packing *packing, const struct stability_rules *rules, struct incidence *incidence,
                      size_t k, size_t *waiting)
{
    for (size_t e = incidence->start[k]; e < incidence->start[k + 1]; e++) {
        size_t c = incidence->of[e];
        int64_t other = packing->contacts.i[c] == (int64_t)k ? packing->contacts.j[c] : packing->contacts.i[c];
        if ((size_t)other < packing->grains.count && falls(packing, rules, incidence, (size_t)other))
            let_fall(packing, incidence, (size_t)other, waiting);
    }
}

int stability_flag(struct packing *packing, const struct stability_rules *rules)
{
    struct incidence incidence;
    struct grains *grains = &packing->grains;
    size_t waiting = 0;
    for (size_t k = 0; k < grains->count; k++)
        grains->flags[k] &= ~(uint32_t)(GRAIN_RATTLER | GRAIN_FLOATING);
    if (incidence_build(packing, &incidence)) {
        incidence_free(&incidence);
        return -1;
    }
    for (size_t k = 0; k < grains->count; k++)
        if (falls(packing, rules, &incidence, k))
            let_fall(packing, &incidence, k, &waiting);
    for (size_t next = 0; next < waiting; next++)
        take_away(packing, rules, &incidence, incidence.peeled[next], &waiting);
    incidence_free(&incidence);
    return 0;
}

/* Let candidate c speak for its floating grains. best[k]: the most probable candidate of grain k so far. */
static void consider(const struct packing *packing, size_t c, size_t *best)
{
    const struct contacts *contacts = &packing->contacts;
    int64_t ends[2] = {contacts->i[c], contacts->j[c]};
    if (!(contacts->flags[c] & CONTACT_CANDIDATE) || (contacts->flags[c] & CONTACT_NOT_FINITE))
        return;
    for (int e = 0; e < 2; e++) {
        if ((size_t)ends[e] >= packing->grains.count || !(packing->grains.flags[ends[e]] & GRAIN_FLOATING))
            continue;
        size_t *chosen = &best[ends[e]];
        if (*chosen == (size_t)-1 || contacts->probability[c] > contacts->probability[*chosen])
            *chosen = c;
    }
}

int stability_repair(struct packing *packing, const struct stability_rules *rules, size_t *promoted)
{
    size_t grains = packing->grains.count, found = 1, *best = malloc((grains + 1) * sizeof *best);
    *promoted = 0;
    if (!best)
        return error_memory("repair");
    int status = stability_flag(packing, rules);
    while (status == 0 && found) {
        found = 0;
        for (size_t k = 0; k < grains; k++)
            best[k] = (size_t)-1;
        for (size_t c = 0; c < packing->contacts.count; c++)
            consider(packing, c, best);
        for (size_t k = 0; k < grains; k++) {
            if (best[k] == (size_t)-1 || !(packing->contacts.flags[best[k]] & CONTACT_CANDIDATE))
                continue;
            packing->contacts.flags[best[k]] &= ~(uint32_t)CONTACT_CANDIDATE;
            packing->contacts.flags[best[k]] |= CONTACT_PROMOTED;
            found++;
        }
        *promoted += found;
        status = found ? stability_flag(packing, rules) : 0;
    }
    free(best);
    return status;
}
