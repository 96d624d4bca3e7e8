#include "contacts/pair_statistics.h"

#include <math.h>

enum { MAX_ROUNDS = 200, MAX_ROUNDS_NEAR = 25 };
#define CONVERGED 1e-5 /* relative change of every number */
#define LOG_ROOT_2PI 0.91893853320467274
/* Pseudo-pairs: what is believed before any pair has been seen. */
#define PRIOR_TOUCHING 2.0
#define PRIOR_RESTING 0.2
#define PRIOR_APART 1.0

/* log Phi(z): normal distribution function; the tail by its asymptotic series (Abramowitz and Stegun 26.2.12). */
static double log_phi(double z)
{
    if (z > -12)
        return log(0.5 * erfc(-z * M_SQRT1_2));
    double q = 1 / (z * z);
    return -0.5 * z * z - log(-z) - LOG_ROOT_2PI + log1p(-q * (1 - 3 * q * (1 - 5 * q)));
}

/* A position without any error still has rounding. */
static double usable_error(const struct pair_statistics *st, double s)
{
    return fmax(s, 1e-6 * st->window);
}

/* A normal variable of mean u and deviation s, cut at zero: its log mass, mean, and second moment. */
struct cut_normal {
    double log_mass, first, second;
};

static struct cut_normal cut_normal(double u, double s)
{
    double z = u / s, log_mass = log_phi(z);
    double hazard = exp(-0.5 * z * z - LOG_ROOT_2PI - log_mass);
    double first = fmax(u + s * hazard, 1e-12 * s);
    return (struct cut_normal){log_mass, first, fmax(u * first + s * s, first * first)};
}

static double log_touching(const struct pair_statistics *st, double x, double s, struct cut_normal *cut)
{
    double m = st->scale;
    *cut = cut_normal(x - s * s / m, s);
    double bracket = st->flat + (1 - st->flat) * cut->first / m;
    return log(st->touching / m * bracket) + 0.5 * (s / m) * (s / m) - x / m + cut->log_mass;
}

static struct pair_odds odds_and_moments(const struct pair_statistics *st, double x, double s, struct cut_normal *cut)
{
    s = usable_error(st, s);
    double touching = log_touching(st, x, s, cut);
    double resting = log(st->resting / s) - 0.5 * (x / s) * (x / s) - LOG_ROOT_2PI;
    double apart = log(st->apart / st->window) + log_phi(-x / s);
    double most = fmax(touching, fmax(resting, apart));
    double sum = exp(touching - most) + exp(resting - most) + exp(apart - most);
    return (struct pair_odds){exp(touching - most) / sum, exp(resting - most) / sum, exp(apart - most) / sum,
                              most + log(sum)};
}

struct pair_odds pair_odds(const struct pair_statistics *statistics, double x, double s)
{
    struct cut_normal cut;
    return odds_and_moments(statistics, x, s, &cut);
}

/* First guess: what is positive touches. */
static void first_guess(const double *x, const double *s, size_t count, struct pair_statistics *st)
{
    double touching = 0, overlap = 0, error = 0;
    for (size_t k = 0; k < count; k++) {
        if (!(x[k] >= -st->window))
            continue;
        st->pairs++;
        error += s[k];
        if (x[k] > 0) {
            touching++;
            overlap += x[k];
        }
    }
    double pairs = (double)st->pairs, sum = pairs + PRIOR_TOUCHING + PRIOR_APART;
    double mean = touching > 0 ? overlap / touching : 0.1 * st->window;
    mean = fmax(mean, fmax(st->pairs ? 0.25 * error / pairs : 0, 1e-6 * st->window));
    st->flat = 0.5;
    st->scale = mean / (2 - st->flat);
    st->resting = 0.05;
    st->touching = 0.95 * (touching + PRIOR_TOUCHING) / sum;
    st->apart = 0.95 * (pairs - touching + PRIOR_APART) / sum;
}

/* One round; the guess counts as PRIOR pairs. Returns the largest relative change. */
static double improve(const double *x, const double *s, size_t count, const struct pair_statistics *guess,
                      struct pair_statistics *st)
{
    double touching = PRIOR_TOUCHING, resting = PRIOR_RESTING, apart = PRIOR_APART;
    double overlap = touching * pair_mean_overlap(guess), flat = touching * guess->flat;
    st->log_likelihood = 0;
    for (size_t k = 0; k < count; k++) {
        struct cut_normal cut;
        if (!(x[k] >= -st->window))
            continue;
        struct pair_odds odds = odds_and_moments(st, x[k], s[k], &cut);
        double w = st->flat / (st->flat + (1 - st->flat) * cut.first / st->scale);
        touching += odds.touching;
        resting += odds.resting;
        apart += odds.apart;
        flat += odds.touching * w;
        overlap += odds.touching * (w * cut.first + (1 - w) * cut.second / cut.first);
        st->log_likelihood += odds.log_density;
    }
    struct pair_statistics old = *st;
    double sum = touching + resting + apart;
    st->touching = touching / sum;
    st->resting = resting / sum;
    st->apart = apart / sum;
    st->flat = fmin(fmax(flat / touching, 0.02), 0.98);
    st->scale = fmax(overlap / touching / (2 - st->flat), 1e-6 * st->window);
    return fmax(fmax(fabs(log(st->touching / old.touching)), fabs(log(st->apart / old.apart))),
                fmax(fabs(log(st->scale / old.scale)), fabs(st->flat - old.flat)));
}

void pair_statistics_fit(const double *x, const double *s, size_t count, double window,
                         const struct pair_statistics *start, struct pair_statistics *st)
{
    struct pair_statistics guess = {.window = window};
    first_guess(x, s, count, &guess);
    *st = guess;
    if (start) {
        *st = *start;
        st->window = window;
        st->pairs = guess.pairs;
    }
    for (int round = 0; round < (start ? MAX_ROUNDS_NEAR : MAX_ROUNDS); round++)
        if (improve(x, s, count, &guess, st) < CONVERGED)
            break;
}
