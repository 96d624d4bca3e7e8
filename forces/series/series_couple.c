/* The linear algebra of one Newton step of series: every state is factorised by itself (sparse.h), the shared
 * unknowns are solved by preconditioned conjugate gradients (Hestenes and Stiefel 1952) on their Schur complement
 *
 *     S = I + sum_s B' (D + G' A' K^-1 A G) B,   K = A (C - C D C) A' + softness,   G = C D,
 *
 * of which each product costs one solve per state. S is never formed. */
#include <stdlib.h>
#include <string.h>

#include "forces/algebra/vectors.h"
#include "forces/series/series_state.h"
#include "pipeline/speak/error.h"

enum { PRODUCTS = 400 }; /* limit of conjugate gradients */
#define WEIGHT 0.7       /* of a line that takes part in equilibrium, about: it only steers the preconditioner */

/* D = (C + slack)^-1 on the measured lines, zero elsewhere. */
static void invert(const double c[3], const double slack[2], int n, int t, double d[3])
{
    double nn = c[0] + slack[0], nt = c[1], tt = c[2] + slack[1];
    d[0] = d[1] = d[2] = 0;
    if (n && t) {
        double determinant = nn * tt - nt * nt;
        d[0] = tt / determinant, d[1] = -nt / determinant, d[2] = nn / determinant;
    } else if (n) {
        d[0] = 1 / nn;
    } else if (t) {
        d[2] = 1 / tt;
    }
}

/* A_c (C - C D C) A_c' of one contact. */
static void add_block(struct series_state *state, size_t c)
{
    const double *curve = state->curve[c];
    double(*g)[2] = state->take[c], block[NETWORK_WIDTH * NETWORK_WIDTH];
    const double h[3] = {curve[0] - g[0][0] * curve[0] - g[0][1] * curve[1],
                         curve[1] - g[0][0] * curve[1] - g[0][1] * curve[2],
                         curve[2] - g[1][0] * curve[1] - g[1][1] * curve[2]};
    contact_block(&state->network.contact[c], h, NETWORK_WIDTH, block);
    sparse_add(state->matrix, c, block);
}

/* D, G and K of one state. An open contact has no part in equilibrium: its G is 0. */
static int factorise(const struct series *series, struct series_state *state)
{
    (void)series;
    sparse_clear(state->matrix);
    for (size_t c = 0; c < state->network.count; c++) {
        const double *curve = state->curve[c];
        double *d = state->gain[c];
        invert(curve, state->slack[c], !isnan(state->measured[c][0]), !isnan(state->measured[c][1]), d);
        double couples = state->open[c] ? 0 : 1;
        state->take[c][0][0] = couples * (curve[0] * d[0] + curve[1] * d[1]);
        state->take[c][0][1] = couples * (curve[0] * d[1] + curve[1] * d[2]);
        state->take[c][1][0] = couples * (curve[1] * d[0] + curve[2] * d[1]);
        state->take[c][1][1] = couples * (curve[1] * d[1] + curve[2] * d[2]);
        if (couples > 0 && curve[0] + curve[2] > 0)
            add_block(state, c);
    }
    sparse_add_diagonal(state->matrix, state->soft, 0);
    return sparse_factorise(state->matrix) < 0 ? -1 : 0;
}

/* The pattern of the preconditioner: every line of every state couples its shared unknowns. */
static int create_near(struct series *series)
{
    size_t blocks = 0, at = 0, width = (size_t)series->state[0].width;
    for (size_t s = 0; s < series->count; s++)
        blocks += series->state[s].network.count;
    int *place = malloc((blocks * width + 1) * sizeof *place);
    if (!place)
        return error_memory("shared unknowns");
    for (size_t s = 0; s < series->count; s++)
        for (size_t c = 0; c < series->state[s].network.count; c++) {
            int ended = 0;
            for (size_t k = 0; k < width; k++) {
                int p = series->state[s].place[c * width + k];
                ended |= p < 0;
                place[at++] = ended ? -1 : p;
            }
        }
    series->near = sparse_create(series->shared.count, blocks, (int)width, place);
    free(place);
    return series->near ? 0 : -1;
}

/* What a measured line weighs, about: without equilibrium D, with it nearly 1 / slack. */
static double weight(const struct series_state *state, size_t c, int k)
{
    double d = k ? state->gain[c][2] : state->gain[c][0], slack = state->slack[c][k];
    if (isnan(state->measured[c][k]))
        return 0;
    return d + WEIGHT * fmax(0, 1 / slack - d) * (state->take[c][k][k] > 0);
}

