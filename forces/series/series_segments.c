/* Tangential information: from photo to photo a contact that sticks moves its force by -kt du_t, whatever that force
 * is. A segment is a run of consecutive photos in which one contact sticks; its forces are one unknown constant plus
 * the motion measured since the run began. Segments come from the present estimate: they end where the contact opens,
 * comes near the edge of its cone, or is predicted beyond it. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "forces/methods/known_forces.h"
#include "forces/series/series_status.h"
#include "pipeline/speak/error.h"

#define STICKS 0.97       /* |ft| / (mu fn) of the estimate */
#define PREDICTED 0.95    /* the same of what the motion predicts */
#define LEAST_FORCE 0.02  /* <fn>: contacts that carry less may have opened in between */
#define AGREES 3          /* standard deviations */
#define ESTIMATE 0.03     /* <fn>: of the estimate of a tangential force */
#define TRUSTED 0.97      /* share of links that must agree */
#define LEAST_ERROR 0.015 /* <fn>: of the law along a step that is not small */

/* By the present forces: the contact bears, and its tangential force is within `share` of the cone. */
static int sticks(const struct series_state *state, size_t c, double ft, double share)
{
    double fn = state->f[c][0];
    return !state->open[c] && fn > LEAST_FORCE * state->mean && fabs(ft) <= share * state->network.contact[c].mu * fn;
}

/* Index of each row of the packing in the network, or -1; to be freed. */
static long *rows_to_contacts(const struct series_state *state)
{
    size_t rows = state->packing->contacts.count;
    long *index = malloc((rows + 1) * sizeof *index);
    for (size_t r = 0; index && r < rows; r++)
        index[r] = -1;
    for (size_t c = 0; index && c < state->network.count; c++)
        index[state->network.contact[c].row] = (long)c;
    return index;
}

/* rad; NaN without that column. */
static double angle_of(const struct grains *g, size_t k)
{
    return g->angle ? g->angle[k] : NAN;
}

/* du_t of docs/theory.md 1 between two states: row `b` before, row `a` now, on the mean of both tangents. */
static double tangential_motion(const struct packing *before, size_t b, const struct packing *now, size_t a)
{
    size_t i = (size_t)now->contacts.i[a], j = (size_t)now->contacts.j[a];
    const struct grains *g = &now->grains, *h = &before->grains;
    struct vec n =
        vec_unit(vec(now->contacts.nx[a] + before->contacts.nx[b], now->contacts.ny[a] + before->contacts.ny[b]));
    struct vec moved = vec((g->x[j] - h->x[j]) - (g->x[i] - h->x[i]), (g->y[j] - h->y[j]) - (g->y[i] - h->y[i]));
    double half = 0.25 * (now->contacts.overlap[a] + before->contacts.overlap[b]);
    return vec_dot(moved, vec_turn(n)) - (g->radius[i] - half) * (angle_of(g, i) - angle_of(h, i)) -
           (g->radius[j] - half) * (angle_of(g, j) - angle_of(h, j));
}

/* A variance from an optional standard error; 0 where it is not known. */
static double squared(const double *column, size_t k)
{
    double s = column_or_zero(column, k);
    return isfinite(s) ? s * s : 0;
}

/* Variance of kt u_t since the reference, of this photo's own errors. */
static double motion_variance(const struct series *series, const struct series_state *state, size_t row)
{
    const struct contacts *contacts = &state->packing->contacts;
    const struct grains *g = &state->packing->grains;
    double tx = contacts->ny[row], ty = contacts->nx[row], sum = 0;
    double kt = series_stiffness(series) * series->options->law.kt_over_kn;
    size_t ends[2] = {(size_t)contacts->i[row], (size_t)contacts->j[row]};
    for (int e = 0; e < 2; e++)
        sum += tx * tx * squared(g->s_x, ends[e]) + ty * ty * squared(g->s_y, ends[e]) +
               pow(g->radius[ends[e]], 2) * squared(g->s_angle, ends[e]);
    return kt * kt * sum + LEAST_ERROR * LEAST_ERROR;
}

static void measure(const struct series *series, struct series_state *state, size_t c, long segment, double moved)
{
    state->segment[c] = segment;
    state->measured[c][TANGENTIAL] = moved;
    state->variance[c][TANGENTIAL] = motion_variance(series, state, state->network.contact[c].row);
}

/* A contact that seems to stick from one state to the next. */
struct link {
    size_t now, before;
    double moved; /* -kt du_t in between */
    int agrees;   /* with the estimate of both forces */
};

