/* One interior point for all states and their shared constants at once. For given open contacts the joint problem is a
 * convex quadratic programme:
 *
 *     minimise 1/2 |q|^2 + sum_s [1/2 |f - f0|^2 / V + 1/2 |r|^2 / slack + 1/2 |A f + b|^2 / softness]
 *     with     f + B q + r = m on the measured lines,  G f >= 0 (the cone: mu fn - ft, mu fn + ft; fn without
 * friction),
 *
 * y, l, press the multipliers of A f + b + softness y = 0, of the lines, and of the edges of the cones. An open contact
 * has no part in equilibrium and the half line f <= 0, which stands for its gap. Every step solves one linear system in
 * all unknowns (primal-dual, Wright 1997): contacts are eliminated one by one, states by their factors, and q by
 * conjugate gradients; so no state is ever solved within another iteration. */
#include <stdlib.h>
#include <string.h>

#include "forces/algebra/cone.h"
#include "forces/series/series_state.h"
#include "pipeline/speak/error.h"

enum { STEPS = 80 };    /* limit of one optimum */
#define FIRST_GAP 3.0   /* side times press, from scratch */
#define WARM_GAP 0.03   /* the same, at least, where it goes on from the last stage */
#define WARM_FORCE 0.03 /* <fn>: what a contact that opens or closes begins with, at least */
#define BOUNDARY 0.99   /* share of the way to the boundary that a step may go */
#define OPEN_MEAN 3     /* <fn>: size of a gap */
#define SHARED 0.1      /* residual that conjugate gradients leave */

/* ---- one contact ---- */

/* An open contact slides freely. */
static double friction(const struct series_state *state, size_t c)
{
    return state->open[c] ? 0 : state->network.contact[c].mu;
}

static int sides(const struct series_state *state, size_t c)
{
    return cone_sides(friction(state, c));
}

/* V and f0: wide about <fn>; ft as far as Coulomb allows, fn being spread exponentially; a gap is a few <fn> wide. */
void series_belief(const struct series_state *state, size_t c, double v[2], double *centre)
{
    double mu = friction(state, c), square = state->mean * state->mean;
    v[0] = (state->open[c] ? OPEN_MEAN * OPEN_MEAN * fmax(1, square) : SERIES_PRIOR_NN * square);
    v[1] = 2 * fmin(1, mu * mu) * square;
    *centre = state->open[c] ? 0 : state->mean;
}

/* G f; the one side of an open contact is f <= 0. */
static void edges(const struct series_state *state, size_t c, const double f[2], double out[2])
{
    cone_side(friction(state, c), f, out);
    out[0] = state->open[c] ? -out[0] : out[0];
}

/* G' a. */
static void edges_transposed(const struct series_state *state, size_t c, const double a[2], double out[2])
{
    cone_transposed(friction(state, c), a, out);
    out[0] = state->open[c] ? -out[0] : out[0];
}

/* C = (1 / V + G' diag(press / side) G)^-1. */
static void compliance(const struct series_state *state, size_t c, double out[3])
{
    double mu = friction(state, c), v[2], centre;
    double p = state->press[c][0] / state->side[c][0], m = state->press[c][1] / state->side[c][1];
    series_belief(state, c, v, &centre);
    if (mu > 0) {
        double nn = 1 / v[0] + mu * mu * (p + m), nt = mu * (m - p), tt = 1 / v[1] + p + m;
        /* nn tt - nt nt without cancellation */
        double determinant = 1 / (v[0] * v[1]) + (p + m) / v[0] + mu * mu * (p + m) / v[1] + 4 * mu * mu * p * m;
        out[0] = tt / determinant, out[1] = -nt / determinant, out[2] = nn / determinant;
    } else {
        out[0] = 1 / (1 / v[0] + p), out[1] = out[2] = 0;
    }
}

/* From scratch: the mean force, or a gap of the usual size. */
static void start_contact(struct series_state *state, size_t c, double gap)
{
    double mu = friction(state, c);
    state->f[c][0] = state->open[c] ? -OPEN_MEAN : state->mean, state->f[c][1] = 0;
    edges(state, c, state->f[c], state->side[c]);
    state->press[c][0] = gap / state->side[c][0], state->press[c][1] = mu > 0 ? gap / state->side[c][1] : 0;
}

