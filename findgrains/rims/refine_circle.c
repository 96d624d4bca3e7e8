/* Tukey's biweight (Beaton and Tukey, Technometrics 16 (1974) 147) by iterated weighted least squares; standard errors
 * of M-estimators (Huber, Robust Statistics (1981), section 7.6). Sectors differ in their formal variance (short
 * contrast, few pixels) and share an additional variance tau^2 from specks, rings and roughness.
 *
 * The shifts y_k of sectors at theta_k are fitted by dR + dx cos + dy sin (+ dc cos 2 + ds sin 2), with weights trust_k
 * w(r_k / sigma_k) / sigma_k^2, sigma_k^2 = formal_k + tau^2, w(t) = (1 - (t / c)^2)^2 inside c and 0 outside, after a
 * first round without w. tau^2 is what the median of |r| says beyond the formal variances. The covariance is the
 * sandwich D^-1 M D^-1 with D = sum of psi' x x', M = sum of psi^2 x x', and n / (n - p) for the parameters. */
#include "findgrains/rims/refine_circle.h"

#include "pipeline/numbers/dense.h"
#include "pipeline/numbers/quantiles.h"
#include "pipeline/speak/error.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { TERMS = 5, ROUNDS = 6, LAGS = 8 };
#define MAD_TO_SD 1.4826
/* Edges at random places in the band scatter by 0.74 of its half width (MAD of a uniform distribution): no rim. */
#define CHANCE 0.5
#define MOST_TRUST 1.5
#define SINGULAR 1e-9

struct fit {
    struct sector *sectors; /* all of them, used or not */
    int count, used, terms;
    double *variance; /* formal, per sector */
    double *trust;    /* step over the grain's median step: see set_variances() */
    double *row;      /* TERMS per sector */
    double *residual, *scratch;
    double tau2, tukey;
    double parameters[TERMS], covariance[TERMS][TERMS];
};

static int fit_alloc(struct fit *fit, const struct edge_work *work, double tukey, int ellipse)
{
    size_t n = (size_t)work->count;
    *fit = (struct fit){.sectors = work->sectors, .count = work->count, .tukey = tukey, .terms = ellipse ? 5 : 3};
    fit->variance = malloc(n * (TERMS + 4) * sizeof *fit->variance);
    if (!fit->variance)
        return error_memory("rim fit");
    fit->row = fit->variance + n;
    fit->residual = fit->row + n * TERMS;
    fit->scratch = fit->residual + n;
    fit->trust = fit->scratch + n;
    for (int k = 0; k < fit->count; k++) {
        double *row = fit->row + (size_t)k * TERMS, theta = fit->sectors[k].theta;
        row[0] = 1;
        row[1] = cos(theta);
        row[2] = sin(theta);
        row[3] = cos(2 * theta);
        row[4] = sin(2 * theta);
        fit->used += fit->sectors[k].used;
    }
    return 0;
}

/* Median over the sectors in use of a number that stands `apart` bytes behind that of the sector before. */
static double median_of_used(struct fit *fit, const double *first, size_t apart)
{
    size_t n = 0;
    for (int k = 0; k < fit->count; k++)
        if (fit->sectors[k].used)
            fit->scratch[n++] = *(const double *)(const void *)((const char *)first + (size_t)k * apart);
    return median_of(fit->scratch, n);
}

/* Formal variances: the grain's own median noise, more where a sector's residual is larger than that, and the grain's
 * median step. A shift is a quotient a / step whose parts err together (a dark speck lowers the step and seems to move
 * the rim); weights in proportion to the step make of the mean of quotients a quotient of sums, which does not lean. */
static double set_variances(struct fit *fit)
{
    double noise2 = fmax(median_of_used(fit, &fit->sectors->residual, sizeof *fit->sectors), 1e-12);
    double step = median_of_used(fit, &fit->sectors->step, sizeof *fit->sectors);
    for (int k = 0; k < fit->count; k++) {
        const struct sector *sector = &fit->sectors[k];
        double share = sector->used ? sector->step / step : 1;
        fit->variance[k] = sector->variance * share * share * fmax(noise2, sector->residual);
        fit->trust[k] = fmin(share, MOST_TRUST);
    }
    return sqrt(noise2);
}

