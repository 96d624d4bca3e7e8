/* The contacts of the state before are looked up by rows that are sorted by their first grain (a counting sort), so
 * that the cost is linear. A candidate that was none before, or the other way round, is an event: CONTACT_NEW,
 * CONTACT_OPENED. */
#include "contacts/motion/state_motion.h"

#include <stdlib.h>

#include "contacts/motion/pair_motion.h"
#include "pipeline/speak/error.h"

/* un, ut: motion since the reference, for pairs that may have touched there. */
void move_since_reference(const struct moved_state *state, struct packing *packing)
{
    struct contacts *contacts = &packing->contacts;
    struct state_before before = {.at = state->reference, .walls = &state->frame->reference};
    for (size_t w = 0; w < 8; w++)
        before.s_wall[w] = state->frame->s_motion[w];
    for (size_t c = 0; c < contacts->count; c++) {
        const struct pair *pair = &state->pairs->pair[c];
        if (state->is_reference) {
            contacts->un[c] = contacts->ut[c] = contacts->s_un[c] = contacts->s_ut[c] = 0;
        } else if (state->reference) {
            struct contact_motion motion = contact_motion(&packing->grains, &packing->walls, pair, &before);
            if (!(motion.overlap_before > -state->candidate_sigmas * pair->s_overlap))
                continue;
            contacts->un[c] = motion.un;
            contacts->ut[c] = motion.ut;
            contacts->s_un[c] = motion.s_un;
            contacts->s_ut[c] = motion.s_ut;
        }
    }
}

/* Row of pair (i, j) in the previous contacts, whose rows of grain i begin at start[i]; -1: none. */
static long find_before(const struct contacts *before, const size_t *order, const size_t *start, int64_t i, int64_t j)
{
    for (size_t e = start[i]; e < start[i + 1]; e++)
        if (before->j[order[e]] == j)
            return (long)order[e];
    return -1;
}

/* dun, dut of one contact; a pair that was not in contact before is new. */
static void move_one(const struct moved_state *state, size_t c, long row, const struct state_before *before,
                     struct packing *packing)
{
    struct contacts *contacts = &packing->contacts;
    const struct contacts *old = &state->previous->contacts;
    int candidate = (contacts->flags[c] & CONTACT_CANDIDATE) != 0;
    if (row < 0 || (!candidate && (old->flags[row] & CONTACT_CANDIDATE))) {
        contacts->flags[c] |= CONTACT_NEW;
        return;
    }
    if (candidate && !(old->flags[row] & CONTACT_CANDIDATE))
        contacts->flags[c] |= CONTACT_OPENED;
    struct contact_motion motion = contact_motion(&packing->grains, &packing->walls, &state->pairs->pair[c], before);
    contacts->dun[c] = motion.un;
    contacts->dut[c] = motion.ut;
    contacts->s_dun[c] = motion.s_un;
    contacts->s_dut[c] = motion.s_ut;
}

int move_since_previous(const struct moved_state *state, struct packing *packing)
{
    const struct packing *previous = state->previous;
    const struct contacts *old = &previous->contacts;
    size_t grains = previous->grains.count;
    size_t *start = calloc(grains + 2, sizeof *start), *order = malloc((old->count + 1) * sizeof *order);
    struct vec *at = malloc((grains + 1) * sizeof *at);
    if (!start || !order || !at) {
        free(start);
        free(order);
        free(at);
        return error_memory("previous state");
    }
    for (size_t c = 0; c < old->count; c++)
        start[old->i[c] + 2]++;
    for (size_t k = 2; k < grains + 2; k++)
        start[k] += start[k - 1];
    for (size_t c = 0; c < old->count; c++)
        order[start[old->i[c] + 1]++] = c;
    for (size_t k = 0; k < grains; k++)
        at[k] = vec(previous->grains.x[k], previous->grains.y[k]);
    struct state_before before = {.at = at,
                                  .angle = previous->grains.angle,
                                  .walls = &previous->walls,
                                  .s_x = previous->grains.s_x,
                                  .s_y = previous->grains.s_y,
                                  .s_angle = previous->grains.s_angle};
    for (size_t w = 0; w < 8; w++)
        before.s_wall[w] = state->frame->s_motion[w]; /* as with grains: the reference drops out */
    for (size_t c = 0; c < packing->contacts.count; c++) {
        const struct pair *pair = &state->pairs->pair[c];
        move_one(state, c, find_before(old, order, start, pair->i, pair->j), &before, packing);
    }
    free(start);
    free(order);
    free(at);
    return 0;
}