/* The change of ft between two states is what the motion between them says, to AGREES standard errors. */
static int agree(const struct series *series, size_t s, const struct link *link)
{
    const struct series_state *now = &series->state[s], *before = &series->state[s - 1];
    double variance = motion_variance(series, now, now->network.contact[link->now].row) +
                      motion_variance(series, before, before->network.contact[link->before].row);
    double left = now->f[link->now][1] - before->f[link->before][1] - link->moved;
    return fabs(left) <= AGREES * sqrt(variance + 2 * ESTIMATE * ESTIMATE);
}

/* Contacts of state s that go on sticking from state s - 1. */
static int find_links(const struct series *series, size_t s, const long *before_of, struct link *links, size_t *count)
{
    const struct series_state *now = &series->state[s], *before = &series->state[s - 1];
    long *match = match_contacts(&now->packing->contacts, &before->packing->contacts);
    double kt = series_stiffness(series) * series->options->law.kt_over_kn;
    *count = 0;
    if (!match)
        return -1;
    for (size_t a = 0; a < now->network.count; a++) {
        size_t row = now->network.contact[a].row, w;
        long b = match[row] >= 0 ? before_of[match[row]] : -1;
        if (b < 0 || packing_is_wall(now->packing, row, &w) || !(now->network.contact[a].mu > 0))
            continue;
        double moved = -kt * tangential_motion(before->packing, (size_t)match[row], now->packing, row);
        if (!isfinite(moved) || !sticks(before, (size_t)b, before->f[b][1], STICKS) ||
            !sticks(now, a, now->f[a][1], STICKS) || !sticks(now, a, before->f[b][1] + moved, PREDICTED))
            continue;
        struct link link = {a, (size_t)b, moved, 0};
        link.agrees = agree(series, s, &link);
        links[(*count)++] = link;
    }
    free(match);
    return 0;
}

/* Links that the forces contradict are left out; where they are many, so much has slipped in between that the others
 * cannot be trusted either, and no run goes on from that photo to the next. `before_of`: the contact of state s - 1 in
 * each row. */
static int link_states(struct series *series, size_t s, const long *before_of)
{
    struct series_state *now = &series->state[s], *before = &series->state[s - 1];
    struct link *links = malloc((now->network.count + 1) * sizeof *links);
    size_t count, good = 0;
    if (!links)
        return error_memory("segments");
    int status = find_links(series, s, before_of, links, &count);
    for (size_t k = 0; k < count && !status; k++)
        good += (size_t)links[k].agrees;
    for (size_t k = 0; k < count && !status && (double)good >= TRUSTED * (double)count; k++) {
        size_t a = links[k].now, b = links[k].before;
        if (!links[k].agrees)
            continue;
        if (before->segment[b] < 0)
            measure(series, before, b, (long)series->shared.segments++, 0);
        measure(series, now, a, before->segment[b], before->measured[b][TANGENTIAL] + links[k].moved);
    }
    free(links);
    return status;
}

/* All segments end: none is known, their unknowns are gone. */
static void forget(struct series *series)
{
    series->shared.segments = 0;
    series->shared.count = (size_t)series->shared.segment;
    for (size_t s = 0; s < series->count; s++)
        for (size_t c = 0; c < series->state[s].network.count; c++) {
            series->state[s].segment[c] = -1;
            series->state[s].measured[c][TANGENTIAL] = NAN;
            series->state[s].l[c][TANGENTIAL] = 0;
        }
}

/* Each constant starts at the mean of what the estimate says. */
static int start_constants(struct series *series)
{
    size_t n = series->shared.segments;
    double *sum = calloc(2 * n + 1, sizeof *sum);
    if (!sum)
        return error_memory("segments");
    for (size_t s = 0; s < series->count; s++) {
        const struct series_state *state = &series->state[s];
        for (size_t c = 0; c < state->network.count; c++)
            if (state->segment[c] >= 0) {
                sum[2 * state->segment[c]] += state->f[c][1] - state->measured[c][TANGENTIAL];
                sum[2 * state->segment[c] + 1]++;
            }
    }
    for (size_t k = 0; k < n; k++)
        series->q[series->shared.segment + (long)k] = sum[2 * k] / sum[2 * k + 1] / SERIES_SEGMENT;
    free(sum);
    return 0;
}

/* A run goes on through a link, or begins with it: the state before is then its first, with no motion. */
int series_find_segments(struct series *series)
{
    long *before = rows_to_contacts(&series->state[0]), *now = NULL;
    int status = before ? 0 : error_memory("segments");
    forget(series);
    for (size_t s = 1; s < series->count && !status; s++) {
        now = rows_to_contacts(&series->state[s]);
        status = now ? link_states(series, s, before) : error_memory("segments");
        free(before);
        before = now;
    }
    free(before);
    if (status)
        return -1;
    series->shared.count += series->shared.segments;
    return series_shared_resize(series) || start_constants(series) ? -1 : 0;
}
