/* Trends of one displacement u over the cycles t, fitted from the first training cycle t0 on; u(t0) is taken as exact
 * in the first two (equations in brackets: Karrech and others). TREND_LOG has a constant of its own, so that the noise
 * of one end does not tilt it. Since only differences of u are used, any origin serves. */
#include "calibration/settlement/settlement.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "pipeline/speak/error.h"

const char *const TREND_KINDS[] = {"linear", "logarithmic", "log", NULL};

/* Normal equations of a ln(t / t0) + b (t - t0) [20, 21]. */
static void fit_logarithmic(const double *t, const double *u, size_t k, struct trend *trend)
{
    double ll = 0, ls = 0, ss = 0, ul = 0, us = 0;
    for (size_t p = 1; p <= k; p++) {
        double l = log(t[p] / t[0]), since = t[p] - t[0], rise = u[p] - u[0];
        ll += l * l, ls += l * since, ss += since * since;
        ul += rise * l, us += rise * since;
    }
    double determinant = ll * ss - ls * ls;
    trend->a = (ss * ul - ls * us) / determinant;
    trend->b = (ll * us - ls * ul) / determinant;
}

/* Line over ln t with a free constant, all k + 1 ends alike; `offset` is what it leaves at the first. */
static void fit_log(const double *t, const double *u, size_t k, struct trend *trend, double *offset)
{
    double n = (double)k + 1, l = 0, v = 0, ll = 0, lv = 0;
    for (size_t p = 0; p <= k; p++)
        l += log(t[p] / t[0]) / n, v += (u[p] - u[0]) / n;
    for (size_t p = 0; p <= k; p++) {
        double away = log(t[p] / t[0]) - l;
        ll += away * away, lv += away * (u[p] - u[0] - v);
    }
    trend->a = lv / ll;
    *offset = v - trend->a * l;
}

static double trend_since_start(const struct trend *trend, double t)
{
    return trend->b * (t - trend->t0) + trend->a * log(t / trend->t0);
}

/* What the trend leaves over at the ends. */
static void judge(const double *t, const double *u, size_t k, double offset, struct trend *trend)
{
    double squares = 0;
    for (size_t p = 1; p <= k; p++) {
        double rest = u[p] - u[0] - offset - trend_since_start(trend, t[p]);
        squares += rest * rest;
        trend->low = fmin(trend->low, rest);
        trend->high = fmax(trend->high, rest);
    }
    trend->rms = sqrt(squares / (double)k);
}

int trend_fit(enum trend_kind kind, const double *t, const double *u, size_t k, struct trend *trend)
{
    size_t least = kind == TREND_LOGARITHMIC ? 2 : 1;
    double offset = 0;
    if (k < least)
        return error_input("%zu training cycle%s: a %s trend needs %zu or more", k, k == 1 ? "" : "s",
                           TREND_KINDS[kind], least);
    if (!(t[0] >= 1))
        return error_input("the first training cycle is number %g: count from 1", t[0]);
    *trend = (struct trend){.kind = kind, .t0 = t[0], .now = t[k]};
    if (kind == TREND_LINEAR)
        trend->b = (u[k] - u[0]) / (t[k] - t[0]);
    else if (kind == TREND_LOGARITHMIC)
        fit_logarithmic(t, u, k, trend);
    else
        fit_log(t, u, k, trend, &offset);
    judge(t, u, k, offset, trend);
    return 0;
}

double trend_ahead(const struct trend *trend, double h)
{
    return trend->b * h + trend->a * log1p(h / trend->now);
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
    free(ends->cycle);
    memset(ends, 0, sizeof *ends);
}

static int make_room(struct cycle_ends *ends, size_t values)
{
    if (ends->cycles < ends->capacity)
        return 0;
    size_t capacity = ends->capacity ? 2 * ends->capacity : 32;
    double *at = realloc(ends->at, capacity * (values + 1) * sizeof *at);
    if (at)
        ends->at = at;
    double *cycle = realloc(ends->cycle, capacity * sizeof *cycle);
    if (cycle)
        ends->cycle = cycle;
    if (!at || !cycle)
        return error_memory("ends of cycles");
    ends->capacity = capacity;
    return 0;
}

int cycle_ends_add(struct cycle_ends *ends, double cycle, const double *positions, size_t values)
{
    if (ends->cycles && ends->values != values)
        return error_input("%zu grains after %zu: give states of one series", values / 2, ends->values / 2);
    if (make_room(ends, values))
        return -1;
    ends->values = values;
    ends->cycle[ends->cycles] = cycle;
    memcpy(ends->at + ends->cycles++ * values, positions, values * sizeof *positions);
    return 0;
}

int cycle_ends_ahead(const struct cycle_ends *ends, enum trend_kind kind, double h, double *ahead, struct trend *trends)
{
    size_t k = ends->cycles ? ends->cycles - 1 : 0;
    double *u = malloc((ends->cycles + 1) * sizeof *u);
    int status = u ? 0 : error_memory("trends");
    for (size_t v = 0; v < ends->values && !status; v++) {
        struct trend trend;
        for (size_t p = 0; p <= k; p++)
            u[p] = ends->at[p * ends->values + v];
        status = trend_fit(kind, ends->cycle, u, k, &trend);
        if (!status)
            ahead[v] = u[k] + trend_ahead(&trend, h);
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
