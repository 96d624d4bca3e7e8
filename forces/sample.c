#include "forces/sample.h"

#include <stdlib.h>
#include <string.h>

#include "pipeline/error.h"
#include "pipeline/random.h"

void spread_free(struct spread *spread)
{
    free(spread->s_fn), free(spread->s_ft), free(spread->fn_min), free(spread->fn_max);
    memset(spread, 0, sizeof *spread);
}

/* Random numbers of one draw: a key per draw and kind, a counter per contact or error. */
static uint64_t key_of(size_t draw, unsigned kind)
{
    return random_bits(random_bits(0x5EEDu, draw), kind);
}

/* The same evidence with other errors of the same size. */
static int disturb(const struct evidence *from, size_t draw, struct evidence *to)
{
    size_t count = from->count;
    double *errors = malloc((from->errors + 1) * sizeof *errors);
    if (!errors || evidence_copy(from, to)) {
        free(errors);
        return errors ? -1 : error_memory("samples");
    }
    for (size_t k = 0; k < from->errors; k++)
        errors[k] = random_normal(key_of(draw, 0), k);
    for (size_t c = 0; c < count; c++) {
        for (int k = 0; k < EVIDENCE_WIDTH && from->place[c][k] >= 0; k++)
            to->measured[c] += from->share[c][k] * errors[from->place[c][k]];
        to->measured[c] += sqrt(from->slack[c]) * random_normal(key_of(draw, 1), c);
        to->prior[2 * c] += sqrt(from->variance[2 * c]) * random_normal(key_of(draw, 2), c);
        to->prior[2 * c + 1] += sqrt(from->variance[2 * c + 1]) * random_normal(key_of(draw, 3), c);
    }
    free(errors);
    return 0;
}

static int draw_one(const struct network *network, const struct force_options *options, const struct evidence *evidence,
                    size_t draw, double *f)
{
    struct evidence disturbed = {0};
    struct outcome outcome;
    if (disturb(evidence, draw, &disturbed))
        return -1;
    int status = map_solve(network, options, &disturbed, f, &outcome);
    evidence_free(&disturbed);
    return status;
}

static int compare_doubles(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* Linear between the order statistics. */
static double quantile(const double *sorted, size_t count, double share)
{
    double at = share * (double)(count - 1);
    size_t k = (size_t)at < count - 1 ? (size_t)at : count - 2;
    return sorted[k] + (at - (double)k) * (sorted[k + 1] - sorted[k]);
}

static double deviation(const double *values, size_t count)
{
    double mean = 0, sum = 0;
    for (size_t k = 0; k < count; k++)
        mean += values[k] / (double)count;
    for (size_t k = 0; k < count; k++)
        sum += (values[k] - mean) * (values[k] - mean);
    return sqrt(sum / (double)(count - 1));
}

static void summarise(const double *draws, size_t samples, size_t count, double *values, struct spread *spread)
{
    for (size_t c = 0; c < count; c++) {
        for (size_t k = 0; k < samples; k++)
            values[k] = draws[k * 2 * count + 2 * c + 1];
        spread->s_ft[c] = deviation(values, samples);
        for (size_t k = 0; k < samples; k++)
            values[k] = draws[k * 2 * count + 2 * c];
        spread->s_fn[c] = deviation(values, samples);
        qsort(values, samples, sizeof *values, compare_doubles);
        spread->fn_min[c] = quantile(values, samples, 0.05);
        spread->fn_max[c] = quantile(values, samples, 0.95);
    }
}

int sample_forces(const struct network *network, const struct force_options *options, const struct evidence *evidence,
                  struct spread *spread)
{
    size_t count = network->count, samples = (size_t)options->samples;
    double *draws = calloc(samples * 2 * count + 1, sizeof *draws), *values = calloc(samples + 1, sizeof *values);
    struct error_shared shared = ERROR_SHARED_NONE;
    *spread = (struct spread){calloc(count + 1, sizeof(double)), calloc(count + 1, sizeof(double)),
                              calloc(count + 1, sizeof(double)), calloc(count + 1, sizeof(double))};
    int status = draws && values && spread->s_fn && spread->s_ft && spread->fn_min && spread->fn_max
                     ? 0
                     : error_memory("samples");
    if (!status) {
#pragma omp parallel for schedule(dynamic)
        for (size_t k = 0; k < samples; k++)
            if (draw_one(network, options, evidence, k, draws + k * 2 * count))
                error_share(&shared, (long)k);
        status = error_collect(&shared);
    }
    if (!status)
        summarise(draws, samples, count, values, spread);
    else
        spread_free(spread);
    free(draws), free(values);
    return status;
}
