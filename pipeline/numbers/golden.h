/* The least value of a function of one unknown. */
#ifndef PIPELINE_GOLDEN_H
#define PIPELINE_GOLDEN_H

/* Where f is least on [low, high], by golden sections (Kiefer, Proc. Am. Math. Soc. 4 (1953) 502) until the interval is
 * not longer than `tolerance` > 0: its middle. Of a function with several minima, one of them. Each section costs one
 * call and leaves 0.618 of the interval. */
double golden_section(double (*f)(double x, void *user), void *user, double low, double high, double tolerance);

#endif
