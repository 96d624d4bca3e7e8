/* The stages of series: what the loads say, then the joint problem with ever smaller errors; which contacts are open
 * and where tangential segments end is decided between the stages, never inside one. */
#include "forces/series/series.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "forces/infer_forces.h"
#include "forces/series/series_loads.h"
#include "forces/series/series_result.h"
#include "forces/series/series_spread.h"
#include "forces/series/series_state.h"
#include "forces/series/series_status.h"
#include "pipeline/speak/error.h"

#define CANDIDATE 4   /* standard errors: pairs further apart are left out */
#define OTHER_ROD 0.1 /* of the radius */
enum {
    ROUNDS = 4, /* of opening and closing contacts at the full weight of the overlaps */
    LARGE =
        4000, /* contacts of all states: with more, states are shared among the threads; fewer cost less than that */
};

/* ---- the series in memory ---- */

void series_summary_free(struct series_summary *summary)
{
    free(summary->photo);
    summary->photo = NULL;
}

static void series_free(struct series *series)
{
    for (size_t s = 0; series->state && s < series->count; s++)
        series_state_free(&series->state[s]);
    sparse_free(series->near);
    free(series->state), free(series->store);
}

/* Rim shapes cost eight unknowns per grain: only when some rim is not round, as given or as measured. */
static int shapes_unknown(const struct packing *packing, double given)
{
    if (!isnan(given))
        return given > 0;
    for (size_t k = 0; packing->grains.s_shape && k < packing->grains.count; k++)
        if (packing->grains.s_shape[k] > 0)
            return 1;
    return 0;
}

/* All but the segments, which come last and change: SERIES_HARMONICS pairs for each rim. */
static void number_unknowns(const struct packing *packing, const struct series_options *options,
                            const struct series_loads *loads, struct series_shared *shared)
{
    size_t next = 0, grains = packing->grains.count;
    shared->grain = 0, next += 3 * grains;
    shared->wall = (long)next, next += packing->walls.count;
    shared->offset = options->fit_offset ? (long)next++ : -1;
    shared->stiffness = loads->s_kn > 0 ? (long)next++ : -1;
    shared->shape = shapes_unknown(packing, options->shape) ? (long)next : -1;
    next += shared->shape >= 0 ? 2 * SERIES_HARMONICS * grains : 0;
    shared->segment = (long)next, shared->segments = 0;
    shared->count = next;
}

/* Standard error of the overlap of row c, constant and of one photo together. */
static double overlap_error(const struct packing *packing, size_t row)
{
    const struct grains *g = &packing->grains;
    const double *const columns[] = {g->s_x_ref, g->s_radius, g->s_x};
    size_t i = (size_t)packing->contacts.i[row], w;
    size_t j = packing_is_wall(packing, row, &w) ? i : (size_t)packing->contacts.j[row];
    double sum = 0;
    for (int k = 0; k < 3; k++) {
        double a = column_or_zero(columns[k], i), b = j == i ? 0 : column_or_zero(columns[k], j);
        sum += (isfinite(a) ? a * a : 0) + (isfinite(b) ? b * b : 0);
    }
    return sqrt(sum);
}

/* Pairs that the offset, now known, puts too far apart to touch. */
static int leave_out_far(struct series_state *state, double offset)
{
    const struct packing *packing = state->packing;
    const struct contacts *contacts = &packing->contacts;
    state->flags = calloc(contacts->count + 1, sizeof *state->flags);
    if (!state->flags)
        return error_memory("states of the series");
    for (size_t c = 0; c < contacts->count; c++) {
        size_t w;
        double radii = packing_is_wall(packing, c, &w) ? 1 : 2;
        state->flags[c] = contacts->flags ? contacts->flags[c] : 0;
        if (contacts->overlap[c] - radii * offset < -CANDIDATE * overlap_error(packing, c))
            state->flags[c] |= CONTACT_NOT_FINITE;
    }
    return 0;
}

/* The common unit of force is <fn> of the most loaded state, so that numbers of all states compare. */
static int series_begin(const struct packing *const *packings, size_t count, const struct series_loads *loads,
                        struct series *series)
{
    size_t contacts = 0;
    series->count = count;
    series->force = loads->force;
    series->stiffness = loads->kn / loads->force;
    series->s_stiffness = loads->s_kn / loads->kn;
    series->state = calloc(count + 1, sizeof *series->state);
    number_unknowns(packings[0], series->series_options, loads, &series->shared);
    if (!series->state || series_shared_resize(series))
        return error_memory("states of the series");
    for (size_t s = 0; s < count; s++) {
        series->state[s].packing = packings[s];
        if (leave_out_far(&series->state[s], loads->offset) || series_state_build(series, s) ||
            series_state_measure(series, s, loads->offset, loads->s_offset))
            return error_context("state %zu of the series", s + 1);
        contacts += series->state[s].network.count;
    }
    series->large = contacts > LARGE;
    return 0;
}

