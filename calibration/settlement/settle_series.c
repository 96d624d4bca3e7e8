/* Residual: from the beginning of a cycle to its end. Reversible: within a cycle, off the straight line between its
 * ends, so that the drift is not counted. A grain that is missing at the end of a cycle is not used; missing in
 * between, it loses those photos only. */
#include "calibration/settlement/settle_series.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "pipeline/speak/error.h"
#include "pipeline/packing/grains.h"
#include "pipeline/numbers/quantiles.h"
#include "pipeline/state/state.h"

void settle_series_free(struct settle_series *series)
{
    free(series->at);
    memset(series, 0, sizeof *series);
}

/* Positions of one file's grains times (right, up), those that are not to be trusted as NaN. */
static int take(size_t count, const double *x, const double *y, const uint32_t *flags, double right, double up,
                double **at)
{
    *at = malloc((2 * count + 1) * sizeof **at);
    for (size_t k = 0; *at && k < count; k++) {
        int lost = flags && (flags[k] & GRAIN_DISTRUST);
        (*at)[2 * k] = lost ? NAN : right * x[k];
        (*at)[2 * k + 1] = lost ? NAN : up * y[k];
    }
    return *at ? 0 : error_memory("positions");
}

static int read_tracks(const struct state *state, const char *path, double scale, size_t *count, double **at)
{
    static const char *const needed[] = {"x_px", "y_px", NULL};
    struct photo_grains grains = {0};
    if (isnan(scale))
        return error_input("%s: a tracks file is in px: give the scene with --scene", path);
    if (state_read(state, "grains", &PHOTO_GRAINS, needed, &grains))
        return -1;
    *count = grains.count;
    /* y of a photo goes down */
    int status = take(grains.count, grains.x_px, grains.y_px, grains.flags, scale, -scale, at);
    table_free(&PHOTO_GRAINS, &grains);
    return status;
}

static int read_si(const struct state *state, size_t *count, double **at)
{
    static const char *const needed[] = {"x", "y", NULL};
    struct grains grains = {0};
    if (state_read(state, "grains", &GRAINS, needed, &grains))
        return -1;
    *count = grains.count;
    int status = take(grains.count, grains.x, grains.y, grains.flags, 1, 1, at);
    table_free(&GRAINS, &grains);
    return status;
}

static int read_positions(const char *path, double scale, size_t *count, double **at)
{
    struct state_info info = {0};
    struct state *state = state_open(path);
    int status = state ? state_read_info(state, &info) : -1;
    if (!status)
        status =
            !strcmp(info.stage, "tracker") ? read_tracks(state, path, scale, count, at) : read_si(state, count, at);
    state_info_free(&info);
    state_close(state);
    return status;
}

int settle_series_read(char *const *paths, size_t count, double scale, struct settle_series *series)
{
    memset(series, 0, sizeof *series);
    for (size_t s = 0; s < count; s++) {
        double *at = NULL;
        size_t grains = 0;
        int status = read_positions(paths[s], scale, &grains, &at);
        if (!status && !s) {
            series->grains = grains;
            series->at = malloc((count * 2 * grains + 1) * sizeof *series->at);
            status = series->at ? 0 : error_memory("positions");
        }
        if (!status && grains != series->grains)
            status = error_input("%s: %zu grains, %s has %zu: give states of one series", paths[s], grains, paths[0],
                                 series->grains);
        if (!status)
            memcpy(series->at + s * 2 * grains, at, 2 * grains * sizeof *at);
        free(at);
        if (status) {
            settle_series_free(series);
            return -1;
        }
        series->states++;
    }
    return 0;
}

void settle_estimate_free(struct settle_estimate *estimate)
{
    free(estimate->grain);
    memset(estimate, 0, sizeof *estimate);
}

static double at(const struct settle_series *series, size_t state, size_t value)
{
    return series->at[state * 2 * series->grains + value];
}

/* Largest way off the line between the ends of a cycle, mean over the cycles; photos that miss the grain are left out.
 */
static double reversible(const struct settle_series *series, const struct settle_wanted *wanted, size_t cycles,
                         size_t grain)
{
    double sum = 0;
    for (size_t c = 0; c < cycles; c++) {
        double most = 0;
        for (size_t p = 1; p < wanted->per_cycle; p++) {
            double share = (double)p / (double)wanted->per_cycle, way[2];
            for (int d = 0; d < 2; d++) {
                size_t v = 2 * grain + (size_t)d, s = c * wanted->per_cycle;
                double line = (1 - share) * at(series, s, v) + share * at(series, s + wanted->per_cycle, v);
                way[d] = at(series, s + p, v) - line;
            }
            if (isfinite(way[0]) && isfinite(way[1]))
                most = fmax(most, hypot(way[0], way[1]));
        }
        sum += most / (double)cycles;
    }
    return sum;
}

