#include "calibration/settlement.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "pipeline/error.h"

const char *const TREND_KINDS[] = {"linear", "logarithmic", NULL};

/* Normal equations of a ln(t / t0) + b (t - t0) [20, 21]. */
static void fit_logarithmic(double t0, const double *u, size_t k, struct trend *trend)
{
    double ll = 0, lt = 0, tt = 0, ul = 0, ut = 0;
    for (size_t p = 1; p <= k; p++) {
        double l = log((t0 + (double)p) / t0), t = (double)p, rise = u[p] - u[0];
        ll += l * l, lt += l * t, tt += t * t;
        ul += rise * l, ut += rise * t;
    }
    double determinant = ll * tt - lt * lt;
    trend->a = (tt * ul - lt * ut) / determinant;
    trend->b = (ll * ut - lt * ul) / determinant;
}

static double trend_since_start(const struct trend *trend, double p)
{
    double rise = trend->b * p;
    return trend->kind == TREND_LOGARITHMIC ? rise + trend->a * log((trend->t0 + p) / trend->t0) : rise;
}

int trend_fit(enum trend_kind kind, double t0, const double *u, size_t k, struct trend *trend)
{
    size_t least = kind == TREND_LINEAR ? 1 : 2;
    *trend = (struct trend){.kind = kind, .t0 = t0};
    if (k < least)
        return error_input("%zu training cycle%s: a %s trend needs %zu or more", k, k == 1 ? "" : "s",
                           TREND_KINDS[kind], least);
    if (!(t0 >= 1))
        return error_input("the first training cycle is number %g: count from 1", t0);
    if (kind == TREND_LINEAR)
        trend->b = (u[k] - u[0]) / (double)k;
    else
        fit_logarithmic(t0, u, k, trend);
    double squares = 0;
    for (size_t p = 1; p <= k; p++) {
        double rest = u[p] - u[0] - trend_since_start(trend, (double)p);
        squares += rest * rest;
        trend->low = fmin(trend->low, rest);
        trend->high = fmax(trend->high, rest);
    }
    trend->rms = sqrt(squares / (double)k);
    return 0;
}

double trend_ahead(const struct trend *trend, size_t k, double h)
{
    return trend_since_start(trend, (double)k + h) - trend_since_start(trend, (double)k);
}

int chernoff_cycles(double low, double high, double error, double p, double *cycles)
{
    if (!(error > 0) || !(p > 0 && p < 1) || !(high >= low))
        return error_input(
            "an error of %g with probability %g: give a positive error and a probability between 0 and 1", error, p);
    *cycles = ceil((high - low) * (high - low) / (2 * error * error) * log(2 / p));
    return 0;
}

void cycle_ends_free(struct cycle_ends *ends)
{
    free(ends->at);
    memset(ends, 0, sizeof *ends);
}

int cycle_ends_add(struct cycle_ends *ends, const double *positions, size_t values)
{
    if (ends->cycles && ends->values != values)
        return error_input("%zu grains after %zu: give states of one series", values / 2, ends->values / 2);
    if (ends->cycles == ends->capacity) {
        size_t capacity = ends->capacity ? 2 * ends->capacity : 32;
        double *at = realloc(ends->at, capacity * (values + 1) * sizeof *at);
        if (!at)
            return error_memory("ends of cycles");
        ends->at = at;
        ends->capacity = capacity;
    }
    ends->values = values;
    memcpy(ends->at + ends->cycles++ * values, positions, values * sizeof *positions);
    return 0;
}

int cycle_ends_ahead(const struct cycle_ends *ends, enum trend_kind kind, double t0, double h, double *ahead,
                     struct trend *trends)
{
    size_t k = ends->cycles ? ends->cycles - 1 : 0;
    double *u = malloc((ends->cycles + 1) * sizeof *u);
    int status = u ? 0 : error_memory("trends");
    for (size_t v = 0; v < ends->values && !status; v++) {
        struct trend trend;
        for (size_t p = 0; p <= k; p++)
            u[p] = ends->at[p * ends->values + v];
        status = trend_fit(kind, t0, u, k, &trend);
        if (!status)
            ahead[v] = u[k] + trend_ahead(&trend, k, h);
        if (!status && trends)
            trends[v] = trend;
    }
    free(u);
    return status;
}

double relative_error(const double *u, const double *v, const double *origin, size_t values)
{
    double difference = 0, whole = 0;
    for (size_t k = 0; k < values; k++) {
        double from = origin ? origin[k] : 0;
        if (!isfinite(u[k] + v[k] + from))
            continue;
        difference += (u[k] - v[k]) * (u[k] - v[k]);
        whole += (u[k] - from) * (u[k] - from);
    }
    return sqrt(difference / whole);
}