/* ---- stages ---- */

/* An optimum for the present open contacts, then what it tells about them. */
static int stage(struct series *series, const struct series_aim *aim)
{
    if (series_optimise(series, aim))
        return -1;
    series_open_and_close(series);
    if (aim->loose == 0) { /* too early otherwise: what is still closed would pull kn down */
        series_follow_stiffness(series);
        series_let_go(series);
    }
    return 0;
}

/* Overlaps count little at first, as if each had an error of its own of 0.3 <fn>: so equilibrium sorts out which
 * contacts carry before single overlaps are believed. Tangential segments need good forces: they come last, twice. */
static int stages(struct series *series)
{
    static const struct series_aim loose[] = {{1, 0.3, 0.03, 0.1, 1}, {0, 0.1, 0.03, 0.1, 1}, {0, 0.03, 0.03, 0.1, 3}};
    static const struct series_aim tight = {0, 0, 0.03, 0.1, 3};
    static const struct series_aim last = {0, 0, SERIES_LAST_GAP, SERIES_LAST_GRADIENT, SERIES_LAST_PULL};
    for (size_t k = 0; k < sizeof loose / sizeof *loose; k++)
        if (stage(series, &loose[k]))
            return -1;
    for (int k = 0; k < ROUNDS; k++)
        if (stage(series, &tight))
            return -1;
    for (int k = 0; k < 2 && series->series_options->tangential; k++)
        if (series_find_segments(series) || stage(series, &tight))
            return -1;
    return series_optimise(series, &last);
}

/* Rods keep their radii: a row whose radius is another one by 10 % is another rod. */
static int check_same_rods(const struct grains *first, const struct grains *grains, size_t state)
{
    for (size_t k = 0; k < grains->count; k++)
        if (fabs(grains->radius[k] - first->radius[k]) > OTHER_ROD * first->radius[k])
            return error_input(
                "state %zu of the series: grain %zu has radius %g m, in the first state %g m: give states "
                "that were followed from the same reference photo",
                state + 1, k, grains->radius[k], first->radius[k]);
    return 0;
}

/* The states belong together, and have what every one needs. */
static int check_series(const struct packing *const *packings, size_t count, const struct force_options *options)
{
    if (!(isfinite(options->law.kn) && options->law.kn > 0))
        return error_input("no contact stiffness: method series needs the scene's contact.kn_N_per_m");
    for (size_t s = 0; s < count; s++) {
        if (!packings[s]->contacts.overlap)
            return error_input("state %zu of the series has no overlaps: run contacts again", s + 1);
        if (packings[s]->grains.count != packings[0]->grains.count ||
            packings[s]->walls.count != packings[0]->walls.count)
            return error_input("state %zu of the series has other grains or walls than the first: give states of one "
                               "series",
                               s + 1);
        if (check_same_rods(&packings[0]->grains, &packings[s]->grains, s))
            return -1;
    }
    return 0;
}

/* One photo has no other to share its errors with: map is the whole answer. */
static int infer_alone(const struct packing *packing, const struct force_options *options,
                       const struct series_options *series_options, struct forces *forces,
                       struct series_summary *summary)
{
    struct force_options map = *options;
    map.samples = series_options->samples;
    summary->photo = calloc(1, sizeof *summary->photo);
    if (!summary->photo)
        return error_memory("states of the series");
    if (infer_forces(packing, &map, METHOD_MAP, forces))
        return -1;
    snprintf(forces->method, sizeof forces->method, "series");
    summary->converged = forces->converged;
    summary->kn = options->law.kn;
    summary->photo->contacts = forces->contact.count;
    return 0;
}

int infer_series(const struct packing *const *packings, size_t count, const struct force_options *options,
                 const struct series_options *series_options, struct forces *forces, struct series_summary *summary)
{
    struct series series = {.options = options, .series_options = series_options};
    struct series_loads loads;
    memset(forces, 0, count * sizeof *forces);
    memset(summary, 0, sizeof *summary);
    if (check_series(packings, count, options))
        return -1;
    if (count == 1)
        return infer_alone(packings[0], options, series_options, forces, summary);
    if (series_loads_fit(packings, count, options, series_options->fit_offset, series_options->fit_stiffness, &loads))
        return -1;
    int status = series_begin(packings, count, &loads, &series) || stages(&series) ||
                         series_results(&series, &loads, forces, summary) ||
                         series_spread(&series, series_options->samples, forces, summary)
                     ? -1
                     : 0;
    series_free(&series);
    if (status)
        for (size_t s = 0; s < count; s++)
            forces_free(&forces[s]);
    return status;
}
