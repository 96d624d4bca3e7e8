/* The states of a simulation kept in memory, for tests. */
#ifndef TESTS_KEPT_STATES_H
#define TESTS_KEPT_STATES_H

#include <stdlib.h>
#include <string.h>

#include "simulation/dem/simulate.h"

struct kept_states {
    struct packing *packing;
    struct simulation_state *state;
    size_t count;
};

static int keep_state(const struct packing *packing, const struct simulation_state *state, void *user)
{
    struct kept_states *kept = user;
    struct packing *packings = realloc(kept->packing, (kept->count + 1) * sizeof *packings);
    if (packings)
        kept->packing = packings;
    struct simulation_state *states = realloc(kept->state, (kept->count + 1) * sizeof *states);
    if (states)
        kept->state = states;
    if (!packings || !states)
        return -1;
    struct packing *copy = &kept->packing[kept->count];
    memset(copy, 0, sizeof *copy);
    kept->state[kept->count++] = *state;
    copy->length_m = packing->length_m;
    copy->info.index = state->index;
    copy->force_count = 1;
    copy->forces = calloc(1, sizeof *copy->forces);
    *copy->forces = *packing->forces;
    memset(&copy->forces->contact, 0, sizeof copy->forces->contact);
    memset(&copy->forces->residual, 0, sizeof copy->forces->residual);
    return table_copy(&GRAINS, &copy->grains, &packing->grains) || table_copy(&WALLS, &copy->walls, &packing->walls) ||
           table_copy(&CONTACTS, &copy->contacts, &packing->contacts) ||
           table_copy(&CONTACT_FORCES, &copy->forces->contact, &packing->forces->contact) ||
           table_copy(&RESIDUALS, &copy->forces->residual, &packing->forces->residual);
}

static void kept_free(struct kept_states *kept)
{
    for (size_t k = 0; k < kept->count; k++)
        packing_free(&kept->packing[k]);
    free(kept->packing);
    free(kept->state);
    memset(kept, 0, sizeof *kept);
}

#endif
