#include "forces/series/series_result.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "pipeline/speak/error.h"
#include "pipeline/packing/stress.h"

static uint32_t status_of(double mu, double fn, double ft)
{
    if (fn <= 0)
        return STATUS_OPEN;
    return mu > 0 && fabs(ft) >= mu * fn * (1 - 1e-9) ? STATUS_SLIP : STATUS_STICK;
}

static int store(const struct series *series, const struct series_state *state, struct forces *forces)
{
    static const char *const names[] = {"fn", "ft", "status", NULL};
    const struct packing *packing = state->packing;
    struct contact_forces *out = &forces->contact;
    snprintf(forces->method, sizeof forces->method, "series");
    snprintf(forces->start, sizeof forces->start, "overlap");
    if (table_alloc(&CONTACT_FORCES, out, packing->contacts.count, names) ||
        table_alloc(&RESIDUALS, &forces->residual, packing->grains.count, NULL))
        return -1;
    for (size_t c = 0; c < out->count; c++)
        out->fn[c] = out->ft[c] = 0, out->status[c] = STATUS_NOT_USED;
    for (size_t c = 0; c < state->network.count; c++) {
        size_t row = state->network.contact[c].row;
        out->fn[row] = state->open[c] ? 0 : state->f[c][0] * series->force;
        out->ft[row] = state->open[c] ? 0 : state->f[c][1] * series->force;
        out->status[row] = status_of(state->network.contact[c].mu, out->fn[row], out->ft[row]);
    }
    forces->kn = series_stiffness(series) * series->force;
    forces->kt = forces->kn * series->options->law.kt_over_kn;
    forces->mu = series->options->law.mu;
    memcpy(forces->misfit, state->network.misfit, sizeof forces->misfit);
    double area;
    if (packing_area(packing, &area))
        return -1;
    stress_weber(packing, out->fn, out->ft, area, forces->stress);
    return 0;
}

/* Unbalanced forces of the grains, and the judge's figure. */
static int judge(struct series_state *state, struct forces *forces)
{
    const struct network *network = &state->network;
    const struct grains *g = &state->packing->grains;
    double largest = 0, sum = 0, pushing = 0;
    memcpy(state->gy, network->load, network->dofs * sizeof(double));
    for (size_t c = 0; c < network->count; c++) {
        const struct network_contact *contact = &network->contact[c];
        for (int e = 0; e < NETWORK_WIDTH && contact->dof[e] >= 0 && !state->open[c]; e++)
            state->gy[contact->dof[e]] += contact->n[e] * state->f[c][0] + contact->t[e] * state->f[c][1];
        sum += state->open[c] ? 0 : state->f[c][0], pushing += !state->open[c] && state->f[c][0] > 0;
    }
    for (size_t d = 0; d < network->dofs; d++)
        largest = fmax(largest, fabs(state->gy[d]));
    forces->imbalance = sum > 0 ? largest / (sum / pushing) : largest;
    for (size_t k = 0; k < g->count; k++) {
        long dof = network->grain_dof[k];
        int rests = dof < 0 && !network->peeled[k];
        double force = network->force, *gy = state->gy;
        forces->residual.residual_x[k] = dof >= 0 ? gy[dof] * force : rests || !g->load_x ? 0 : g->load_x[k];
        forces->residual.residual_y[k] = dof >= 0 ? gy[dof + 1] * force : rests || !g->load_y ? 0 : g->load_y[k];
        forces->residual.residual_m[k] = dof >= 0              ? gy[dof + 2] * force * network->radius
                                         : rests || !g->load_m ? 0
                                                               : g->load_m[k];
    }
    return 0;
}

/* Without the barrier's last bit: what carries nothing is 0, what slides is on its edge. */
static void clean(struct series_state *state)
{
    for (size_t c = 0; c < state->network.count; c++) {
        double mu = state->network.contact[c].mu, *f = state->f[c], carries = 1e-3 * state->mean;
        if (state->open[c] || (f[0] < carries && state->push[c][0] > state->side[c][0]))
            f[0] = f[1] = 0;
        else if (mu > 0 && mu * f[0] - fabs(f[1]) < carries * mu)
            f[1] = copysign(mu * f[0], f[1]);
    }
}

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

void series_summary_free(struct series_summary *summary)
{
    free(summary->photo);
    summary->photo = NULL;
}

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
        if (store(series, &series->state[s], &forces[s]) || judge(&series->state[s], &forces[s]))
            return -1;
        forces[s].iterations = series->steps, forces[s].converged = summary->converged;
        describe(series, s, &summary->photo[s]);
        forces[s].data_misfit = summary->photo[s].misfit;
        if (count_fresh(series, s, forces, &summary->photo[s]))
            return -1;
    }
    summarise(series, loads, summary);
    return 0;
}