static double tukey_weight(double t, double tukey)
{
    double q = t / tukey;
    return fabs(q) < 1 ? (1 - q * q) * (1 - q * q) : 0;
}

static double tukey_slope(double t, double tukey)
{
    double q = t / tukey, q2 = q * q;
    return q2 < 1 ? (1 - q2) * (1 - 5 * q2) : 0;
}

static int weighted_step(struct fit *fit, int robust)
{
    double inverse[TERMS][TERMS] = {{0}}, right[TERMS] = {0};
    for (int k = 0; k < fit->count; k++) {
        if (!fit->sectors[k].used)
            continue;
        double total = fit->variance[k] + fit->tau2, weight = fit->trust[k] / total;
        if (robust)
            weight *= tukey_weight(fit->residual[k] / sqrt(total), fit->tukey);
        const double *row = fit->row + (size_t)k * TERMS;
        for (int i = 0; i < fit->terms; i++) {
            right[i] += weight * row[i] * fit->sectors[k].shift;
            for (int j = 0; j < fit->terms; j++)
                inverse[i][j] += weight * row[i] * row[j];
        }
    }
    if (dense_invert(&inverse[0][0], (size_t)fit->terms, TERMS, SINGULAR))
        return 0;
    for (int i = 0; i < fit->terms; i++) {
        fit->parameters[i] = 0;
        for (int j = 0; j < fit->terms; j++)
            fit->parameters[i] += inverse[i][j] * right[j];
    }
    return 1;
}

static void set_residuals(struct fit *fit)
{
    for (int k = 0; k < fit->count; k++) {
        double model = 0;
        for (int i = 0; i < fit->terms; i++)
            model += fit->parameters[i] * fit->row[(size_t)k * TERMS + (size_t)i];
        fit->residual[k] = fit->sectors[k].shift - model;
    }
}

/* Robust standard deviation of the residuals; sets the shared variance tau^2. */
static double set_scatter(struct fit *fit, double formal2)
{
    size_t n = 0;
    for (int k = 0; k < fit->count; k++)
        if (fit->sectors[k].used)
            fit->scratch[n++] = fabs(fit->residual[k]);
    double scatter = MAD_TO_SD * median_of(fit->scratch, n);
    /* The floor keeps a few sectors with a small formal variance from ruling the fit. */
    fit->tau2 = fmax(0.25 * scatter * scatter, scatter * scatter - formal2);
    return scatter;
}

/* D^-1 (sum b^2 psi^2 x x') D^-1 n / (n - p), D = sum b psi' x x'. */
static int set_covariance(struct fit *fit)
{
    double inverse[TERMS][TERMS] = {{0}}, meat[TERMS][TERMS] = {{0}};
    for (int k = 0; k < fit->count; k++) {
        if (!fit->sectors[k].used)
            continue;
        double total = fit->variance[k] + fit->tau2, t = fit->residual[k] / sqrt(total);
        double psi = t * tukey_weight(t, fit->tukey), trust = fit->trust[k];
        double d = trust * tukey_slope(t, fit->tukey) / total, e = trust * trust * psi * psi / total;
        const double *row = fit->row + (size_t)k * TERMS;
        for (int i = 0; i < fit->terms; i++)
            for (int j = 0; j < fit->terms; j++) {
                inverse[i][j] += d * row[i] * row[j];
                meat[i][j] += e * row[i] * row[j];
            }
    }
    if (dense_invert(&inverse[0][0], (size_t)fit->terms, TERMS, SINGULAR))
        return 0;
    double spare = (double)fit->used / (fit->used - fit->terms);
    for (int i = 0; i < fit->terms; i++)
        for (int j = 0; j < fit->terms; j++) {
            double sum = 0;
            for (int k = 0; k < fit->terms; k++)
                for (int l = 0; l < fit->terms; l++)
                    sum += inverse[i][k] * meat[k][l] * inverse[l][j];
            fit->covariance[i][j] = spare * sum;
        }
    return 1;
}

