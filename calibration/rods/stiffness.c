/* Forces are scaled by the largest one of their branch, so that the systems are of one size; stiffnesses and errors are
 * scaled back. Weights are 1 / variance of the deflection; the error of the force enters through the slope of a first
 * fit, s_x^2 + (s_F dx/dF)^2. Two parameters that enter nonlinearly, the break B and the exponent n, are sought; their
 * errors come from the problem linearised there, with the derivative of the model as one more column. */
#include "calibration/rods/stiffness.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "calibration/rods/fit.h"
#include "pipeline/speak/error.h"
#include "pipeline/numbers/golden.h"
#include "pipeline/numbers/quantiles.h"

const char *const PRESS_KINDS[] = {"loading", "unloading", "reloading"};

/* The points of one phase, scaled: forces over the largest one. */
struct branch {
    size_t count;
    double *force, *x, *w, *rows;
    double scale;   /* N */
    int known;      /* the points say how good they are */
    double x0, c;   /* of the last power fit */
    double chi2[3]; /* line, bilinear, power */
};

void stiffness_free(struct stiffness *stiffness)
{
    free(stiffness->phase);
    memset(stiffness, 0, sizeof *stiffness);
}

/* ---- the fits ---- */

/* Each fills in its rows and solves: chi2, infinite where the columns depend on each other. */
static double solve(struct branch *branch, int unknowns, double a[FIT_MOST], double cov[FIT_MOST][FIT_MOST])
{
    double chi2 = INFINITY;
    return fit_linear(branch->rows, branch->x, branch->w, branch->count, unknowns, a, cov, &chi2) ? INFINITY : chi2;
}

static double line_chi2(struct branch *branch, double a[FIT_MOST], double cov[FIT_MOST][FIT_MOST])
{
    for (size_t k = 0; k < branch->count; k++) {
        branch->rows[2 * k] = 1;
        branch->rows[2 * k + 1] = branch->force[k];
    }
    return solve(branch, 2, a, cov);
}

static double bilinear_chi2(struct branch *branch, double at, double a[FIT_MOST], double cov[FIT_MOST][FIT_MOST])
{
    for (size_t k = 0; k < branch->count; k++) {
        branch->rows[3 * k] = 1;
        branch->rows[3 * k + 1] = fmin(branch->force[k], at);
        branch->rows[3 * k + 2] = fmax(branch->force[k] - at, 0);
    }
    return solve(branch, 3, a, cov);
}

/* x = x0 + (F / c)^m, m = 1/n. */
static double power_chi2(struct branch *branch, double m, double a[FIT_MOST], double cov[FIT_MOST][FIT_MOST])
{
    for (size_t k = 0; k < branch->count; k++) {
        branch->rows[2 * k] = 1;
        branch->rows[2 * k + 1] = pow(fmax(branch->force[k], 0), m);
    }
    return solve(branch, 2, a, cov);
}

static double bilinear_at(double at, void *user)
{
    double a[FIT_MOST], cov[FIT_MOST][FIT_MOST];
    return bilinear_chi2(user, at, a, cov);
}

static double power_at(double m, void *user)
{
    double a[FIT_MOST], cov[FIT_MOST][FIT_MOST];
    return power_chi2(user, m, a, cov);
}

/* Least of f on [low, high]: the best of a grid, refined by golden sections. */
static double search(double (*f)(double, void *), void *user, double low, double high)
{
    enum { GRID = 100 };
    double best = low, least = INFINITY, step = (high - low) / GRID;
    for (int g = 0; g <= GRID; g++) {
        double value = f(low + g * step, user);
        if (value < least)
            least = value, best = low + g * step;
    }
    return golden_section(f, user, fmax(low, best - step), fmin(high, best + step), 1e-9 * (high - low));
}

/* Factor on the standard errors: 1 where the points are as good as they say. */
static double excess(const struct branch *branch, double chi2, int unknowns)
{
    double freedom = (double)branch->count - unknowns;
    double ratio = freedom > 0 ? sqrt(chi2 / freedom) : 1;
    return branch->known ? fmax(1, ratio) : ratio;
}

/* Slope 1/k per scaled force -> k in N/m and its error. */
static void stiffness_of(const struct branch *branch, double slope, double variance, double factor, double *k,
                         double *s)
{
    *k = branch->scale / slope;
    *s = factor * sqrt(variance) * branch->scale / (slope * slope);
}

static double rms(const struct branch *branch, double chi2)
{
    double weight = 0;
    for (size_t k = 0; k < branch->count; k++)
        weight += branch->w[k];
    return sqrt(chi2 / weight);
}

