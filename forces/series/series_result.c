#include "forces/series/series_result.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "forces/methods/known_forces.h"
#include "forces/network/network_result.h"
#include "pipeline/speak/error.h"

#define STATUS_MARGIN 1e-9 /* far above rounding */
/* Standard errors of an equation of equilibrium: the largest of some 5,000 stays below that, where nothing is missing.
 */
#define SERIES_BALANCE 5

/* The columns of one state, judged as every method is: f is clean, so that open contacts carry nothing. */
static int store(const struct series *series, struct series_state *state, struct forces *forces)
{
    const struct contact_law *law = &series->options->law;
    snprintf(forces->method, sizeof forces->method, "series");
    snprintf(forces->start, sizeof forces->start, "overlap");
    forces->imbalance = network_judge(&state->network, state->f[0], state->gy);
    forces->kn = series_stiffness(series) * series->force;
    forces->kt = forces->kn * law->kt_over_kn;
    forces->mu = law->mu;
    return result_store(state->packing, &state->network, STATUS_MARGIN, state->f[0], state->gy, forces);
}

/* Without the barrier's last bit: what carries nothing is 0, what slides is on its edge. */
static void clean(struct series_state *state)
{
    for (size_t c = 0; c < state->network.count; c++) {
        double mu = state->network.contact[c].mu, *f = state->f[c], carries = 1e-3 * state->mean;
        if (state->open[c] || (f[0] < carries && state->press[c][0] > state->side[c][0]))
            f[0] = f[1] = 0;
        else if (mu > 0 && mu * f[0] - fabs(f[1]) < carries * mu)
            f[1] = copysign(mu * f[0], f[1]);
    }
}

/* After clean(). */
static int carries(const struct series_state *state, size_t c)
{
    return !state->open[c] && state->f[c][0] > 0;
}

/* Pairs that carry, but did not in the state before. */
static int count_fresh(const struct series *series, size_t s, const struct forces *forces, struct series_photo *photo)
{
    const struct series_state *state = &series->state[s];
    if (s == 0)
        return 0;
    long *match = match_contacts(&state->packing->contacts, &series->state[s - 1].packing->contacts);
    if (!match)
        return -1;
    for (size_t c = 0; c < state->network.count; c++) {
        long row = match[state->network.contact[c].row];
        photo->fresh += carries(state, c) && (row < 0 || forces[s - 1].contact.fn[row] <= 0);
    }
    free(match);
    return 0;
}

/* What one photo brought: its forces, its data, and how well they agree: the squared errors of its lines and equations
 * over their variances, per datum. */
static void describe(const struct series *series, size_t s, struct series_photo *photo)
{
    const struct series_state *state = &series->state[s];
    double sum = 0, carrying = 0, misfit = 0;
    photo->contacts = state->network.count;
    for (size_t c = 0; c < state->network.count; c++) {
        photo->open += !carries(state, c);
        if (carries(state, c))
            sum += state->f[c][0], carrying++;
        for (int k = 0; k < 2; k++)
            if (!isnan(state->measured[c][k])) {
                photo->data++;
                misfit += state->slack[c][k] * state->l[c][k] * state->l[c][k];
            }
    }
    for (size_t d = 0; d < state->network.dofs; d++)
        misfit += state->soft[d] * state->y[d] * state->y[d];
    photo->data += state->network.dofs;
    photo->misfit = photo->data ? misfit / (double)photo->data : 0;
    photo->mean = carrying > 0 ? sum / carrying * series->force : 0;
}

/* The same of all photos, with the shared unknowns' own part |q|^2. */
static void summarise(const struct series *series, const struct series_loads *loads, struct series_summary *summary)
{
    double data = 0, misfit = 0;
    summary->gradient = series->gradient;
    summary->steps = series->steps, summary->products = series->products;
    summary->unknowns = series->shared.count, summary->segments = series->shared.segments;
    summary->offset = loads->offset, summary->s_offset = loads->s_offset;
    summary->kn = series_stiffness(series) * series->force, summary->s_kn = loads->s_kn;
    summary->refused = loads->refused;
    for (size_t k = 0; k < series->shared.count; k++)
        misfit += series->q[k] * series->q[k];
    for (size_t s = 0; s < series->count; s++) {
        data += (double)summary->photo[s].data;
        misfit += summary->photo[s].misfit * (double)summary->photo[s].data;
    }
    summary->misfit = data > 0 ? misfit / data : 0;
    if (series->shared.offset >= 0)
        summary->offset += loads->s_offset * series->q[series->shared.offset];
}

int series_results(struct series *series, const struct series_loads *loads, struct forces *forces,
                   struct series_summary *summary)
{
    summary->photo = calloc(series->count + 1, sizeof *summary->photo);
    if (!summary->photo)
        return error_memory("states of the series");
    summary->converged =
        series->gap <= SERIES_LAST_GAP && series->gradient <= SERIES_LAST_GRADIENT && series->pull <= SERIES_LAST_PULL;
    for (size_t s = 0; s < series->count; s++) {
        clean(&series->state[s]);
        if (store(series, &series->state[s], &forces[s]))
            return -1;
        forces[s].iterations = series->steps, forces[s].solved = summary->converged ? 1 : -1;
        describe(series, s, &summary->photo[s]);
        forces[s].data_misfit = summary->photo[s].misfit;
        double tolerance = SERIES_BALANCE * series->series_options->softness;
        if (result_sum_up(series->state[s].packing, &series->options->law, tolerance, &forces[s]))
            return -1;
        if (count_fresh(series, s, forces, &summary->photo[s]))
            return -1;
    }
    summarise(series, loads, summary);
    return 0;
}
