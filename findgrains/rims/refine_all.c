/* All rims, round by round: in a round each is fitted with its neighbours where they were in the round before, in
 * parallel, and all move together (Jacobi, not Gauss-Seidel), so that the outcome does not depend on the order. Two
 * rims that touch see each other's edge; some rounds bring them to rest. What still swings after PATIENCE rounds takes
 * shorter steps.
 *
 * What the fits need to know of the photo is learnt from a sample of the larger rims: the blur as the b that vanishes
 * (edge_fit.h), texture and band as those with which radii have the smallest standard errors, neighbouring sectors'
 * correlation r_1, r_2, ... as the factor sqrt(1 + 2 sum r) on standard errors. */
#include "findgrains/rims/refine_all.h"

#include "pipeline/numbers/quantiles.h"
#include "pipeline/speak/error.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { NEIGHBOURS = 64, LAGS = 8, FEW = 24, BLUR_ROUNDS = 12 };
#define LEAST_STEP 0.15  /* of the contrast: a sector with less has no edge */
#define FIRST_BLUR 1.0   /* px, before it is estimated */
#define FIRST_NOISE 0.03 /* of the contrast, before it is estimated */
#define VOID_SPREAD 0.25 /* of the contrast: how far the void's level may be from its median */
#define SECTOR 3.0       /* px along the rim */
/* 95 % efficient for normal errors; narrower where specks make outliers. */
#define TUKEY_PLAIN 4.685
#define TUKEY_TEXTURED 3.5
#define CLEARLY 0.93 /* more texture has to pay by this factor: it costs some bias */
#define PATIENCE 4
#define LEAST_BLUR 0.5 /* px: a sharper photo is undersampled, and steps of the fit would overshoot */
#define MOST_BLUR 8.0

struct rims_state rims_first_guess(const struct grey_levels *levels)
{
    double contrast = levels->grain_level - levels->void_level;
    return (struct rims_state){.blur = FIRST_BLUR,
                               .window = 2.5 * FIRST_BLUR,
                               .sector = SECTOR,
                               .least_step = LEAST_STEP * contrast,
                               .void_level = levels->void_level,
                               .void_spread = VOID_SPREAD * contrast,
                               .noise = FIRST_NOISE * contrast,
                               .correlation = 1};
}

int rims_make(const struct candidates *found, struct rims *rims)
{
    *rims = (struct rims){.count = found->count};
    size_t room = found->count ? found->count : 1;
    rims->items = calloc(room, sizeof *rims->items);
    rims->origin = calloc(room, sizeof *rims->origin);
    if (!rims->items || !rims->origin) {
        rims_free(rims);
        return error_memory("list of rims");
    }
    for (size_t k = 0; k < found->count; k++) {
        rims->items[k].rim = found->items[k].rim;
        rims->origin[k] = found->items[k];
    }
    return 0;
}

void rims_free(struct rims *rims)
{
    free(rims->items);
    free(rims->origin);
    *rims = (struct rims){0};
}

/* Rims within `reach` of rim k, in row order. */
static size_t gather_neighbours(const struct photo *photo, const struct rims *rims, size_t k, double reach,
                                struct rim *others)
{
    const struct rim *rim = &rims->items[k].rim;
    size_t count = 0;
    for (size_t j = 0; j < rims->count && count < NEIGHBOURS; j++) {
        const struct rim *other = &rims->items[j].rim;
        double limit = rim->radius + other->radius + reach, dx = other->x - rim->x, dy = other->y - rim->y;
        if (j != k && dx * dx + dy * dy < limit * limit && rim_is_possible(photo, other))
            others[count++] = *other;
    }
    return count;
}

/* Nothing to do: a known grain that is lost, or a rim whose last step was far below any standard error. */
static int is_done(const struct refined *item, int leave_still)
{
    if (!isfinite(item->rim.x + item->rim.y + item->rim.radius))
        return 1;
    return leave_still && item->support > 0 && item->moved < RIMS_STILL;
}

