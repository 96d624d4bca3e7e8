/* How overlaps and gaps are distributed near touching, learnt from the photo itself. Contacts pile up just above
 * zero (true overlaps about exponential with mean m), few gaps lie just below (density nearly constant there):
 *
 *     density of a true overlap t:   contacts / m exp(-t / m)  for t > 0,   gaps  for t < 0   (pairs per m)
 *
 * and a measured overlap is t + s N(0, 1) with the standard error s of that pair, so that
 *
 *     touching(x, s) = contacts / m exp(s^2 / 2 m^2 - x / m) Phi(x / s - s / m),   apart(x, s) = gaps Phi(-x / s),
 *
 * and the probability of contact is touching / (touching + apart) (Bayes). The three numbers are found by expectation
 * maximisation (Dempster, Laird and Rubin 1977) with the weight of one pseudo-pair on either side, which alone decides
 * when there are hardly any pairs. */
#ifndef CONTACTS_PAIR_STATISTICS_H
#define CONTACTS_PAIR_STATISTICS_H

#include <stddef.h>

struct pair_statistics {
    double contacts; /* expected number of touching pairs */
    double overlap;  /* m: their mean overlap */
    double gaps;     /* 1/m: density of pairs just apart */
    double window;   /* m: pairs with a larger gap were not looked at */
    size_t pairs;    /* looked at */
};

/* x, s: measured overlaps and their standard errors; pairs with x < -window are left out. window > 0. */
void pair_statistics_fit(const double *x, const double *s, size_t count, double window,
                         struct pair_statistics *statistics);
/* Probability that the true overlap is positive. */
double pair_probability(const struct pair_statistics *statistics, double x, double s);
/* log(touching + apart). */
double pair_log_density(const struct pair_statistics *statistics, double x, double s);

#endif