/* Back into the inside from where the last stage ended: every product side times press is at least `gap`. */
static void restart_contact(struct series_state *state, size_t c, double gap)
{
    double mu = friction(state, c), *s = state->side[c], *p = state->press[c];
    if (state->changed[c]) {
        double overlap = state->measured[c][NORMAL] - state->error[c][NORMAL];
        state->f[c][0] = state->open[c] ? fmin(overlap, -WARM_FORCE) : fmax(overlap, WARM_FORCE * state->mean),
        state->f[c][1] = 0;
        edges(state, c, state->f[c], s);
        p[0] = gap / s[0], p[1] = mu > 0 ? gap / s[1] : 0;
        state->changed[c] = 0;
        return;
    }
    for (int k = 0; k < sides(state, c); k++) {
        s[k] = fmax(s[k], fmin(gap / p[k], sqrt(gap) * state->mean));
        p[k] = fmax(p[k], gap / s[k]);
    }
    cone_force(mu, s, state->f[c]);
    state->f[c][0] = state->open[c] ? -state->f[c][0] : state->f[c][0];
}

/* ---- the equations ---- */

static int state_start(const struct series *series, struct series_state *state)
{
    memset(state->y, 0, state->network.dofs * sizeof(double));
    memset(state->l, 0, state->network.count * sizeof *state->l);
    for (size_t c = 0; c < state->network.count; c++)
        start_contact(state, c, FIRST_GAP), state->changed[c] = 0;
    (void)series;
    return 0;
}

static int state_restart(const struct series *series, struct series_state *state)
{
    (void)series;
    for (size_t c = 0; c < state->network.count; c++)
        restart_contact(state, c, WARM_GAP);
    return 0;
}

static int gather_multipliers(const struct series *series, struct series_state *state)
{
    series_gather(series, state, (const double(*)[2])state->l);
    return 0;
}

/* What each equation leaves: gy, gl, and in `pull` that of the forces' own, W (f - f0) - A' y - l - G' press. */
static int state_residuals(const struct series *series, struct series_state *state)
{
    const struct network *network = &state->network;
    double worst = 0, gap = 0;
    network_motion(network, state->y, state->relative[0]);
    for (size_t d = 0; d < network->dofs; d++)
        state->gy[d] = network->load[d] + state->soft[d] * state->y[d];
    for (size_t c = 0; c < network->count; c++) {
        double v[2], centre, edge[2];
        series_error_at(series, state, c, series->q, state->error[c]);
        series_belief(state, c, v, &centre);
        edges_transposed(state, c, state->press[c], edge);
        for (int k = 0; k < 2; k++) {
            int there = k == 0 || friction(state, c) > 0;
            state->gl[c][k] =
                isnan(state->measured[c][k])
                    ? 0
                    : state->f[c][k] + state->error[c][k] + state->slack[c][k] * state->l[c][k] - state->measured[c][k];
            state->pull[c][k] = !there ? 0
                                       : (state->f[c][k] - (k ? 0 : centre)) / v[k] - state->l[c][k] - edge[k] -
                                             (state->open[c] ? 0 : state->relative[c][k]);
            worst = fmax(worst, fabs(state->gl[c][k]));
        }
        if (!state->open[c])
            contact_push(&network->contact[c], state->f[c][0], state->f[c][1], state->gy);
        for (int k = 0; k < sides(state, c); k++)
            gap += state->side[c][k] * state->press[c][k] / sides(state, c);
    }
    for (size_t d = 0; d < network->dofs; d++)
        worst = fmax(worst, fabs(state->gy[d]) / state->mean);
    state->sum[0] = worst, state->sum[1] = gap;
    return 0;
}

