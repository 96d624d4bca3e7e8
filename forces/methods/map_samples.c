/* Randomise, then optimise (Bardsley et al. 2014): for a linear Gaussian model the optimum of a problem whose data and
 * beliefs were disturbed by errors of their own size is a draw from the posterior; here cones cut it, and a factor
 * makes good for that. Every draw has its own random numbers, by its number, so that threads change nothing. */
#include "forces/methods/map_samples.h"

#include <stdlib.h>
#include <string.h>

#include "forces/methods/map.h"
#include "pipeline/speak/error.h"
#include "pipeline/numbers/random.h"

/* Draws that end on an edge of their cone are spread less than the forces really are: a factor measured on virtual
 * states at kappa = 100, 1000 and 10000 (bench_forces interval). */
#define CALIBRATION 1.2
#define DRAW_BARRIER 1e-2 /* of the estimate's: a draw may come close to the edges */
#define DRAW_ROUGH 1e3    /* far below the spread */
#define LEAST_SPREAD 1e-3 /* <fn> */

/* Random numbers of one draw: a key per draw and kind, a counter per contact or error. */
static uint64_t key_of(size_t draw, unsigned kind)
{
    return random_bits(random_bits(0x5EEDu, draw), kind);
}

/* The same evidence with other errors of the same size; what is not an overlap counts as slack of its last round. */
static int disturb(const struct map *base, size_t draw, struct evidence *to)
{
    const struct evidence *from = base->evidence;
    if (evidence_copy(from, to))
        return -1;
    for (size_t c = 0; c < from->count; c++) {
        for (int k = 0; k < EVIDENCE_WIDTH && from->place[c][k] >= 0; k++)
            to->measured[c] += from->share[c][k] * random_normal(key_of(draw, 0), (uint64_t)from->place[c][k]);
        to->measured[c] += sqrt(base->slack[c]) * random_normal(key_of(draw, 1), c);
        to->prior[2 * c] += sqrt(from->variance[2 * c]) * random_normal(key_of(draw, 2), c);
        to->prior[2 * c + 1] += sqrt(from->variance[2 * c + 1]) * random_normal(key_of(draw, 3), c);
    }
    return 0;
}

/* Each draw starts from the solution of the undisturbed problem, whatever was drawn before it. */
static int draw_one(const struct map *base, size_t draw, struct map *map, struct evidence *disturbed, double *f)
{
    int iterations = 0;
    if (disturb(base, draw, disturbed))
        return -1;
    map_copy(base, map);
    map->evidence = disturbed;
    for (size_t c = 0; c < map->count; c++) /* the barrier keeps away from the edges: a draw may come close to them */
        map->weight[c] *= DRAW_BARRIER;
    memcpy(map->variance, base->evidence->variance, 2 * map->count * sizeof(double));
    map->rough = DRAW_ROUGH;
    int status = map_interior(map, &iterations);
    memcpy(f, map->forces, 2 * map->count * sizeof *f);
    evidence_free(disturbed);
    return status < 0 ? -1 : 0;
}

/* Of the draws of one component, calibrated. */
static double deviation(const double *draws, size_t samples, size_t stride)
{
    double mean = 0, sum = 0;
    for (size_t k = 0; k < samples; k++)
        mean += draws[k * stride] / (double)samples;
    for (size_t k = 0; k < samples; k++)
        sum += pow(draws[k * stride] - mean, 2);
    return CALIBRATION * fmax(LEAST_SPREAD, sqrt(sum / (double)(samples - 1)));
}

/* One map per thread, which each draw overwrites. */
static int draw_all(const struct map *base, size_t samples, double *draws)
{
    struct error_shared shared = ERROR_SHARED_NONE;
#pragma omp parallel
    {
        struct map map;
        int failed = map_begin(base->network, base->options, base->evidence, &map);
#pragma omp for schedule(dynamic)
        for (size_t k = 0; k < samples; k++) {
            struct evidence disturbed = {0};
            if (failed || draw_one(base, k, &map, &disturbed, draws + k * 2 * base->count))
                error_share(&shared, (long)k);
        }
        map_free(&map);
    }
    return error_collect(&shared);
}

static int spread_of(const struct map *base, size_t samples, double *draws, struct spread *spread)
{
    if (draw_all(base, samples, draws))
        return -1;
    for (size_t c = 0; c < base->count; c++)
        spread_set(spread, c, base->forces[2 * c], deviation(draws + 2 * c, samples, 2 * base->count),
                   deviation(draws + 2 * c + 1, samples, 2 * base->count));
    return 0;
}

int map_sample(const struct network *network, const struct force_options *options, const struct evidence *evidence,
               struct spread *spread)
{
    size_t count = network->count, samples = (size_t)options->samples;
    double *draws = calloc(samples * 2 * count + 1, sizeof *draws);
    struct map base = {0};
    struct outcome outcome = {0};
    int status = draws ? spread_alloc(count, spread) : error_memory("samples");
    if (!status)
        status = map_begin(network, options, evidence, &base) || map_rounds(&base, &outcome) ||
                         spread_of(&base, samples, draws, spread)
                     ? -1
                     : 0;
    map_free(&base);
    free(draws);
    return status;
}
