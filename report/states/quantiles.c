#include "report/states/quantiles.h"

#include <math.h>
#include <stdlib.h>

#include "pipeline/speak/error.h"
#include "pipeline/packing/grains.h"
#include "pipeline/numbers/median.h"

double *sorted_values(const double *column, const uint32_t *flags, size_t rows, size_t *count)
{
    double *values = malloc((rows + 1) * sizeof *values);
    *count = 0;
    if (!values) {
        (void)error_memory("quantiles");
        return NULL;
    }
    for (size_t k = 0; k < rows && column; k++)
        if (isfinite(column[k]) && !(flags && flags[k] & GRAIN_DISTRUST))
            values[(*count)++] = column[k];
    sort_values(values, *count);
    return values;
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

int quantiles_of(const double *column, const uint32_t *flags, size_t rows, struct quantiles *quantiles)
{
    size_t count;
    double *values = sorted_values(column, flags, rows, &count);
    if (!values)
        return -1;
    *quantiles =
        (struct quantiles){quantile(values, count, 0), quantile(values, count, 0.05), quantile(values, count, 0.5),
                           quantile(values, count, 0.95), quantile(values, count, 1)};
    free(values);
    return 0;
}
