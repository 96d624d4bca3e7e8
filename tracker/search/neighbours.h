/* What the grains around say: the median motion of those that were tracked well. */
#ifndef TRACKER_NEIGHBOURS_H
#define TRACKER_NEIGHBOURS_H

#include "tracker/search/target.h"

enum { NEIGHBOURS = 8 };

/* For each of `count` targets, its NEIGHBOURS nearest others in the reference, nearest first, -1 where there are fewer;
 * count * NEIGHBOURS numbers to be freed with free(). NULL: out of memory. */
long *neighbours_find(const struct target *targets, size_t count);

/* Median motion of the neighbours that are good and not ambiguous, component by component; returns how many there are.
 */
int neighbours_motion(const long *nearest, const struct outcome *outcomes, struct motion *motion);

#endif
