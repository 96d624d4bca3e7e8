#include "forces/series_status.h"

#define CARRIES 1e-2 /* of <fn> */

static size_t open_and_close(struct series_state *state)
{
    size_t changed = 0;
    for (size_t c = 0; c < state->network.count; c++) {
        double overlap = state->measured[c][NORMAL] - state->error[c][NORMAL];
        int open = state->open[c];
        if (!open)
            open = state->f[c][0] <= CARRIES * state->mean && overlap < 0;
        else
            open = overlap < 0 && state->relative[c][0] * state->slack[c][NORMAL] < -2 * overlap;
        if (open == state->open[c])
            continue;
        state->open[c] = (unsigned char)open;
        state->l[c][0] = state->l[c][1] = 0;
        state->changed[c] = 1;
        changed++;
    }
    return changed;
}

size_t series_open_and_close(struct series *series)
{
    size_t changed = 0;
    for (size_t s = 0; s < series->count; s++)
        changed += open_and_close(&series->state[s]);
    return changed;
}
