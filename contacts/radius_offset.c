#include "contacts/radius_offset.h"

#include <stdlib.h>

#include "pipeline/error.h"

enum { MAX_PAIRS = 20000, LEAST_PAIRS = 60, TRIALS = 11, ZOOMS = 7 };
#define UNSHARP 0.4        /* of the mean overlap: an edge is sharper than this, */
#define CLEARLY 12.0       /* in log-likelihood */
#define SHARPER 2.0        /* in log-likelihood: of two readings of the rims */
#define RESOLVED 0.7       /* deviation over step */
#define LEAST_CONTRAST 3.0 /* density of touching over that of apart pairs at zero, below which there is no pile-up */

#define HIDDEN 0.5        /* a zero known no better than to this share of the mean overlap tells nothing, */
#define MODEL_ERROR 0.035 /* of the mean overlap, and */
#define BLUR_ERROR 0.15   /* of the standard error: what the shape of the density leaves open, from simulations */
#define BLURRED 1.2       /* nor do overlaps whose errors are larger than their mean by this factor */

/* The pairs near the pile-up: overlap, error, lever (d overlap / d correction). */
struct sample {
    double *x, *s, *lever, *moved;
    size_t count;
    double lowest, mean_lever; /* only x / lever >= lowest are in the sample */
};

static void sample_free(struct sample *sample)
{
    free(sample->x);
    free(sample->s);
    free(sample->lever);
    free(sample->moved);
}

