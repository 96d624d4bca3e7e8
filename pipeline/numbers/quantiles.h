/* Order statistics: ranks, the median and quantiles, in one definition for all stages. Values that are sorted or ranked
 * are never NaN; the functions that take a whole column leave out what is not finite. */
#ifndef PIPELINE_QUANTILES_H
#define PIPELINE_QUANTILES_H

#include <stddef.h>
#include <stdint.h>

struct quantiles {
    double least, low, middle, high, most; /* 0, 5, 50, 95, 100 %; NaN: no value */
};

/* The value that stands at `rank` (0 is the smallest) after sorting; reorders the values, in time that grows linearly
 * with their count. rank < count. */
double select_rank(double *values, size_t count, size_t rank);
/* Median, the mean of the middle two for an even count; reorders the values. NaN for none. */
double median_of(double *values, size_t count);
/* Ascending. */
void sort_values(double *values, size_t count);
/* The value below which a share (0 to 1) of the sorted values lies: linear between the ranks share (count - 1), type 7
 * of Hyndman & Fan (American Statistician 50 (1996) 361), the default of R and numpy. NaN without values. */
double quantile(const double *sorted, size_t count, double share);

/* The finite values of a column, sorted, but for rows whose flags have a bit of `distrust` (flags NULL: of all rows);
 * to be freed. NULL: out of memory (error line). A missing column (NULL) has no values. */
double *sorted_values(const double *column, const uint32_t *flags, uint32_t distrust, size_t rows, size_t *count);
/* The five quantiles of those values. 0, or -1 when out of memory. */
int quantiles_of(const double *column, const uint32_t *flags, uint32_t distrust, size_t rows,
                 struct quantiles *quantiles);

#endif