/* Of all states, then what they leave for q: defect = sum B' l - q. */
static int residuals(struct series *series)
{
    double contacts = 0;
    if (series_for_states(series, gather_multipliers))
        return -1;
    series_add_up(series, series->defect);
    series->gradient = series->gap = series->pull = 0;
    for (size_t k = 0; k < series->shared.count; k++) {
        series->defect[k] -= series->q[k];
        series->pull = fmax(series->pull, fabs(series->defect[k]));
    }
    if (series_for_states(series, state_residuals))
        return -1;
    for (size_t s = 0; s < series->count; s++) {
        series->gradient = fmax(series->gradient, series->state[s].sum[0]);
        series->gap += series->state[s].sum[1];
        contacts += (double)series->state[s].network.count;
    }
    series->gap /= fmax(1, contacts);
    return 0;
}

/* ---- a step ---- */

/* Aim at side times press = aim (below 0: the edges stay as they are); C pull goes to the right-hand sides of the other
 * equations. */
static int prepare(const struct series *series, struct series_state *state)
{
    const struct network *network = &state->network;
    double aim = series->aim;
    for (size_t c = 0; c < network->count; c++) {
        const double *curve = state->curve[c];
        double towards[2] = {0, 0}, edge[2];
        for (int k = 0; k < sides(state, c) && aim >= 0; k++)
            towards[k] = (aim - state->side[c][k] * state->press[c][k]) / state->side[c][k];
        edges_transposed(state, c, towards, edge);
        double p[2] = {edge[0] - state->pull[c][0], edge[1] - state->pull[c][1]};
        double moved[2] = {curve[0] * p[0] + curve[1] * p[1], curve[1] * p[0] + curve[2] * p[1]};
        for (int k = 0; k < 2; k++) {
            state->pull[c][k] = p[k];
            state->gl[c][k] += isnan(state->measured[c][k]) ? 0 : moved[k];
        }
        if (!state->open[c])
            contact_push(&network->contact[c], moved[0], moved[1], state->gy);
    }
    return 0;
}

/* B'[-D gl + G' A' K^-1 (gy - A G gl)] of one state into its sum (G = C D). */
static int state_right(const struct series *series, struct series_state *state)
{
    const struct network *network = &state->network;
    memcpy(state->work, state->gy, network->dofs * sizeof(double));
    for (size_t c = 0; c < network->count; c++)
        series_take(state, c, -1, state->gl[c]);
    if (series_state_solve(state))
        return -1;
    network_motion(network, state->solution, state->drelative[0]);
    for (size_t c = 0; c < network->count; c++)
        series_react(state, c, -1, state->gl[c], 1, state->drelative[c], state->dl[c]);
    series_gather(series, state, (const double(*)[2])state->dl);
    return 0;
}

/* dy = K^-1 (-gy + A G (gl + B dq)), dl = -D (gl + B dq) - G' A' dy, df = C (A' dy + dl + pull). */
static int state_step(const struct series *series, struct series_state *state)
{
    const struct network *network = &state->network;
    for (size_t d = 0; d < network->dofs; d++)
        state->work[d] = -state->gy[d];
    for (size_t c = 0; c < network->count; c++) {
        double *g = state->dl[c];
        series_error_at(series, state, c, series->dq, g);
        g[0] += state->gl[c][0], g[1] += state->gl[c][1];
        series_take(state, c, 1, g);
    }
    if (series_state_solve(state))
        return -1;
    memcpy(state->dy, state->solution, network->dofs * sizeof(double));
    network_motion(network, state->dy, state->drelative[0]);
    for (size_t c = 0; c < network->count; c++) {
        double *u = state->drelative[c], *curve = state->curve[c], *pull = state->pull[c], towards[2];
        u[0] *= !state->open[c], u[1] *= !state->open[c];
        series_react(state, c, -1, state->dl[c], -1, u, state->dl[c]);
        for (int k = 0; k < 2; k++)
            towards[k] = u[k] + state->dl[c][k] + pull[k];
        state->df[c][0] = curve[0] * towards[0] + curve[1] * towards[1];
        state->df[c][1] = curve[1] * towards[0] + curve[2] * towards[1];
    }
    return 0;
}