/* One iteration on some rows, each from where it is; rough > 0: with the blur of a place that is
 * known that much of its spread. Results into `to`. */
static int iterate(const struct photo *photo, const struct zone *zone, const struct edge_settings *settings,
                   int ellipse, double rough, const struct rims *rims, struct rows rows, struct refined *to)
{
    struct error_shared failure = ERROR_SHARED_NONE;
#pragma omp parallel
    {
        struct edge_work work = {0};
#pragma omp for schedule(dynamic, 8)
        for (size_t at = 0; at < rows.count; at++) {
            size_t k = rows.list ? rows.list[at] : at;
            struct rim others[NEIGHBOURS];
            struct edge_settings own = *settings;
            to[at] = rims->items[k];
            if (is_done(&rims->items[k], rows.leave_still))
                continue;
            if (rough > 0) {
                if (to[at].support > 0 && rough * rims->origin[k].spread < settings->blur)
                    continue; /* near enough for the fine fit */
                own.blur = fmax(settings->blur, fmin(rough * rims->origin[k].spread, 0.15 * rims->items[k].rim.radius));
                own.window = fmin(2.5 * own.blur, 0.5 * rims->items[k].rim.radius);
            }
            own.window = fmin(own.window, 0.7 * rims->items[k].rim.radius);
            size_t count = gather_neighbours(photo, rims, k, own.window + 5 * own.blur, others);
            if (refine_circle(photo, zone, others, count, &own, ellipse, &work, &to[at]))
                error_share(&failure, (long)k);
        }
        edge_work_free(&work);
    }
    return error_collect(&failure);
}

static struct edge_settings settings_of(const struct rims_state *state)
{
    return (struct edge_settings){.blur = state->blur,
                                  .window = state->window,
                                  .sector = state->sector,
                                  .least_step = state->least_step,
                                  .void_level = state->void_level,
                                  .void_spread = state->void_spread,
                                  .noise = state->noise,
                                  .texture = state->texture,
                                  .tukey = state->texture > 0 ? TUKEY_TEXTURED : TUKEY_PLAIN,
                                  .damping = state->blur > LEAST_BLUR ? 1 : 0.5};
}

/* A rim that could not be fitted, or left its place, goes back to where it was captured and has no support. */
static void accept(struct rims *rims, struct rows rows, struct refined *next, double rough)
{
    for (size_t at = 0; at < rows.count; at++) {
        size_t k = rows.list ? rows.list[at] : at;
        const struct rim *old = &rims->items[k].rim, *new = &next[at].rim;
        double limit = rough > 0 ? 4 * rims->origin[k].spread + 1 : 3;
        if (!(next[at].support > 0 && hypot(new->x - old->x, new->y - old->y) < limit &&
              fabs(new->radius - old->radius) < limit && new->radius > 0)) {
            next[at].rim = rims->origin[k].captured;
            next[at].support = 0;
        }
        rims->items[k] = next[at];
    }
}

static int iterate_and_accept(const struct photo *photo, const struct zone *zone, const struct edge_settings *settings,
                              int ellipse, double rough, struct rims *rims, struct rows rows)
{
    struct refined *next = calloc(rows.count ? rows.count : 1, sizeof *next);
    if (!next)
        return error_memory("list of rims");
    int status = iterate(photo, zone, settings, ellipse, rough, rims, rows, next);
    if (!status)
        accept(rims, rows, next, rough);
    free(next);
    return status;
}

int rims_approach(const struct photo *photo, const struct zone *zone, const struct rims_state *state, int blur_is_known,
                  struct rims *rims, struct rows rows)
{
    struct edge_settings settings = settings_of(state);
    double rough = 1, closer = blur_is_known ? 0.4 : 0.7;
    settings.damping = blur_is_known ? settings.damping : 0.5;
    for (int round = 0; round < (blur_is_known ? 3 : 6); round++, rough *= closer)
        if (iterate_and_accept(photo, zone, &settings, state->ellipse, rough, rims, rows))
            return -1;
    return 0;
}

