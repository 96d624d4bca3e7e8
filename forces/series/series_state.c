/* One state of a series in memory, and the matrix B of its lines: which of the shared unknowns each overlap feels, and
 * how much. A unit of an unknown is its standard error, so that B holds kn x d overlap / d error x standard error. */
#include "forces/series/series_state.h"

#include <stdlib.h>
#include <string.h>

#include "forces/algebra/arena.h"
#include "pipeline/numbers/quantiles.h"
#include "pipeline/speak/error.h"

void series_state_free(struct series_state *state)
{
    sparse_free(state->matrix);
    network_free(&state->network);
    free(state->flags), free(state->open), free(state->changed), free(state->place), free(state->segment);
    free(state->store);
    memset(state, 0, sizeof *state);
}

/* Places of all vectors in one block; with block NULL only its length, so that counting and placing cannot differ. */
static size_t lay_out(struct series_state *state, size_t unknowns, double *block)
{
    struct arena taken = {.block = block}, *arena = &taken;
    size_t n = state->network.count, d = state->network.dofs;
    double **const of_dofs[] = {&state->soft, &state->y, &state->dy, &state->gy, &state->work, &state->solution};
    double(**const of_contacts[])[2] = {&state->measured, &state->variance, &state->slack,     &state->l,
                                        &state->dl,       &state->gl,       &state->relative,  &state->error,
                                        &state->derror,   &state->f,        &state->drelative, &state->df,
                                        &state->side,     &state->press,    &state->dpress,    &state->pull};
    for (size_t k = 0; k < sizeof of_dofs / sizeof *of_dofs; k++)
        *of_dofs[k] = arena_take(arena, d);
    for (size_t k = 0; k < sizeof of_contacts / sizeof *of_contacts; k++)
        *of_contacts[k] = arena_rows(arena, n, 2);
    state->curve = arena_rows(arena, n, 3), state->gain = arena_rows(arena, n, 3);
    state->take = arena_rows(arena, n, 4);
    state->share = arena_take(arena, n * (size_t)state->width);
    state->sum = arena_take(arena, unknowns);
    return arena->used;
}

/* -1 without memory; series_state_free() frees what is there. */
static int state_alloc(struct series_state *state, size_t unknowns)
{
    size_t n = state->network.count + 1;
    state->store = calloc(lay_out(state, unknowns, NULL) + 1, sizeof(double));
    state->open = calloc(n, 1), state->changed = calloc(n, 1);
    state->place = calloc(n * (size_t)state->width, sizeof(int));
    state->segment = calloc(n, sizeof(long));
    if (!state->store || !state->open || !state->changed || !state->place || !state->segment)
        return error_memory("states of the series");
    lay_out(state, unknowns, state->store);
    return 0;
}

/* The network's own unit of force gives way to that of the series. */
static void common_unit(struct series_state *state, double force)
{
    struct network *network = &state->network;
    for (size_t d = 0; d < network->dofs; d++)
        network->load[d] *= network->force / force;
    network->virial *= network->force / force;
    state->mean = network->force / force;
    network->force = force;
}

int series_state_build(struct series *series, size_t s)
{
    struct series_state *state = &series->state[s];
    struct packing view = *state->packing;
    struct network_options network_options = {.candidates = 1, .wall_mass = series->options->wall_mass};
    view.contacts.flags = state->flags;
    if (network_build(&view, &series->options->law, &network_options, &state->network))
        return -1;
    common_unit(state, series->force);
    state->width = 8 + (series->shared.shape >= 0 ? 4 * SERIES_HARMONICS : 0);
    state->matrix = network_matrix(&state->network);
    if (!state->matrix || state_alloc(state, series->shared.count))
        return -1;
    for (size_t c = 0; c < state->network.count; c++)
        state->segment[c] = -1;
    state->softness = pow(series->series_options->softness * state->mean, 2);
    for (size_t d = 0; d < state->network.dofs; d++)
        state->soft[d] = state->softness;
    return 0;
}

/* ---- what the overlaps say ---- */

