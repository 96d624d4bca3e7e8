#include "forces/series/series_status.h"

#define OUT_OF_BALANCE 5 /* standard errors of an equation */
#define CARRIES 1e-2     /* <fn>: a contact with less may open */

/* The most likely overlap is the measured one less the errors found so far. An open contact closes where A' y, what
 * equilibrium offers for a force there, exceeds twice its gap over the variance of its line. */
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

/* Largest residual of grain k's equations, in standard errors. */
static double grain_residual(const struct series_state *state, size_t first)
{
    double largest = 0;
    for (size_t d = first; d < first + 3; d++)
        largest = fmax(largest, fabs(state->soft[d] * state->y[d]));
    return largest / sqrt(state->softness);
}

size_t series_let_go(struct series *series)
{
    size_t found = 0;
    for (size_t s = 0; s < series->count; s++) {
        struct series_state *state = &series->state[s];
        for (size_t k = 0; k < state->network.grains; k++) {
            long first = state->network.grain_dof[k];
            if (first < 0)
                continue;
            double residual = grain_residual(state, (size_t)first);
            double factor = residual > OUT_OF_BALANCE ? 1 + residual * residual : 1;
            for (long d = first; d < first + 3; d++) { /* the equation's residual stays, so its multiplier shrinks */
                state->y[d] *= state->soft[d] / (factor * state->softness);
                state->soft[d] = factor * state->softness;
            }
            found += factor > 1;
        }
    }
    return found;
}

size_t series_open_and_close(struct series *series)
{
    size_t changed = 0;
    for (size_t s = 0; s < series->count; s++)
        changed += open_and_close(&series->state[s]);
    return changed;
}