int rims_iterate(const struct photo *photo, const struct zone *zone, const struct rims_state *state, int most,
                 struct rims *rims, struct rows rows)
{
    struct edge_settings settings = settings_of(state);
    rows.leave_still = 1;
    for (size_t at = 0; at < rows.count; at++)
        rims->items[rows.list ? rows.list[at] : at].moved = INFINITY;
    for (int k = 0; k < most; k++) {
        size_t moving = 0;
        if (k >= PATIENCE) /* what still swings is calmed */
            settings.damping = k >= 2 * PATIENCE - 1 ? 0.25 : 0.5;
        if (iterate_and_accept(photo, zone, &settings, state->ellipse, 0, rims, rows))
            return -1;
        for (size_t at = 0; at < rows.count; at++)
            moving += rims->items[rows.list ? rows.list[at] : at].moved >= RIMS_STILL;
        if (moving == 0)
            break;
    }
    return 0;
}

struct rows rims_all(const struct rims *rims)
{
    return (struct rows){NULL, rims->count, 0};
}

/* Median of one member of the refined rims that have support; NaN when there is none. */
static double median_member(const struct refined *items, size_t count, size_t member)
{
    double values[RIMS_SAMPLE];
    size_t n = 0;
    for (size_t k = 0; k < count && n < RIMS_SAMPLE; k++) {
        double value = *(const double *)((const char *)&items[k] + member);
        if (items[k].support > 0 && isfinite(value))
            values[n++] = value;
    }
    return median_of(values, n);
}

/* Up to RIMS_SAMPLE rows spread evenly over the larger half of the rims. */
int rims_sample(const struct rims *rims, size_t sample[RIMS_SAMPLE], struct rows *rows)
{
    *rows = (struct rows){sample, 0, 0};
    if (rims->count == 0)
        return 0;
    double *radii = malloc(rims->count * sizeof *radii);
    if (!radii)
        return error_memory("a sample of the rims");
    for (size_t k = 0; k < rims->count; k++)
        radii[k] = rims->items[k].rim.radius;
    double median = select_rank(radii, rims->count, rims->count / 2);
    free(radii);
    size_t large = 0, seen = 0, count = 0;
    for (size_t k = 0; k < rims->count; k++)
        large += rims->items[k].rim.radius >= median;
    size_t step = (large + RIMS_SAMPLE - 1) / RIMS_SAMPLE;
    for (size_t k = 0; k < rims->count && count < RIMS_SAMPLE; k++)
        if (rims->items[k].rim.radius >= median && seen++ % step == 0)
            sample[count++] = k;
    rows->count = count;
    return 0;
}

/* One round: places, then the blur's error from them; NaN: no rim could be fitted. */
static int blur_round(const struct photo *photo, const struct zone *zone, struct rims_state *state, struct rims *rims,
                      struct rows rows, double *error)
{
    struct refined fitted[RIMS_SAMPLE];
    struct edge_settings settings = settings_of(state);
    settings.window = 3 * state->blur;
    settings.damping = 0.7;
    if (iterate(photo, zone, &settings, state->ellipse, 0, rims, rows, fitted))
        return -1;
    for (size_t k = 0; k < rows.count; k++)
        if (fitted[k].support > 0)
            rims->items[rows.list[k]].rim = fitted[k].rim;
    settings.fit_blur = 1;
    settings.window = 3.5 * state->blur;
    settings.sector = 2 * state->sector;
    if (iterate(photo, zone, &settings, state->ellipse, 0, rims, rows, fitted))
        return -1;
    *error = median_member(fitted, rows.count, offsetof(struct refined, blur_error));
    if (isfinite(*error)) {
        double step = fmin(0.5 * state->blur, fmax(-0.25 * state->blur, *error));
        state->blur = fmin(MOST_BLUR, fmax(LEAST_BLUR, state->blur + step));
    }
    return 0;
}

/* Blur and places of the sample in turn: each is only right once the other is. A few rims bring it near, all of them
 * to where it belongs: 1 % of the blur is as much as a hundredth of a pixel in all radii. */
