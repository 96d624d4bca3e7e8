#include "contacts/pair_statistics.h"

#include <math.h>

enum { MAX_ROUNDS = 500 };
#define CONVERGED 1e-9 /* relative change of each of the three numbers */

/* log Phi(z): normal distribution function; the tail by its asymptotic series (Abramowitz and Stegun 26.2.12). */
static double log_phi(double z)
{
    if (z > -12)
        return log(0.5 * erfc(-z * M_SQRT1_2));
    double q = 1 / (z * z);
    return -0.5 * z * z - log(-z) - 0.91893853320467274 + log1p(-q * (1 - 3 * q * (1 - 5 * q)));
}

/* phi(z) / Phi(z). */
static double hazard(double z)
{
    return exp(-0.5 * z * z - 0.91893853320467274 - log_phi(z));
}

/* A measured overlap of an exact position still has rounding. */
static double usable_error(const struct pair_statistics *st, double s)
{
    return fmax(s, 1e-6 * st->window);
}

static double log_touching(const struct pair_statistics *st, double x, double s)
{
    double m = st->overlap;
    return log(st->contacts / m) + 0.5 * (s / m) * (s / m) - x / m + log_phi(x / s - s / m);
}

static double log_apart(const struct pair_statistics *st, double x, double s)
{
    return log(st->gaps) + log_phi(-x / s);
}

double pair_probability(const struct pair_statistics *st, double x, double s)
{
    s = usable_error(st, s);
    return 1 / (1 + exp(log_apart(st, x, s) - log_touching(st, x, s)));
}

double pair_log_density(const struct pair_statistics *st, double x, double s)
{
    s = usable_error(st, s);
    double a = log_touching(st, x, s), b = log_apart(st, x, s);
    return fmax(a, b) + log1p(exp(-fabs(a - b)));
}

/* Mean true overlap of a touching pair measured as x: a normal of mean x - s^2/m cut at zero. */
static double expected_overlap(const struct pair_statistics *st, double x, double s)
{
    double centre = x - s * s / st->overlap;
    return fmax(0, centre + s * hazard(centre / s));
}

/* First guess: what is positive touches. Its mean overlap also is the pseudo-pair's. */
static void first_guess(const double *x, const double *s, size_t count, struct pair_statistics *st)
{
    double touching = 0, overlap = 0, error = 0;
    st->pairs = 0;
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
    double pairs = (double)st->pairs;
    double floor = fmax(0.25 * (st->pairs ? error / pairs : 0), 1e-6 * st->window);
    st->contacts = touching + 1;
    st->overlap = fmax(touching > 0 ? overlap / touching : 0.1 * st->window, floor);
    st->gaps = (pairs - touching + 1) / st->window;
}

void pair_statistics_fit(const double *x, const double *s, size_t count, double window, struct pair_statistics *st)
{
    *st = (struct pair_statistics){.window = window};
    first_guess(x, s, count, st);
    double prior = st->overlap, change = INFINITY;
    for (int round = 0; round < MAX_ROUNDS && change > CONVERGED; round++) {
        double touching = 1, overlap = prior, apart = 1;
        for (size_t k = 0; k < count; k++) {
            if (!(x[k] >= -window))
                continue;
            double p = pair_probability(st, x[k], s[k]);
            touching += p;
            apart += 1 - p;
            overlap += p * expected_overlap(st, x[k], usable_error(st, s[k]));
        }
        struct pair_statistics next = *st;
        next.contacts = touching;
        next.overlap = fmax(overlap / touching, 1e-6 * window);
        next.gaps = apart / window;
        change = fmax(fabs(log(next.contacts / st->contacts)),
                      fmax(fabs(log(next.overlap / st->overlap)), fabs(log(next.gaps / st->gaps))));
        *st = next;
    }
}
