/* Quantiles of a column over the rows that are trusted. */
#ifndef REPORT_QUANTILES_H
#define REPORT_QUANTILES_H

#include <stddef.h>
#include <stdint.h>

struct quantiles {
    double least, low, middle, high, most; /* 0, 5, 50, 95, 100 %; NaN: no value */
};

/* The finite values of rows without a "do not trust" flag (flags NULL: of all rows), sorted; to be freed. NULL: out of
 * memory. A missing column has no values. */
double *sorted_values(const double *column, const uint32_t *flags, size_t rows, size_t *count);
/* The value below which a share of the sorted values lies, interpolated; NaN without values. */
double quantile(const double *sorted, size_t count, double share);
/* 0, or -1 when out of memory. */
int quantiles_of(const double *column, const uint32_t *flags, size_t rows, struct quantiles *quantiles);

#endif
