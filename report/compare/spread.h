/* Mean, root mean square and largest size of errors, one by one. */
#ifndef REPORT_SPREAD_H
#define REPORT_SPREAD_H

#include <math.h>
#include <stddef.h>

struct spread {
    double sum, squares, largest;
    size_t count;
};

/* An error that is not finite does not count. */
static inline void spread_add(struct spread *spread, double error)
{
    if (!isfinite(error))
        return;
    spread->sum += error;
    spread->squares += error * error;
    spread->largest = fmax(spread->largest, fabs(error));
    spread->count++;
}

static inline double spread_mean(const struct spread *spread)
{
    return spread->sum / (double)spread->count;
}

static inline double spread_rms(const struct spread *spread)
{
    return sqrt(spread->squares / (double)spread->count);
}

static inline double spread_largest(const struct spread *spread)
{
    return spread->count ? spread->largest : NAN;
}

#endif
