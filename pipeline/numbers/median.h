/* Order statistics of numbers none of which is NaN. */
#ifndef PIPELINE_MEDIAN_H
#define PIPELINE_MEDIAN_H

#include <stddef.h>

/* The value that stands at `rank` (0 is the smallest) after sorting; reorders the values. rank < count. */
double select_rank(double *values, size_t count, size_t rank);
/* Median, the mean of the middle two for an even count; reorders the values. NaN for none. */
double median_of(double *values, size_t count);
/* Ascending. */
void sort_values(double *values, size_t count);

#endif
