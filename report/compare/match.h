/* Which grain of one file is which grain of another: one to one, by position. */
#ifndef REPORT_MATCH_H
#define REPORT_MATCH_H

#include <stddef.h>

struct match_points {
    size_t count;
    const double *x, *y; /* rows that are not finite, or beyond 1e150, match nothing */
};

/* Pairs closer than half the radius of the grain of b, the nearest pair first, every grain in at most one pair.
 * b_of_a[k]: the row of b for row k of a, or -1. Returns 0, or -1 when out of memory. */
int match_grains(const struct match_points *a, const struct match_points *b, const double *radius_b, long *b_of_a);

#endif
