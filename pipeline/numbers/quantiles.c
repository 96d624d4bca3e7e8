/* Hoare's selection (CACM 4 (1961) 321) with the median of three as pivot. No value is NaN. */
#include "pipeline/numbers/quantiles.h"

#include <math.h>
#include <stdlib.h>

#include "pipeline/speak/error.h"

static void swap(double *a, double *b)
{
    double kept = *a;
    *a = *b;
    *b = kept;
}

static double pivot_of(double *values, size_t low, size_t high)
{
    size_t middle = low + (high - low) / 2;
    if (values[middle] < values[low])
        swap(&values[middle], &values[low]);
    if (values[high] < values[low])
        swap(&values[high], &values[low]);
    if (values[high] < values[middle])
        swap(&values[high], &values[middle]);
    return values[middle];
}

double select_rank(double *values, size_t count, size_t rank)
{
    size_t low = 0, high = count - 1;
    while (low < high) {
        double pivot = pivot_of(values, low, high);
        size_t i = low, j = high;
        for (;;) {
            while (values[i] < pivot)
                i++;
            while (values[j] > pivot)
                j--;
            if (i >= j)
                break;
            swap(&values[i++], &values[j--]);
        }
        /* low..j <= pivot <= i..high, and i - j is 0 or 1 */
        if (rank <= j)
            high = j;
        else
            low = j + 1;
    }
    return values[rank];
}

double median_of(double *values, size_t count)
{
    if (count == 0)
        return NAN;
    double upper = select_rank(values, count, count / 2);
    if (count % 2)
        return upper;
    double lower = values[0];
    for (size_t k = 1; k < count / 2; k++)
        lower = values[k] > lower ? values[k] : lower;
    return 0.5 * (lower + upper);
}

static int by_value(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

void sort_values(double *values, size_t count)
{
    qsort(values, count, sizeof *values, by_value);
}

double quantile(const double *sorted, size_t count, double share)
{
    if (count == 0)
        return NAN;
    double place = share * (double)(count - 1);
    size_t below = (size_t)place;
    if (below + 1 >= count)
        return sorted[count - 1];
    return sorted[below] + (place - (double)below) * (sorted[below + 1] - sorted[below]);
}

double *sorted_values(const double *column, const uint32_t *flags, uint32_t distrust, size_t rows, size_t *count)
{
    double *values = malloc((rows + 1) * sizeof *values);
    *count = 0;
    if (!values) {
        (void)error_memory("quantiles");
        return NULL;
    }
    for (size_t k = 0; k < rows && column; k++)
        if (isfinite(column[k]) && !(flags && flags[k] & distrust))
            values[(*count)++] = column[k];
    sort_values(values, *count);
    return values;
}

int quantiles_of(const double *column, const uint32_t *flags, uint32_t distrust, size_t rows,
                 struct quantiles *quantiles)
{
    size_t count;
    double *values = sorted_values(column, flags, distrust, rows, &count);
    if (!values)
        return -1;
    *quantiles =
        (struct quantiles){quantile(values, count, 0), quantile(values, count, 0.05), quantile(values, count, 0.5),
                           quantile(values, count, 0.95), quantile(values, count, 1)};
    free(values);
    return 0;
}