/* I + sum B' weight B, factorised. */
static int factorise_near(struct series *series)
{
    double block[SERIES_WIDTH * SERIES_WIDTH];
    size_t at = 0;
    if (!series->near && create_near(series))
        return -1;
    sparse_clear(series->near);
    for (size_t k = 0; k < series->shared.count; k++)
        series->diagonal[k] = 1;
    for (size_t s = 0; s < series->count; s++) {
        const struct series_state *state = &series->state[s];
        for (size_t c = 0; c < state->network.count; c++, at++) {
            const double *share = state->share + c * (size_t)state->width;
            const int *place = state->place + c * (size_t)state->width;
            double w = weight(state, c, NORMAL);
            int n = 0;
            while (n < state->width && place[n] >= 0)
                n++;
            for (int i = 0; i < n; i++)
                for (int j = 0; j <= i; j++)
                    block[i * state->width + j] = w * share[i] * share[j];
            if (w > 0)
                sparse_add(series->near, at, block);
            if (state->segment[c] >= 0)
                series->diagonal[series->shared.segment + state->segment[c]] +=
                    weight(state, c, TANGENTIAL) * SERIES_SEGMENT * SERIES_SEGMENT;
        }
    }
    sparse_add_diagonal(series->near, series->diagonal, 0);
    return sparse_factorise(series->near) < 0 ? -1 : 0;
}

int series_factorise(struct series *series)
{
    return series_for_states(series, factorise) || factorise_near(series) ? -1 : 0;
}

int series_for_states(struct series *series, series_work *work)
{
    struct error_shared shared = ERROR_SHARED_NONE;
#pragma omp parallel for schedule(dynamic) if (series->large)
    for (size_t s = 0; s < series->count; s++)
        if (work(series, &series->state[s]))
            error_share(&shared, (long)s);
    return error_collect(&shared);
}

void series_take(struct series_state *state, size_t c, double sign, const double g[2])
{
    double(*take)[2] = state->take[c];
    double n = take[0][0] * g[0] + take[0][1] * g[1], t = take[1][0] * g[0] + take[1][1] * g[1];
    contact_push(&state->network.contact[c], sign * n, sign * t, state->work);
}

void series_react(const struct series_state *state, size_t c, double lines, const double g[2], double motion,
                  const double u[2], double out[2])
{
    const double *d = state->gain[c];
    double(*take)[2] = state->take[c];
    double n = lines * d[0] * g[0] + lines * d[1] * g[1] + motion * take[0][0] * u[0] + motion * take[1][0] * u[1];
    double t = lines * d[1] * g[0] + lines * d[2] * g[1] + motion * take[0][1] * u[0] + motion * take[1][1] * u[1];
    out[0] = n, out[1] = t;
}

int series_state_solve(struct series_state *state)
{
    return sparse_solve(state->matrix, state->work, state->solution);
}

/* B' (D + G' A' K^-1 A G) B v of one state into its sum. */
static int state_product(const struct series *series, struct series_state *state)
{
    const struct network *network = &state->network;
    double(*u)[2] = state->derror, (*w)[2] = state->drelative;
    memset(state->work, 0, network->dofs * sizeof(double));
    for (size_t c = 0; c < network->count; c++) {
        series_error_at(series, state, c, series->v, u[c]);
        series_take(state, c, 1, u[c]);
    }
    if (series_state_solve(state))
        return -1;
    network_motion(network, state->solution, w[0]);
    for (size_t c = 0; c < network->count; c++)
        series_react(state, c, 1, u[c], 1, w[c], u[c]);
    series_gather(series, state, (const double(*)[2])u);
    return 0;
}

int series_product(struct series *series, const double *v, double *out)
{
    series->v = v;
    int status = series_for_states(series, state_product);
    series_add_up(series, out);
    for (size_t k = 0; k < series->shared.count; k++)
        out[k] += v[k];
    series->products++;
    return status;
}

/* Preconditioned by I + sum B' weight B: what S would be if equilibrium did not couple the contacts of a state. The
 * states are added up in their order, so that threads change nothing. */
int series_solve_shared(struct series *series, const double *right, double *dq, double share)
{
    size_t n = series->shared.count;
    double *r = series->vector[0], *z = series->vector[1], *p = series->vector[2], *sp = series->vector[3];
    memset(dq, 0, n * sizeof *dq);
    memcpy(r, right, n * sizeof *r);
    if (sparse_solve(series->near, r, z))
        return -1;
    memcpy(p, z, n * sizeof *p);
    double rz = vector_dot(n, r, z), aim = share * share * rz;
    for (int step = 0; step < PRODUCTS && rz > aim; step++) {
        if (series_product(series, p, sp))
            return -1;
        double alpha = rz / vector_dot(n, p, sp), before = rz;
        vector_add(n, alpha, p, dq);
        vector_add(n, -alpha, sp, r);
        if (sparse_solve(series->near, r, z))
            return -1;
        rz = vector_dot(n, r, z);
        for (size_t k = 0; k < n; k++)
            p[k] = z[k] + rz / before * p[k];
    }
    return 0;
}