/* Two lines; the covariance of (x0, 1/k_low, 1/k_high, B) from the problem linearised at the best B. */
static void fit_bilinear(struct branch *branch, struct press_fit *fit)
{
    enum { MARGIN = 2 }; /* points that must lie beyond the break on either side */
    double a[FIT_MOST], cov[FIT_MOST][FIT_MOST], *sorted = branch->rows;
    memcpy(sorted, branch->force, branch->count * sizeof *sorted);
    sort_values(sorted, branch->count);
    double low = sorted[MARGIN], high = sorted[branch->count - 1 - MARGIN];
    if (branch->count < 2 * MARGIN + 3 || !(high > low))
        return;
    double at = search(bilinear_at, branch, low, high);
    double chi2 = branch->chi2[1] = bilinear_chi2(branch, at, a, cov);
    double gain = branch->chi2[0] - chi2, factor = excess(branch, chi2, 4);
    fit->rms_bilinear = rms(branch, chi2);
    if (!isfinite(chi2) || !(gain > PRESS_BREAK * factor * factor))
        return;
    for (size_t k = 0; k < branch->count; k++) {
        double force = branch->force[k], *row = branch->rows + 4 * k;
        row[0] = 1, row[1] = fmin(force, at), row[2] = fmax(force - at, 0);
        row[3] = force > at ? a[1] - a[2] : 0;
    }
    double b[FIT_MOST];
    if (fit_linear(branch->rows, branch->x, branch->w, branch->count, 4, b, cov, NULL))
        return;
    stiffness_of(branch, a[1], cov[1][1], factor, &fit->k_low, &fit->s_low);
    stiffness_of(branch, a[2], cov[2][2], factor, &fit->k_high, &fit->s_high);
    fit->break_force = at * branch->scale;
    fit->s_break = factor * sqrt(cov[3][3]) * branch->scale;
}

static void fit_power(struct branch *branch, struct press_fit *fit)
{
    double a[FIT_MOST], cov[FIT_MOST][FIT_MOST], b[FIT_MOST];
    double m = search(power_at, branch, 0.2, 2), chi2 = branch->chi2[2] = power_chi2(branch, m, a, cov);
    if (!isfinite(chi2) || !(a[1] > 0))
        return;
    for (size_t k = 0; k < branch->count; k++) {
        double force = fmax(branch->force[k], 0), *row = branch->rows + 3 * k;
        row[0] = 1, row[1] = pow(force, m), row[2] = force > 0 ? a[1] * row[1] * log(force) : 0;
    }
    fit->rms_power = rms(branch, chi2);
    fit->power_n = 1 / m;
    fit->power_c = branch->scale / pow(a[1], 1 / m);
    if (!fit_linear(branch->rows, branch->x, branch->w, branch->count, 3, b, cov, NULL))
        fit->s_n = excess(branch, chi2, 3) * sqrt(cov[2][2]) / (m * m);
}

/* The weights of the points, given the slope at which the force's error becomes one of the deflection. */
static void weigh(struct branch *branch, const struct press_point *points, const struct press_fit *fit,
                  const struct press_options *options, double slope)
{
    size_t n = 0;
    branch->known = 1;
    for (size_t k = fit->begin; k < fit->end; k++)
        if (points[k].used)
            branch->known &= points[k].s > 0;
    for (size_t k = fit->begin; k < fit->end; k++)
        if (points[k].used) {
            double from_force = options->force_error * slope / branch->scale;
            double variance = branch->known ? points[k].s * points[k].s + from_force * from_force : 1;
            branch->w[n++] = 1 / variance;
        }
}

static int fit_branch(const struct press_point *points, const struct press_options *options, struct branch *branch,
                      struct press_fit *fit)
{
    double a[FIT_MOST] = {0}, cov[FIT_MOST][FIT_MOST];
    fit->k_low = fit->s_low = fit->break_force = fit->s_break = NAN;
    fit->power_n = fit->s_n = fit->power_c = fit->rms_power = fit->rms_bilinear = NAN;
    for (int pass = 0; pass < 2; pass++) {
        weigh(branch, points, fit, options, pass ? a[1] : 0);
        branch->chi2[0] = line_chi2(branch, a, cov);
        if (!isfinite(branch->chi2[0]))
            return error_input("photos %lld to %lld: the force does not change: no slope to fit",
                               (long long)points[fit->begin].index, (long long)points[fit->end - 1].index);
    }
    stiffness_of(branch, a[1], cov[1][1], excess(branch, branch->chi2[0], 2), &fit->k_line, &fit->s_line);
    fit->rms_line = rms(branch, branch->chi2[0]);
    if (!(fit->k_line > 0))
        return error_input(
            "photos %lld to %lld: stiffness %.3g N/m: the rods part while the force grows: check the sign "
            "of the force and which rods are meant (--rods)",
            (long long)points[fit->begin].index, (long long)points[fit->end - 1].index, fit->k_line);
    fit->k_high = fit->k_line, fit->s_high = fit->s_line;
    fit_bilinear(branch, fit);
    fit_power(branch, fit);
    if (!(fit->k_high > 0) || fit->k_low <= 0)
        return error_input(
            "photos %lld to %lld: a negative stiffness beyond the break at %.3g N: check the photos there",
            (long long)points[fit->begin].index, (long long)points[fit->end - 1].index, fit->break_force);
    return 0;
}

/* ---- the phases ---- */