static int by_value(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static int trusted(const struct grains *grains, const unsigned char *idle, const struct pair *pair)
{
    return !(idle && (idle[pair->i] || idle[pair->j])) &&
           !((grains->flags[pair->i] | grains->flags[pair->j]) & GRAIN_DISTRUST) && isfinite(pair->overlap);
}

/* What the shapes add to an overlap, and to its variance. */
static double shape_overlap(const struct grains *grains, const struct pair *pair, double *variance)
{
    double si = column_or_zero(grains->s_shape, pair->i), sj = column_or_zero(grains->s_shape, pair->j);
    *variance = si * si + sj * sj;
    return rim_radius(grains, pair->i, pair->n) - grains->radius[pair->i] + rim_radius(grains, pair->j, pair->n) -
           grains->radius[pair->j];
}

/* round: every rim as a circle. */
static int sample_take(const struct grains *grains, const struct pairs *pairs, const unsigned char *idle,
                       enum correction_kind kind, int round, struct sample *sample)
{
    size_t stride = pairs->count / MAX_PAIRS + 1, room = pairs->count / stride + 2;
    *sample = (struct sample){.x = malloc(room * sizeof(double)),
                              .s = malloc(room * sizeof(double)),
                              .lever = malloc(room * sizeof(double)),
                              .moved = malloc(room * sizeof(double))};
    if (!sample->x || !sample->s || !sample->lever || !sample->moved)
        return error_memory("overlaps");
    for (size_t p = 0; p < pairs->count; p += stride) {
        const struct pair *pair = &pairs->pair[p];
        if (!trusted(grains, idle, pair))
            continue;
        double variance = 0, shape = round ? shape_overlap(grains, pair, &variance) : 0;
        sample->x[sample->count] = pair->overlap - shape;
        sample->s[sample->count] = sqrt(fmax(pair->s_overlap * pair->s_overlap - variance, 0));
        sample->lever[sample->count++] = kind == CORRECT_OFFSET ? 2 : grains->radius[pair->i] + grains->radius[pair->j];
    }
    return 0;
}

/* The densest stretch that holds a quarter of the touching pairs, found without knowing how many touch: among windows
 * that hold k neighbouring values, k growing from a tenth to a third of all, the densest one of the smallest k. */
static double densest(const double *sorted, size_t count, double share)
{
    size_t k = (size_t)(share * (double)count), best = 0;
    for (size_t a = 0; a + k < count; a++)
        if (sorted[a + k] - sorted[a] < sorted[best + k] - sorted[best])
            best = a;
    return 0.5 * (sorted[best] + sorted[best + k]);
}

/* Where the pile-up is and how wide its upper flank: the mode of x / lever, and the mean beyond it. */
static void find_pile(const struct sample *sample, double *mode, double *width)
{
    double *y = sample->moved, sum = 0, beyond = 0;
    for (size_t k = 0; k < sample->count; k++)
        y[k] = sample->x[k] / sample->lever[k];
    qsort(y, sample->count, sizeof *y, by_value);
    *mode = densest(y, sample->count, 0.2);
    for (size_t k = 0; k < sample->count; k++)
        if (y[k] > *mode) {
            sum += y[k] - *mode;
            beyond++;
        }
    *width = beyond > 0 ? sum / beyond : 0;
}

/* Leave out pairs far below the pile-up, where the density of gaps is no longer that near zero. */
static void sample_cut(struct sample *sample, double lowest)
{
    size_t kept = 0;
    sample->mean_lever = 0;
    for (size_t k = 0; k < sample->count; k++)
        if (sample->x[k] / sample->lever[k] >= lowest) {
            sample->x[kept] = sample->x[k];
            sample->s[kept] = sample->s[k];
            sample->mean_lever += sample->lever[k];
            sample->lever[kept++] = sample->lever[k];
        }
    sample->count = kept;
    sample->lowest = lowest;
    sample->mean_lever /= (double)(kept ? kept : 1);
}

static double log_likelihood(const struct sample *sample, double correction, struct pair_statistics *st)
{
    double window = -(sample->lowest + correction) * sample->mean_lever;
    if (!(window > 0))
        return -INFINITY;
    for (size_t k = 0; k < sample->count; k++)
        sample->moved[k] = sample->x[k] + correction * sample->lever[k];
    struct pair_statistics start = *st;
    pair_statistics_fit(sample->moved, sample->s, sample->count, window * 1.000001, 1, st->pairs ? &start : NULL, st);
    return st->log_likelihood;
}

static double median_error(const struct sample *sample)
{
    for (size_t k = 0; k < sample->count; k++)
        sample->moved[k] = sample->s[k];
    qsort(sample->moved, sample->count, sizeof *sample->moved, by_value);
    return sample->count ? sample->moved[sample->count / 2] : 0;
}

/* The likelihood on a grid over [low, high]: the best trial, and mean and deviation of what it weighs. */
struct scan {
    double low, step, value[TRIALS];
    int best;
    double mean, deviation;
};

static void scan_over(const struct sample *sample, double low, double high, struct pair_statistics *st,
                      struct scan *scan)
{
    double weight = 0, sum = 0, square = 0;
    *scan = (struct scan){.low = low, .step = (high - low) / (TRIALS - 1)};
    for (int t = 0; t < TRIALS; t++) {
        scan->value[t] = log_likelihood(sample, low + t * scan->step, st);
        scan->best = scan->value[t] > scan->value[scan->best] ? t : scan->best;
    }
    for (int t = 0; t < TRIALS; t++) {
        double w = exp(scan->value[t] - scan->value[scan->best]), at = (t - scan->best) * scan->step;
        weight += w;
        sum += w * at;
        square += w * at * at;
    }
    scan->mean = low + scan->best * scan->step + sum / weight;
    scan->deviation = sqrt(fmax(0, square / weight - sum * sum / (weight * weight)));
}

/* The greatest likelihood near a correction when every overlap had this much more error. */
static double best_when_blurred(struct sample *sample, double correction, double blur)
{
    struct pair_statistics st = {0};
    struct scan scan;
    double reach = blur / sample->mean_lever;
    for (size_t k = 0; k < sample->count; k++)
        sample->s[k] = hypot(sample->s[k], blur);
    scan_over(sample, correction - 2 * reach, correction + 2 * reach, &st, &scan);
    for (size_t k = 0; k < sample->count; k++)
        sample->s[k] = sqrt(sample->s[k] * sample->s[k] - blur * blur);
    return scan.value[scan.best];
}

/* Mean and deviation of the likelihood over [low, high], zooming in until the grid resolves it. */
static void maximise(struct sample *sample, double low, double high, struct radius_correction *correction,
                     double *softness)
{
    struct pair_statistics st = {0};
    struct scan scan;
    double error = median_error(sample);
    scan_over(sample, low, high, &st, &scan);
    if (scan.best == 0 || scan.best == TRIALS - 1) {
        correction->why = "the pile-up of contacts has no lower edge";
        return;
    }
    for (int zoom = 0; zoom < ZOOMS && scan.deviation < RESOLVED * scan.step; zoom++) {
        double middle = scan.low + scan.best * scan.step;
        scan_over(sample, middle - 1.5 * scan.step, middle + 1.5 * scan.step, &st, &scan);
    }
    correction->value = scan.mean;
    correction->error = scan.deviation;
    log_likelihood(sample, correction->value, &st);
    struct pair_odds odds = pair_odds(&st, 0, 0);
    *softness = best_when_blurred(sample, correction->value, UNSHARP * pair_mean_overlap(&st)) - scan.value[scan.best];
    if ((odds.touching + odds.resting) < LEAST_CONTRAST * odds.apart)
        correction->why = "contacts do not pile up against gaps";
    else if (error > BLURRED * pair_mean_overlap(&st) ||
             correction->error * sample->mean_lever > HIDDEN * pair_mean_overlap(&st))
        correction->why = "the errors of the overlaps hide the edge";
    else if (*softness > CLEARLY)
        correction->why = "the overlaps fall off without an edge (elliptic rods, or errors larger than stated)";
    else
        correction->decided = 1;
    if (correction->decided)
        correction->error = hypot(correction->error,
                                  hypot(MODEL_ERROR * pair_mean_overlap(&st), BLUR_ERROR * error) / sample->mean_lever);
}

/* From one reading of the rims; the softness of the edge (infinite: none was found) tells readings apart. */
static int estimate(const struct grains *grains, const struct pairs *pairs, const unsigned char *idle,
                    enum correction_kind kind, int round, struct radius_correction *correction, double *softness)
{
    struct sample sample;
    double mode, width;
    *correction = (struct radius_correction){0};
    *softness = INFINITY;
    if (sample_take(grains, pairs, idle, kind, round, &sample)) {
        sample_free(&sample);
        return -1;
    }
    if (sample.count < LEAST_PAIRS) {
        correction->why = "too few pairs";
    } else {
        find_pile(&sample, &mode, &width);
        sample_cut(&sample, mode - 4 * width);
        maximise(&sample, -mode - width, -mode + 3 * width, correction, softness);
    }
    if (!correction->decided)
        correction->value = correction->error = 0;
    sample_free(&sample);
    return 0;
}

int radius_correction_estimate(const struct grains *grains, const struct pairs *pairs, const unsigned char *idle,
                               enum correction_kind kind, struct radius_correction *correction)
{
    double soft, soft_round;
    struct radius_correction round;
    if (estimate(grains, pairs, idle, kind, 0, correction, &soft))
        return -1;
    if (!grains->shape_c || !grains->shape_s)
        return 0;
    if (estimate(grains, pairs, idle, kind, 1, &round, &soft_round))
        return -1;
    if (round.decided && (!correction->decided || soft_round < soft)) {
        *correction = round;
        correction->unbalanced = soft_round < soft - SHARPER;
    }
    return 0;
}