int rims_estimate_blur(const struct photo *photo, const struct zone *zone, struct rims_state *state, struct rims *rims,
                       struct rows rows)
{
    size_t few[FEW];
    for (size_t k = 0; k < FEW && rows.count; k++)
        few[k] = rows.list[k * rows.count / FEW];
    struct rows part = rows.count > FEW ? (struct rows){few, FEW, 0} : rows;
    double error = NAN;
    for (int round = 0; round < BLUR_ROUNDS && rows.count; round++) {
        if (blur_round(photo, zone, state, rims, part, &error))
            return -1;
        if (!isfinite(error) || (part.count == rows.count && fabs(error) < 0.002 * state->blur))
            break;
        if (fabs(error) < 0.01 * state->blur)
            part = rows;
    }
    return 0;
}

static double correlation_of(const struct refined *items, size_t count)
{
    double sums[LAGS] = {0}, counts[LAGS] = {0}, factor = 1;
    for (size_t k = 0; k < count; k++)
        for (int lag = 0; lag < LAGS; lag++) {
            sums[lag] += items[k].lag[lag];
            counts[lag] += items[k].lag_count[lag];
        }
    if (!(sums[0] > 0))
        return 1;
    for (int lag = 1; lag < LAGS && counts[lag] > 0; lag++) {
        double r = sums[lag] / counts[lag] / (sums[0] / counts[0]);
        if (r <= 0)
            break;
        factor += 2 * r;
    }
    return sqrt(factor);
}

double rims_correlation(const struct rims *rims)
{
    return correlation_of(rims->items, rims->count);
}

/* Standard error of a radius, over the sample, with these settings. */
static int trial(const struct photo *photo, const struct zone *zone, const struct rims_state *state,
                 const struct rims *rims, struct rows rows, double *error)
{
    struct refined fitted[RIMS_SAMPLE];
    struct edge_settings settings = settings_of(state);
    if (iterate(photo, zone, &settings, state->ellipse, 0, rims, rows, fitted))
        return -1;
    *error = median_member(fitted, rows.count, offsetof(struct refined, s_radius)) * correlation_of(fitted, rows.count);
    return 0;
}

/* Try one choice; the best so far is left in *best, its error in *least. Returns 1 when this one pays by `factor`. */
static int try_choice(const struct photo *photo, const struct zone *zone, const struct rims_state *try,
                      const struct rims *rims, struct rows rows, double factor, struct rims_state *best, double *least)
{
    double error;
    if (trial(photo, zone, try, rims, rows, &error))
        return -1;
    if (!(error < factor * *least))
        return 0;
    *least = error;
    *best = *try;
    return 1;
}

/* Texture and band are the photo's own: of a few choices, those with which its rims agree best with themselves. First
 * the texture in a middling band, then the band: narrower while that pays, wider when it does not. */
int rims_choose_window(const struct photo *photo, const struct zone *zone, struct rims_state *state,
                       const struct rims *rims, struct rows rows)
{
    static const double textures[] = {0, 1, 2, 3, 4.5, 7}, windows[] = {3.5, 2.5, 1.7}, widest = 5;
    struct rims_state try = *state, best = *state;
    double least = INFINITY;
    int paid = 1;
    if (rows.count == 0)
        return 0;
    try.window = windows[0] * state->blur;
    for (size_t k = 0; k < sizeof textures / sizeof *textures; k++) {
        try.texture = textures[k];
        if (try_choice(photo, zone, &try, rims, rows, CLEARLY, &best, &least) < 0)
            return -1;
    }
    try.texture = best.texture;
    for (size_t k = 1; k < sizeof windows / sizeof *windows && paid > 0; k++) {
        try.window = windows[k] * state->blur;
        paid = try_choice(photo, zone, &try, rims, rows, 1, &best, &least);
    }
    try.window = widest * state->blur;
    if (paid >= 0 && best.window >= windows[0] * state->blur)
        paid = try_choice(photo, zone, &try, rims, rows, 1, &best, &least);
    *state = best;
    return paid < 0 ? -1 : 0;
}