/* Steps of the edges and their multipliers; how far they stay positive. */
static int reach(const struct series *series, struct series_state *state)
{
    double length = 1 / BOUNDARY;
    for (size_t c = 0; c < state->network.count; c++) {
        double ds[2];
        edges(state, c, state->df[c], ds);
        for (int k = 0; k < sides(state, c); k++) {
            double s = state->side[c][k], p = state->press[c][k];
            state->dpress[c][k] = (series->aim - s * p - p * ds[k]) / s;
        }
        length = cone_reach(friction(state, c), state->side[c], ds, state->press[c], state->dpress[c], length);
    }
    state->sum[0] = length;
    return 0;
}

static int move(const struct series *series, struct series_state *state)
{
    double length = series->length;
    for (size_t d = 0; d < state->network.dofs; d++)
        state->y[d] += length * state->dy[d];
    for (size_t c = 0; c < state->network.count; c++) {
        double ds[2];
        edges(state, c, state->df[c], ds);
        for (int k = 0; k < 2; k++) {
            state->l[c][k] += length * state->dl[c][k];
            state->f[c][k] += length * state->df[c][k];
        }
        for (int k = 0; k < sides(state, c); k++) {
            state->side[c][k] += length * ds[k];
            state->press[c][k] += length * state->dpress[c][k];
        }
    }
    return 0;
}

static int compliances(const struct series *series, struct series_state *state)
{
    (void)series;
    for (size_t c = 0; c < state->network.count; c++)
        compliance(state, c, state->curve[c]);
    return 0;
}

int series_linearise(struct series *series)
{
    return series_for_states(series, compliances) || series_factorise(series) ? -1 : 0;
}

/* Steps of everything but the edges, for what gy, gl, pull and defect say. */
static int solve(struct series *series, double aim, double share)
{
    series->aim = aim;
    if (series_for_states(series, prepare) || series_for_states(series, state_right))
        return -1;
    series_add_up(series, series->vector[4]);
    for (size_t k = 0; k < series->shared.count; k++)
        series->vector[4][k] += series->defect[k];
    return series_solve_shared(series, series->vector[4], series->dq, share) || series_for_states(series, state_step)
               ? -1
               : 0;
}

int series_respond(struct series *series, double share)
{
    return solve(series, -1, share);
}

/* One Newton step of everything, as long as all sides and their multipliers stay positive. */
static int step(struct series *series, double aim)
{
    if (series_linearise(series) || solve(series, aim, SHARED) || series_for_states(series, reach))
        return -1;
    double length = 1 / BOUNDARY;
    for (size_t s = 0; s < series->count; s++)
        length = fmin(length, series->state[s].sum[0]);
    series->length = fmin(1, BOUNDARY * length);
    for (size_t k = 0; k < series->shared.count; k++)
        series->q[k] += series->length * series->dq[k];
    return series_for_states(series, move);
}

/* Overlaps are believed to their errors and `more`, in units. */
static void set_slack(struct series *series, double more)
{
    for (size_t s = 0; s < series->count; s++) {
        struct series_state *state = &series->state[s];
        for (size_t c = 0; c < state->network.count; c++)
            for (int k = 0; k < 2; k++)
                state->slack[c][k] = state->variance[c][k] + more * more;
    }
}

/* The aim shrinks the more, the longer the last step was: no predictor, as each solve costs conjugate gradients. */
int series_optimise(struct series *series, const struct series_aim *aim)
{
    double shrink = 0.2;
    set_slack(series, aim->loose);
    if (aim->cold)
        memset(series->q, 0, series->shared.count * sizeof(double));
    if (series_for_states(series, aim->cold ? state_start : state_restart) || residuals(series))
        return -1;
    for (int k = 0;
         k < STEPS && (series->gap > aim->gap || series->gradient > aim->gradient || series->pull > aim->pull);
         k++, series->steps++) {
        if (step(series, fmax(0.3 * aim->gap, shrink * series->gap)) || residuals(series))
            return -1;
        shrink = series->length > 0.9 ? 0.1 : series->length > 0.6 ? 0.2 : series->length > 0.3 ? 0.4 : 0.7;
    }
    return isfinite(series->gradient)
               ? 0
               : error_input("series: the forces are not finite: look for absurd numbers in the files");
}
