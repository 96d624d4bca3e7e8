/* How overlaps and gaps are distributed near touching; the numbers are learnt from the photo itself.
 *
 * Pairs that are squeezed have a true overlap t > 0 with density (1/m) exp(-t/m) (w + (1 - w) t/m), the shape of the
 * distribution of contact forces: nearly flat from zero to the mean, then exponential. Free grains rest against their
 * neighbours at t = 0. Pairs just apart have a density that is nearly constant over a small window below zero. A
 * measured overlap is x = t + s N(0, 1) with the standard error s of that pair, so that, with u = x - s^2/m,
 *
 *     touching(x, s) = T (1/m) exp(s^2/2m^2 - x/m) [w Phi(u/s) + (1 - w)(u Phi(u/s) + s phi(u/s))/m],
 *     resting(x, s)  = R phi(x/s)/s,      apart(x, s) = A Phi(-x/s)/window,      T + R + A = 1,
 *
 * and Bayes' rule gives the probabilities. T, R, A, m and w are found by expectation maximisation (Dempster, Laird and
 * Rubin 1977) with a few pseudo-pairs, which alone decide when there are hardly any pairs. */
#ifndef CONTACTS_PAIR_STATISTICS_H
#define CONTACTS_PAIR_STATISTICS_H

#include <stddef.h>

struct pair_statistics {
    double touching, resting, apart; /* shares of the pairs with x >= -window: T, R, A */
    double scale;                    /* m of the density above, m; the mean overlap is m (2 - w) */
    double flat;                     /* w */
    double window;                   /* m */
    size_t pairs;                    /* that were looked at */
    double log_likelihood;           /* of these pairs, with the density in 1/m */
};

/* x, s: overlaps and their standard errors, m; pairs with x < -window are left out. start (NULL: none): statistics of
 * nearly the same overlaps, from where fewer rounds are needed. */
void pair_statistics_fit(const double *x, const double *s, size_t count, double window,
                         const struct pair_statistics *start, struct pair_statistics *statistics);

/* Probabilities of the three cases, and the log of the summed density. */
struct pair_odds {
    double touching, resting, apart;
    double log_density;
};
struct pair_odds pair_odds(const struct pair_statistics *statistics, double x, double s);

static inline double pair_mean_overlap(const struct pair_statistics *statistics)
{
    return statistics->scale * (2 - statistics->flat);
}

#endif