/* Turning points of the force: a new phase begins at an extreme from which the force has come back by `back`. */
static size_t find_phases(const struct press_point *points, size_t count, double back, struct press_fit *phase)
{
    size_t phases = 0, begin = 0, extreme = 0;
    int up = 0, loaded = 0; /* direction: 0 not known yet */
    for (size_t k = 0; k <= count; k++) {
        if (k < count && !points[k].used)
            continue;
        double far = k < count ? points[k].force - points[extreme].force : 0;
        if (k < count && !points[extreme].used)
            extreme = k, far = 0;
        if (k < count && (up ? far * up >= 0 : 0)) {
            extreme = k;
        } else if (k < count && !up && fabs(far) > back) {
            up = far > 0 ? 1 : -1;
            extreme = k;
        } else if (k == count || fabs(far) > back) {
            size_t end = k == count ? count : extreme + 1;
            phase[phases] = (struct press_fit){.begin = begin, .end = end};
            phase[phases++].kind = up < 0 ? PRESS_UNLOADING : loaded ? PRESS_RELOADING : PRESS_LOADING;
            loaded |= up > 0;
            begin = extreme; /* the turning point belongs to both */
            up = -up;
            extreme = k;
            if (phases == PRESS_MOST_PHASES)
                break;
        }
    }
    return phases;
}

static int branch_fill(const struct press_point *points, struct branch *branch, struct press_fit *fit)
{
    branch->count = 0;
    branch->scale = 0;
    fit->force[0] = INFINITY, fit->force[1] = -INFINITY;
    for (size_t k = fit->begin; k < fit->end; k++)
        if (points[k].used) {
            branch->force[branch->count] = points[k].force;
            branch->x[branch->count++] = points[k].deflection;
            fit->force[0] = fmin(fit->force[0], points[k].force);
            fit->force[1] = fmax(fit->force[1], points[k].force);
        }
    fit->points = branch->count;
    branch->scale = fmax(fabs(fit->force[0]), fabs(fit->force[1]));
    for (size_t k = 0; k < branch->count; k++)
        branch->force[k] /= branch->scale;
    return branch->count >= PRESS_LEAST;
}

/* k_n of the thesis: mean slope of the loading curves above the break. */
static void summarise(struct stiffness *stiffness)
{
    double sum = 0, variance = 0, low = INFINITY, high = -INFINITY, back = 0, back_variance = 0;
    size_t n = 0, unloadings = 0;
    for (size_t p = 0; p < stiffness->phase_count; p++) {
        const struct press_fit *fit = &stiffness->phase[p];
        if (fit->kind == PRESS_UNLOADING) {
            back += fit->k_line, back_variance += fit->s_line * fit->s_line;
            unloadings++;
            continue;
        }
        sum += fit->k_high, variance += fit->s_high * fit->s_high;
        low = fmin(low, fit->k_high), high = fmax(high, fit->k_high);
        n++;
    }
    stiffness->kn = sum / (double)n;
    stiffness->s_kn = sqrt(variance) / (double)n;
    stiffness->spread = 0.5 * (high - low);
    stiffness->unloading = unloadings ? back / (double)unloadings : NAN;
    stiffness->s_unloading = unloadings ? sqrt(back_variance) / (double)unloadings : NAN;
}

static int fit_phases(const struct press_point *points, const struct press_options *options, size_t found,
                      struct branch *branch, struct stiffness *stiffness)
{
    int loadings = 0;
    for (size_t p = 0; p < found; p++) {
        struct press_fit fit = stiffness->phase[p];
        if (!branch_fill(points, branch, &fit))
            continue;
        if (fit_branch(points, options, branch, &fit))
            return -1;
        loadings += fit.kind != PRESS_UNLOADING;
        stiffness->phase[stiffness->phase_count++] = fit;
    }
    if (!loadings)
        return error_input("no loading branch of %d photos or more: photograph more steps", PRESS_LEAST);
    summarise(stiffness);
    return 0;
}

int stiffness_fit(const struct press_point *points, size_t count, const struct press_options *options,
                  struct stiffness *stiffness)
{
    size_t used = 0;
    double largest = 0;
    for (size_t k = 0; k < count; k++)
        if (points[k].used) {
            used++;
            largest = fmax(largest, fabs(points[k].force));
        }
    memset(stiffness, 0, sizeof *stiffness);
    if (used < PRESS_LEAST)
        return error_input("%zu usable photo%s with a force: give at least %d", used, used == 1 ? "" : "s",
                           PRESS_LEAST);
    double *block = malloc((count * 7 + 1) * sizeof *block);
    stiffness->phase = calloc(PRESS_MOST_PHASES, sizeof *stiffness->phase);
    int status = block && stiffness->phase ? 0 : error_memory("force-deflection curve");
    if (!status) {
        struct branch branch = {.force = block, .x = block + count, .w = block + 2 * count, .rows = block + 3 * count};
        size_t found = find_phases(points, count, options->turn * largest, stiffness->phase);
        status = fit_phases(points, options, found, &branch, stiffness);
    }
    free(block);
    if (status)
        stiffness_free(stiffness);
    return status;
}