static int fit_grain(const struct settle_series *series, const struct settle_wanted *wanted, size_t cycles,
                     size_t grain, const double *t, double *u, struct grain_settlement *out)
{
    out->used = 1;
    for (int d = 0; d < 2; d++) {
        for (size_t c = 0; c <= cycles; c++) {
            u[c] = at(series, c * wanted->per_cycle, 2 * grain + (size_t)d);
            out->used &= isfinite(u[c]);
        }
        out->residual[d] = u[cycles] - u[0];
        if (trend_fit(wanted->trend, t, u, cycles, &out->trend[d]))
            return -1;
        out->ahead[d] = out->residual[d] + trend_ahead(&out->trend[d], wanted->ahead);
    }
    out->reversible = reversible(series, wanted, cycles, grain);
    return 0;
}

/* What the error would have been: learn without the last h cycles, predict them. */
static double hold_out(const struct settle_series *series, const struct settle_wanted *wanted, size_t cycles,
                       const double *t, double *u)
{
    size_t h = (size_t)wanted->ahead;
    double difference = 0, whole = 0;
    if (wanted->ahead < 1 || cycles < h + 2)
        return NAN;
    for (size_t v = 0; v < 2 * series->grains; v++) {
        struct trend trend;
        size_t k = cycles - h;
        for (size_t c = 0; c <= k; c++)
            u[c] = at(series, c * wanted->per_cycle, v);
        double truth = at(series, cycles * wanted->per_cycle, v);
        if (trend_fit(wanted->trend, t, u, k, &trend))
            return NAN;
        double rest = truth - u[k] - trend_ahead(&trend, (double)h);
        if (isfinite(rest)) {
            difference += rest * rest;
            whole += (truth - u[0]) * (truth - u[0]);
        }
    }
    return sqrt(difference / whole);
}

static int bound(const struct settle_wanted *wanted, struct settle_estimate *estimate)
{
    size_t n = 0;
    double *cycles = malloc((2 * estimate->grains + 1) * sizeof *cycles);
    int status = cycles ? 0 : error_memory("bounds");
    for (size_t k = 0; k < estimate->grains && !status; k++)
        for (int d = 0; d < 2 && estimate->grain[k].used && !status; d++) {
            const struct trend *trend = &estimate->grain[k].trend[d];
            status = chernoff_cycles(trend->low, trend->high, wanted->error, wanted->p, &cycles[n++]);
        }
    if (!status && n) {
        sort_values(cycles, n);
        estimate->chernoff[0] = cycles[n / 2];
        estimate->chernoff[1] = cycles[n - 1];
    }
    free(cycles);
    return status;
}

int settle_estimate(const struct settle_series *series, const struct settle_wanted *wanted,
                    struct settle_estimate *estimate)
{
    memset(estimate, 0, sizeof *estimate);
    if (wanted->per_cycle < 1 || series->states < 2 * wanted->per_cycle + 1)
        return error_input("%zu photo%s, %zu per cycle: give the photos of two cycles or more, and the one at the end",
                           series->states, series->states == 1 ? "" : "s", wanted->per_cycle);
    estimate->grains = series->grains;
    estimate->cycles = (series->states - 1) / wanted->per_cycle;
    estimate->chernoff[0] = estimate->chernoff[1] = NAN;
    estimate->grain = calloc(series->grains + 1, sizeof *estimate->grain);
    double *t = malloc(2 * (estimate->cycles + 1) * sizeof *t), *u = t + estimate->cycles + 1;
    int status = estimate->grain && t ? 0 : error_memory("settlement");
    for (size_t c = 0; c <= estimate->cycles && !status; c++)
        t[c] = wanted->first + (double)c;
    for (size_t k = 0; k < series->grains && !status; k++) {
        status = fit_grain(series, wanted, estimate->cycles, k, t, u, &estimate->grain[k]);
        estimate->unused += !estimate->grain[k].used;
    }
    if (!status)
        estimate->held_out = hold_out(series, wanted, estimate->cycles, t, u);
    if (!status && !isnan(wanted->error))
        status = bound(wanted, estimate);
    free(t);
    if (status)
        settle_estimate_free(estimate);
    return status;
}
