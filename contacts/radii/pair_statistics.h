/* How overlaps and gaps are distributed near touching; the numbers are learnt from the photo itself.
 *
 * Pairs that are squeezed have a true overlap t > 0 with the density of contact forces, nearly flat from zero to the
 * mean, then falling. With the half-normal law h(t; a) = 2 N(t; 0, a) and Rayleigh's r(t; a) = t exp(-t^2/2a^2)/a^2 it
 * is w h(t; a) + v h(t; 3a) + (1 - w - v) r(t; a): one scale, so that the likelihood has one summit, and a far flank
 * that may be anything from a normal to an exponential one. Free grains rest against their neighbours at t = 0. Pairs
 * just apart have a density that is nearly constant over a small window below zero. A measured overlap is x = t + s
 * N(0, 1) with the standard error s of that pair. With q^2 = a^2 + s^2, u = x a^2/q^2 and z = a s/q (the normal law of
 * t given x before it is cut at zero),
 *
 *     h becomes 2 N(x; 0, q) Phi(u/z),      r becomes (2 pi)^1/2/a N(x; 0, q) [u Phi(u/z) + z phi(u/z)],
 *     resting(x, s)  = R N(x; 0, s),        apart(x, s) = A Phi(-x/s)/window,      touching + resting + apart = 1,
 *
 * and Bayes' rule gives the probabilities. The shares T, R, A, w, v and a are found by expectation maximisation
 * (Dempster, Laird and Rubin 1977) with a few pseudo-pairs, which alone decide when there are hardly any pairs.
 *
 * Where errors are larger than the overlaps, x does not tell the scale: any asymmetry of the errors would pass for
 * overlaps. Where the loads say what all overlaps add up to (loaded_overlaps.h), the laws' shares stay
 * as they are guessed and the scale is where n T <t> is that sum. */
#ifndef CONTACTS_PAIR_STATISTICS_H
#define CONTACTS_PAIR_STATISTICS_H

#include <stddef.h>

struct pair_statistics {
    double touching, resting, apart; /* shares of the pairs with x >= -window: T, R, A */
    double flat, wide;               /* w, v */
    double scale;                    /* m: a */
    double window;                   /* m */
    size_t pairs;                    /* that were looked at */
    double log_likelihood;           /* of these pairs, with the density in 1/m */
};

/* What is held true of the pairs. */
struct pair_premises {
    double window; /* m: pairs with x < -window are left out */
    int rests;     /* 0: R = 0 */
    double sum;    /* m: of the true overlaps of these pairs; 0: not known, scale and shares of the laws are fitted */
};

/* x, s: overlaps and their standard errors, m. start (NULL: none): statistics of nearly the same overlaps, from where
 * fewer rounds are needed. */
void pair_statistics_fit(const double *x, const double *s, size_t count, const struct pair_premises *premises,
                         const struct pair_statistics *start, struct pair_statistics *statistics);

/* The shares of other pairs, few or many, whose squeezed ones are spread as in `like`. */
void pair_statistics_shares(const double *x, const double *s, size_t count, const struct pair_statistics *like,
                            struct pair_statistics *statistics);

/* Probabilities of the three cases, and the log of the summed density. */
struct pair_odds {
    double touching, resting, apart;
    double log_density;
};
struct pair_odds pair_odds(const struct pair_statistics *statistics, double x, double s);

/* Mean true overlap of the touching pairs, m. */
double pair_mean_overlap(const struct pair_statistics *statistics);

#endif
