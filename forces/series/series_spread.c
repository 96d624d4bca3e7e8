/* What the solution leaves open, in the linear neighbourhood of the optimum (the same factors): standard errors of k_n
 * and of the offset, how much each photo has told, and draws of the forces. A draw disturbs every measurement, belief
 * and equation by an error of its stated size and moves to the optimum of the disturbed problem by one Newton step
 * (randomise, then optimise: exact for Gaussian errors), then back into the cones. */
#include <stdlib.h>
#include <string.h>

#include "forces/network/network_result.h"
#include "forces/series/series_spread.h"
#include "pipeline/speak/error.h"
#include "pipeline/numbers/random.h"

enum { PROBES = 6 };       /* of the trace */
#define SOLVED 0.02        /* residual of conjugate gradients */
#define LEAST_SPREAD 0.005 /* <fn>: what the softness of equilibrium alone leaves */

/* Random numbers by draw, kind (1 equations, 2 lines, 3 beliefs, 4 constants, 7 probes) and state. */
static uint64_t key_of(uint64_t draw, uint64_t what, uint64_t state)
{
    return random_bits(random_bits(draw, what), state);
}

/* Standard error of shared unknown k, in its own units of 1 beforehand. */
static int error_of_unknown(struct series *series, long k, double *error)
{
    double *right = series->vector[4];
    if (k < 0)
        return 0;
    memset(right, 0, series->shared.count * sizeof *right);
    right[k] = 1;
    if (series_solve_shared(series, right, series->dq, SOLVED))
        return -1;
    *error = sqrt(fmax(0, series->dq[k]));
    return 0;
}

/* trace of S^-1 times what state s adds to S, with random signs (Hutchinson 1990). Segments count as their own. */
static int information(struct series *series, struct series_photo *photo)
{
    size_t n = (size_t)series->shared.segment;
    double *sign = calloc(series->shared.count + 1, sizeof *sign);
    int status = sign ? 0 : error_memory("what the photos tell");
    for (uint64_t probe = 0; probe < PROBES && !status; probe++) {
        for (size_t k = 0; k < series->shared.count; k++)
            sign[k] = random_uniform(key_of(probe, 7, 0), k) < 0.5 ? -1 : 1;
        status = series_solve_shared(series, sign, series->dq, SOLVED) ||
                         series_product(series, series->dq, series->vector[4])
                     ? -1
                     : 0;
        for (size_t s = 0; s < series->count && !status; s++)
            for (size_t k = 0; k < n; k++)
                photo[s].information += sign[k] * series->state[s].sum[k] / PROBES;
    }
    free(sign);
    return status;
}

/* Errors of their stated sizes into what the equations leave: the response is the move of the optimum. */
static void disturb(struct series *series, uint64_t draw, size_t s)
{
    struct series_state *state = &series->state[s];
    for (size_t d = 0; d < state->network.dofs; d++)
        state->gy[d] = sqrt(state->soft[d]) * random_normal(key_of(draw, 1, s), d);
    for (size_t c = 0; c < state->network.count; c++) {
        double v[2], centre;
        series_belief(state, c, v, &centre);
        for (int k = 0; k < 2; k++) {
            uint64_t counter = 2 * c + (uint64_t)k;
            state->gl[c][k] = isnan(state->measured[c][k])
                                  ? 0
                                  : sqrt(state->slack[c][k]) * random_normal(key_of(draw, 2, s), counter);
            state->pull[c][k] = v[k] > 0 ? random_normal(key_of(draw, 3, s), counter) / sqrt(v[k]) : 0;
        }
    }
}

/* Sums of the squared moves of fn and ft, over the draws. */
static void collect(const struct series *series, const struct series_state *state, const struct contact_forces *found,
                    double (*sums)[2])
{
    for (size_t c = 0; c < state->network.count; c++) {
        size_t row = state->network.contact[c].row;
        double mu = state->network.contact[c].mu, n = found->fn[row] / series->force,
               t = found->ft[row] / series->force;
        double fn = fmax(0, n + state->df[c][0]), ft = fmax(-mu * fn, fmin(mu * fn, t + state->df[c][1]));
        sums[c][0] += pow(fn - n, 2), sums[c][1] += pow(ft - t, 2);
    }
}

/* Standard deviations about the forces found, not about the mean of the draws. */
static int store(const struct series *series, const struct series_state *state, const double (*sums)[2], int draws,
                 struct contact_forces *out)
{
    struct spread spread;
    int status = spread_alloc(state->network.count, &spread);
    double least = LEAST_SPREAD * state->mean;
    for (size_t c = 0; c < state->network.count && !status; c++)
        spread_set(&spread, c, out->fn[state->network.contact[c].row] / series->force,
                   hypot(least, sqrt(sums[c][0] / draws)), hypot(least / 2, sqrt(sums[c][1] / draws)));
    if (!status)
        status = result_store_spread(&state->network, &spread, out);
    spread_free(&spread);
    return status;
}

static int draw_forces(struct series *series, int draws, struct forces *forces)
{
    int status = 0;
    double(**sums)[2] = calloc(series->count + 1, sizeof *sums);
    for (size_t s = 0; sums && s < series->count; s++)
        status |= !(sums[s] = calloc(series->state[s].network.count + 1, sizeof *sums[s]));
    status = !sums || status ? error_memory("draws") : 0;
    for (uint64_t draw = 1; draw <= (uint64_t)draws && !status; draw++) {
        for (size_t s = 0; s < series->count; s++)
            disturb(series, draw, s);
        for (size_t k = 0; k < series->shared.count; k++)
            series->defect[k] = random_normal(key_of(draw, 4, 0), k);
        status = series_respond(series, SOLVED);
        for (size_t s = 0; s < series->count && !status; s++)
            collect(series, &series->state[s], &forces[s].contact, sums[s]);
    }
    for (size_t s = 0; s < series->count && !status; s++)
        status = store(series, &series->state[s], (const double(*)[2])sums[s], draws, &forces[s].contact);
    for (size_t s = 0; sums && s < series->count; s++)
        free(sums[s]);
    free(sums);
    return status;
}

int series_spread(struct series *series, int draws, struct forces *forces, struct series_summary *summary)
{
    double offset = 0, stiffness = 0;
    if (series_linearise(series) || error_of_unknown(series, series->shared.offset, &offset) ||
        error_of_unknown(series, series->shared.stiffness, &stiffness) || information(series, summary->photo))
        return -1;
    summary->s_offset *= offset;
    summary->s_kn = series->s_stiffness * stiffness * summary->kn;
    return draws > 1 ? draw_forces(series, draws, forces) : 0;
}