/* A standard error that is not known counts as none: such a quantity is exact. */
static double error_of(const double *column, size_t row)
{
    double s = column_or_zero(column, row);
    return isfinite(s) && s > 0 ? s : 0;
}

/* The next entry of contact c in its row of B. */
static void add(struct series_state *state, size_t c, int *at, long place, double share)
{
    if (place < 0 || share == 0)
        return;
    state->place[c * (size_t)state->width + (size_t)*at] = (int)place;
    state->share[c * (size_t)state->width + (size_t)*at] = share;
    ++*at;
}

/* m, rms: as asked for, else as in the file. */
static double shape_error(const struct series *series, const struct grains *grains, size_t k)
{
    double given = series->series_options->shape;
    return isnan(given) ? error_of(grains->s_shape, k) : given;
}

/* The overlap grows by n . e of grain i, by -n . e of j, by the errors of both radii and rims; its own errors of this
 * photo add up. */
static double add_grain(const struct series *series, struct series_state *state, size_t c, size_t k, double sign,
                        int *at)
{
    const struct grains *g = &state->packing->grains;
    const struct series_shared *shared = &series->shared;
    size_t row = state->network.contact[c].row;
    double nx = sign * state->packing->contacts.nx[row], ny = sign * state->packing->contacts.ny[row];
    double kn = series->stiffness;
    add(state, c, at, shared->grain + 3 * (long)k, kn * nx * error_of(g->s_x_ref, k));
    add(state, c, at, shared->grain + 3 * (long)k + 1, kn * ny * error_of(g->s_y_ref, k));
    add(state, c, at, shared->grain + 3 * (long)k + 2, kn * error_of(g->s_radius, k));
    double shape = shared->shape >= 0 ? kn * shape_error(series, g, k) / sqrt(SERIES_HARMONICS) : 0;
    double direction = atan2(ny, nx) - (g->angle && isfinite(g->angle[k]) ? g->angle[k] : 0);
    for (int h = 0; h < SERIES_HARMONICS && shape > 0; h++) {
        long place = shared->shape + 2 * (long)(k * SERIES_HARMONICS + (size_t)h);
        add(state, c, at, place, shape * cos((h + 2) * direction));
        add(state, c, at, place + 1, shape * sin((h + 2) * direction));
    }
    return pow(kn * nx * error_of(g->s_x, k), 2) + pow(kn * ny * error_of(g->s_y, k), 2);
}

/* s_offset of the walls is taken for the error of their line in the reference; that of one photo is as a grain's. */
int series_median_error(const struct grains *g, double *median)
{
    double *s = malloc((g->count + 1) * sizeof *s);
    size_t count = 0;
    if (!s)
        return error_memory("errors of grains");
    for (size_t k = 0; k < g->count; k++)
        if (error_of(g->s_x, k) > 0)
            s[count++] = error_of(g->s_x, k);
    *median = count ? median_of(s, count) : 0;
    free(s);
    return 0;
}

int series_state_measure(struct series *series, size_t s, double offset, double s_offset)
{
    struct series_state *state = &series->state[s];
    const struct packing *packing = state->packing;
    double kn = series->stiffness, wall_error;
    if (series_median_error(&packing->grains, &wall_error))
        return -1;
    wall_error *= kn;
    for (size_t c = 0; c < state->network.count; c++) {
        size_t row = state->network.contact[c].row, w;
        int at = 0, wall = packing_is_wall(packing, row, &w);
        double overlap = packing->contacts.overlap[row], radii = wall ? 1 : 2;
        if (!isfinite(overlap))
            return error_input("contact %zu has an overlap that is not finite: run contacts again, or flag the row",
                               row);
        double variance = add_grain(series, state, c, (size_t)packing->contacts.i[row], 1, &at);
        if (!wall)
            variance += add_grain(series, state, c, (size_t)packing->contacts.j[row], -1, &at);
        else
            variance += wall_error * wall_error;
        if (wall)
            add(state, c, &at, series->shared.wall + (long)w, kn * error_of(packing->walls.s_offset, w));
        if (series->shared.offset >= 0)
            add(state, c, &at, series->shared.offset, radii * kn * s_offset);
        state->measured[c][NORMAL] = kn * (overlap - radii * offset);
        state->measured[c][TANGENTIAL] = NAN;
        if (series->shared.stiffness >= 0) { /* its share follows the estimate: series_follow_stiffness() */
            state->place[c * (size_t)state->width + (size_t)at] = (int)series->shared.stiffness;
            state->share[c * (size_t)state->width + (size_t)at++] = 0;
        }
        if (at < state->width)
            state->place[c * (size_t)state->width + (size_t)at] = -1;
        state->variance[c][NORMAL] = state->slack[c][NORMAL] = variance + LEAST_FORCE_ERROR * LEAST_FORCE_ERROR;
        state->variance[c][TANGENTIAL] = state->slack[c][TANGENTIAL] = 1;
    }
    return 0;
}