/* Products of the standardised influences of sectors 0 to LAGS - 1 apart. */
static void add_lags(const struct fit *fit, struct refined *refined)
{
    for (int k = 0; k < fit->count; k++)
        for (int lag = 0; lag < LAGS; lag++) {
            int other = (k + lag) % fit->count;
            if (!fit->sectors[k].used || !fit->sectors[other].used)
                continue;
            double a = fit->residual[k] / sqrt(fit->variance[k] + fit->tau2);
            double b = fit->residual[other] / sqrt(fit->variance[other] + fit->tau2);
            refined->lag[lag] += a * tukey_weight(a, fit->tukey) * b * tukey_weight(b, fit->tukey);
            refined->lag_count[lag] += 1;
        }
}

static void describe(struct fit *fit, struct refined *refined)
{
    int near = 0, hidden = 0;
    for (int k = 0; k < fit->count; k++) {
        const struct sector *sector = &fit->sectors[k];
        hidden += sector->hidden;
        if (sector->used)
            near += tukey_weight(fit->residual[k] / sqrt(fit->variance[k] + fit->tau2), fit->tukey) > 0;
    }
    refined->blur_error = median_of_used(fit, &fit->sectors->blur_error, sizeof *fit->sectors);
    refined->support = (double)near / fit->count;
    refined->hidden = (double)hidden / fit->count;
    refined->s_radius = sqrt(fit->covariance[0][0]);
    refined->s_x = sqrt(fit->covariance[1][1]);
    refined->s_y = sqrt(fit->covariance[2][2]);
    refined->s_shape = fit->terms > 3 ? sqrt(0.5 * (fit->covariance[3][3] + fit->covariance[4][4])) : NAN;
    refined->sectors = fit->used;
    add_lags(fit, refined);
}

static void move(const struct fit *fit, double damping, struct refined *refined)
{
    double p[TERMS];
    for (int k = 0; k < fit->terms; k++)
        p[k] = damping * fit->parameters[k];
    refined->rim.radius += p[0];
    refined->rim.x += p[1];
    refined->rim.y += p[2];
    refined->moved = fmax(fabs(p[0]), hypot(p[1], p[2]));
    if (fit->terms > 3) {
        refined->rim.c2 += p[3];
        refined->rim.s2 += p[4];
    }
}

static int fit_curve(struct fit *fit, struct refined *refined)
{
    refined->noise = set_variances(fit);
    double formal2 = median_of_used(fit, fit->variance, sizeof *fit->variance);
    refined->formal = sqrt(formal2);
    if (!weighted_step(fit, 0))
        return 0;
    for (int round = 0; round < ROUNDS; round++) {
        set_residuals(fit);
        refined->scatter = set_scatter(fit, formal2);
        if (!weighted_step(fit, 1))
            return 0;
    }
    set_residuals(fit);
    return set_covariance(fit);
}

int refine_circle(const struct photo *photo, const struct zone *zone, const struct rim *others, size_t other_count,
                  const struct edge_settings *settings, int ellipse, struct edge_work *work, struct refined *refined)
{
    struct rim rim = refined->rim;
    *refined = (struct refined){.rim = rim, .s_x = NAN, .s_y = NAN, .s_radius = NAN, .s_shape = NAN};
    struct fit fit;
    if (!rim_is_possible(photo, &rim))
        return 0;
    if (edge_fit(photo, zone, &rim, others, other_count, settings, work) ||
        fit_alloc(&fit, work, settings->tukey, ellipse))
        return -1;
    if (fit.terms > 3 && fit.used < 2 * fit.terms)
        fit.terms = 3;
    if (fit.used > fit.terms + 1 && fit_curve(&fit, refined) && refined->scatter < CHANCE * settings->window) {
        describe(&fit, refined);
        if (!settings->fit_blur)
            move(&fit, settings->damping, refined);
    }
    free(fit.variance);
    return 0;
}
