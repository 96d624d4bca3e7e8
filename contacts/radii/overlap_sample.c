/* What the likelihood of radius_offset.h is asked of: of more than MAX_PAIRS pairs every n-th is taken, between grains
 * that can be squeezed and are trusted. With shapes, a pair's overlap as circles is that of the rims less what their
 * second harmonics add along the branch. */
#include "contacts/radii/overlap_sample.h"

#include <stdlib.h>

#include "pipeline/speak/error.h"
#include "pipeline/numbers/quantiles.h"

enum { MAX_PAIRS = 20000 };

void overlap_sample_free(struct overlap_sample *sample)
{
    free(sample->pair);
    free(sample->x);
    free(sample->s);
    *sample = (struct overlap_sample){0};
}

static int is_chosen(const struct overlap_choice *choice, const struct pair *pair)
{
    return pair->overlap >= -choice->farthest && !(choice->idle && (choice->idle[pair->i] || choice->idle[pair->j]));
}

static int is_trusted(const struct grains *grains, const struct pair *pair)
{
    return !((grains->flags[pair->i] | grains->flags[pair->j]) & GRAIN_DISTRUST);
}

/* What the shapes add to an overlap, and to its variance. */
static double shape_overlap(const struct grains *grains, const struct pair *pair, double *variance)
{
    double si = column_or_zero(grains->s_shape, pair->i), sj = column_or_zero(grains->s_shape, pair->j);
    *variance = si * si + sj * sj;
    return rim_radius(grains, pair->i, pair->n) - grains->radius[pair->i] + rim_radius(grains, pair->j, pair->n) -
           grains->radius[pair->j];
}

static struct overlap_pair overlap_pair(const struct grains *grains, const struct pair *pair, enum correction_kind kind,
                                        int round)
{
    double radii = grains->radius[pair->i] + grains->radius[pair->j];
    double variance = 0, shape = round ? shape_overlap(grains, pair, &variance) : 0;
    return (struct overlap_pair){.i = (size_t)pair->i,
                                 .j = (size_t)pair->j,
                                 .x = pair->overlap - shape,
                                 .s = sqrt(fmax(pair->s_overlap * pair->s_overlap - variance, 0)),
                                 .branch = radii - pair->overlap,
                                 .lever = kind == CORRECT_OFFSET ? 2 : radii};
}

int overlap_sample_take(const struct grains *grains, const struct pairs *pairs, const struct overlap_choice *choice,
                        int round, struct overlap_sample *sample)
{
    size_t chosen = 0, kept = 0;
    for (size_t p = 0; p < pairs->count; p++)
        chosen += is_chosen(choice, &pairs->pair[p]);
    size_t stride = chosen / MAX_PAIRS + 1, room = chosen / stride + 2;
    *sample = (struct overlap_sample){.pair = malloc(room * sizeof *sample->pair),
                                      .x = malloc(room * sizeof(double)),
                                      .s = malloc(room * sizeof(double)),
                                      .grains = grains->count};
    if (!sample->pair || !sample->x || !sample->s)
        return error_memory("overlaps");
    for (size_t p = 0, c = 0; p < pairs->count; p++) {
        const struct pair *pair = &pairs->pair[p];
        if (is_chosen(choice, pair) && c++ % stride == 0 && is_trusted(grains, pair))
            sample->pair[kept++] = overlap_pair(grains, pair, choice->kind, round);
    }
    sample->count = kept;
    sample->share = (double)kept / (double)(chosen ? chosen : 1);
    return 0;
}

/* The densest stretch that holds this share of all values: a mode that needs no width of a bin. */
static double densest(const double *sorted, size_t count, double share)
{
    size_t k = (size_t)(share * (double)count), best = 0;
    for (size_t a = 0; a + k < count; a++)
        if (sorted[a + k] - sorted[a] < sorted[best + k] - sorted[best])
            best = a;
    return 0.5 * (sorted[best] + sorted[best + k]);
}

void overlap_sample_pile(struct overlap_sample *sample, double *mode, double *width)
{
    double *y = sample->x, sum = 0, beyond = 0;
    for (size_t k = 0; k < sample->count; k++)
        y[k] = sample->pair[k].x / sample->pair[k].lever;
    sort_values(y, sample->count);
    *mode = densest(y, sample->count, 0.2);
    for (size_t k = 0; k < sample->count; k++)
        if (y[k] > *mode) {
            sum += y[k] - *mode;
            beyond++;
        }
    *width = beyond > 0 ? sum / beyond : 0;
}

static double median_error(struct overlap_sample *sample)
{
    for (size_t k = 0; k < sample->count; k++)
        sample->s[k] = sample->pair[k].s;
    return sample->count ? median_of(sample->s, sample->count) : 0;
}

void overlap_sample_cut(struct overlap_sample *sample, double lowest)
{
    size_t kept = 0;
    double lever = 0, branch = 0;
    for (size_t k = 0; k < sample->count; k++)
        if (sample->pair[k].x / sample->pair[k].lever >= lowest) {
            sample->pair[kept++] = sample->pair[k];
            lever += sample->pair[k].lever;
            branch += sample->pair[k].branch;
        }
    sample->count = kept;
    sample->lowest = lowest;
    sample->mean_lever = lever / (double)(kept ? kept : 1);
    sample->mean_branch = branch / (double)(kept ? kept : 1);
    sample->error = median_error(sample);
    overlap_sample_blur(sample, 0);
}

void overlap_sample_move(struct overlap_sample *sample, double correction)
{
    for (size_t k = 0; k < sample->count; k++)
        sample->x[k] = sample->pair[k].x + correction * sample->pair[k].lever;
}

void overlap_sample_blur(struct overlap_sample *sample, double blur)
{
    for (size_t k = 0; k < sample->count; k++)
        sample->s[k] = hypot(sample->pair[k].s, blur);
}