/* ---- B ---- */

void series_error_at(const struct series *series, const struct series_state *state, size_t c, const double *q,
                     double out[2])
{
    const int *place = state->place + c * (size_t)state->width;
    const double *share = state->share + c * (size_t)state->width;
    double sum = 0;
    for (int k = 0; k < state->width && place[k] >= 0; k++)
        sum += share[k] * q[place[k]];
    out[NORMAL] = sum;
    out[TANGENTIAL] = state->segment[c] >= 0 ? -SERIES_SEGMENT * q[series->shared.segment + state->segment[c]] : 0;
}

void series_gather(const struct series *series, struct series_state *state, const double (*v)[2])
{
    memset(state->sum, 0, (size_t)series->shared.segment * sizeof(double));
    state->gathered = v;
    for (size_t c = 0; c < state->network.count; c++) {
        const int *place = state->place + c * (size_t)state->width;
        const double *share = state->share + c * (size_t)state->width;
        for (int k = 0; k < state->width && place[k] >= 0; k++)
            state->sum[place[k]] += share[k] * v[c][NORMAL];
    }
}

void series_add_up(const struct series *series, double *out)
{
    memset(out, 0, series->shared.count * sizeof *out);
    for (size_t s = 0; s < series->count; s++) {
        const struct series_state *state = &series->state[s];
        for (size_t k = 0; k < (size_t)series->shared.segment; k++)
            out[k] += state->sum[k];
        for (size_t c = 0; c < state->network.count && series->shared.segments; c++)
            if (state->segment[c] >= 0)
                out[series->shared.segment + state->segment[c]] -= SERIES_SEGMENT * state->gathered[c][TANGENTIAL];
    }
}

int series_shared_resize(struct series *series)
{
    size_t n = series->shared.count, kept = series->shared.allocated < n ? series->shared.allocated : n;
    double *store = calloc(9 * n + 1, sizeof *store);
    if (!store)
        return error_memory("shared unknowns");
    if (kept > 0)
        memcpy(store, series->q, kept * sizeof *store);
    free(series->store);
    sparse_free(series->near);
    series->near = NULL; /* its pattern has changed */
    series->shared.allocated = n;
    struct arena arena = {.block = series->store = store};
    series->q = arena_take(&arena, n), series->dq = arena_take(&arena, n);
    series->diagonal = arena_take(&arena, n), series->defect = arena_take(&arena, n);
    for (int k = 0; k < 5; k++)
        series->vector[k] = arena_take(&arena, n);
    return 0;
}

double series_stiffness(const struct series *series)
{
    long k = series->shared.stiffness;
    return series->stiffness / (k >= 0 ? 1 - series->s_stiffness * series->q[k] : 1);
}

void series_follow_stiffness(struct series *series)
{
    if (series->shared.stiffness < 0)
        return;
    for (size_t s = 0; s < series->count; s++) {
        struct series_state *state = &series->state[s];
        for (size_t c = 0; c < state->network.count; c++) {
            int *place = state->place + c * (size_t)state->width, k = 0;
            while (place[k] != (int)series->shared.stiffness)
                k++;
            state->share[c * (size_t)state->width + (size_t)k] =
                state->open[c] ? 0 : -series->s_stiffness * state->f[c][NORMAL];
        }
    }
}
