/* Long-term settlement under cycles (Karrech and others 2007): displacements at the ends of cycles are split into what
 * remains and what comes back; the remaining part is extrapolated by a closed-form trend. Time t counts cycles. */
#ifndef CALIBRATION_SETTLEMENT_H
#define CALIBRATION_SETTLEMENT_H

#include <stddef.h>

enum trend_kind {
    TREND_LINEAR,      /* u(t) = u(t0) + b (t - t0); b the mean increment [16] */
    TREND_LOGARITHMIC, /* u(t) = u(t0) + a ln(t / t0) + b (t - t0), least squares [17 to 21] */
    TREND_LOG          /* u(t) = c + a ln t, least squares: one number that grows, so that noise is not carried far */
};
extern const char *const TREND_KINDS[]; /* "linear" "logarithmic" "log" NULL */

struct trend {
    enum trend_kind kind;
    double t0, now; /* first and last cycle learned from */
    double a, b;
    double rms;       /* of what the trend leaves over */
    double low, high; /* extremes of that: b - a of the Chernoff bound [15] */
};

/* u[0..k]: residual displacement (any origin) at the end of cycles t[0..k], rising, t[0] >= 1. Error (EXIT_INPUT):
 * k < 1 (logarithmic: 2), t[0] < 1. */
int trend_fit(enum trend_kind kind, const double *t, const double *u, size_t k, struct trend *trend);
/* Displacement since the last cycle, h cycles later. */
double trend_ahead(const struct trend *trend, double h);

/* Cycles k for which the mean of errors within [low, high] stays below `error` with probability 1 - p:
 * k >= (high - low)^2 / (2 error^2) ln(2 / p). Errors (EXIT_INPUT): error or p not positive, p >= 1. */
int chernoff_cycles(double low, double high, double error, double p, double *cycles);

/* Positions of all grains (x0 y0 x1 y1 ...) at the ends of cycles. */
struct cycle_ends {
    size_t values; /* 2 per grain */
    size_t cycles; /* ends kept: one more than the cycles between them */
    double *at;    /* cycles x values */
    double *cycle; /* number of each: they may have gaps */
    size_t capacity;
};
int cycle_ends_add(struct cycle_ends *ends, double cycle, const double *positions, size_t values);
void cycle_ends_free(struct cycle_ends *ends);
/* Each value h cycles after the last end. `trends` (values) may be NULL. */
int cycle_ends_ahead(const struct cycle_ends *ends, enum trend_kind kind, double h, double *ahead,
                     struct trend *trends);

/* |u - v| / |u|, norms over all values, both counted from `origin` (NULL: 0) [22]. */
double relative_error(const double *u, const double *v, const double *origin, size_t values);

#endif
