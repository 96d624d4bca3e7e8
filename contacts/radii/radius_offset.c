/* The correction c moves every overlap x_p by c lever_p. For a row of trial c the density of pair_statistics.h is
 * fitted to the moved overlaps, and its likelihood L(c), summed over the pairs above the fixed cut, is a profile
 * likelihood. With weights exp(L - L_max) over the grid, mean and standard deviation are the estimate and its error
 * where the model holds; the grid zooms in until it resolves them. Then the error grows by what pairs share (see the
 * header), by the model's own error (from simulations, MODEL_ERROR and the like), and by what other readings of the
 * same overlaps would give.
 *
 * An edge that is as likely when blurred by UNSHARP of the mean overlap is none: nothing is decided then, with the
 * reason. */
#include "contacts/radii/radius_offset.h"

#include <stdlib.h>

#include "pipeline/speak/error.h"

enum { LEAST_PAIRS = 60, TRIALS = 11, ZOOMS = 7, HALVINGS = 5 };
#define UNSHARP 0.4        /* of the mean overlap: an edge is sharper than this, */
#define CLEARLY 12.0       /* in log-likelihood */
#define SHARPER 2.0        /* in log-likelihood: of two readings of the rims */
#define RESOLVED 0.7       /* deviation over step */
#define LEAST_CONTRAST 3.0 /* density of touching over that of apart pairs at zero, below which there is no pile-up */

#define NEAR_GAPS 4.0 /* gaps that are looked at, in mean overlaps beyond the mode of the pile-up; */
#define FAR_GAPS 6.0  /* where the pile-up is as wide as the errors, it has a lower flank to be told from gaps, too */

#define HIDDEN 0.5        /* a zero known no better than to this share of the mean overlap tells nothing, */
#define MODEL_ERROR 0.035 /* of the mean overlap, and */
#define BLUR_ERROR 0.15   /* of the smaller of it and the errors: what the law of the overlaps leaves open; and */
#define GAPS_ERROR 0.05   /* of the errors: what the law of the gaps leaves open; all from simulations */
#define BLURRED 1.2       /* nor do overlaps whose errors are larger than their mean by this factor */
#define DULL 0.33         /* errors larger than this share of the mean overlap may pass for overlaps */
#define WIDER 0.33        /* odds that errors are 1.4 times those stated, before the photo is asked */
#define UNSURE 0.19       /* variance of this choice at least: the laws' shape tells as much of it as the errors */
#define HELD 0.4          /* the loads tell mean overlaps below this share of the errors better than the photo, */
#define LOADED_ERROR 0.2  /* with this relative error: stiffness, lost grains, walls, */
#define UNLIKE 2.0        /* and the factor between the photo's and the loads' that is no longer such an error */

/* What is fitted, and what is known beside the pairs. */
struct task {
    struct overlap_sample sample;
    double loaded; /* m: sum of the overlaps in the sample, from the loads; 0: not known */
    double sum;    /* m: the same where the fit is to hold it; 0: where the photo tells better */
};

static double log_likelihood(struct task *task, double correction, struct pair_statistics *st)
{
    struct overlap_sample *sample = &task->sample;
    double window = -(sample->lowest + correction) * sample->mean_lever;
    if (!(window > 0))
        return -INFINITY;
    overlap_sample_move(sample, correction);
    struct pair_statistics start = *st;
    const struct pair_premises premises = {.window = window * 1.000001, .rests = !(task->sum > 0), .sum = task->sum};
    pair_statistics_fit(sample->x, sample->s, sample->count, &premises, st->pairs ? &start : NULL, st);
    return st->log_likelihood;
}

/* The likelihood on a grid over [low, high]: the best trial, and mean and deviation of what it weighs. */
struct scan {
    double low, step, value[TRIALS];
    int best;
    double mean, deviation;
};

static void scan_over(struct task *task, double low, double high, struct pair_statistics *st, struct scan *scan)
{
    double weight = 0, sum = 0, square = 0;
    *scan = (struct scan){.low = low, .step = (high - low) / (TRIALS - 1)};
    for (int t = 0; t < TRIALS; t++) {
        scan->value[t] = log_likelihood(task, low + t * scan->step, st);
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

/* One level of blur: zooming in until the grid resolves the likelihood. at_end: it has no summit in [low, high]. */
struct reading {
    struct scan scan;
    struct pair_statistics statistics; /* at the mean */
    double blur, log_likelihood;       /* m; at the summit */
    int at_end;
};

static void read_blurred(struct task *task, double blur, double low, double high, struct reading *reading)
{
    struct pair_statistics *st = &reading->statistics;
    struct scan *scan = &reading->scan;
    *reading = (struct reading){.blur = blur};
    overlap_sample_blur(&task->sample, blur);
    scan_over(task, low, high, st, scan);
    reading->at_end = scan->best == 0 || scan->best == TRIALS - 1;
    for (int zoom = 0; !reading->at_end && zoom < ZOOMS && scan->deviation < RESOLVED * scan->step; zoom++) {
        double middle = scan->low + scan->best * scan->step;
        scan_over(task, middle - 1.5 * scan->step, middle + 1.5 * scan->step, st, scan);
    }
    reading->log_likelihood = scan->value[scan->best];
    log_likelihood(task, scan->mean, st);
}

/* The greatest likelihood near a correction when every overlap had this much more error. */
static double best_when_blurred(struct task *task, double correction, double blur)
{
    struct pair_statistics st = {0};
    struct scan scan;
    double reach = blur / task->sample.mean_lever;
    overlap_sample_blur(&task->sample, blur);
    scan_over(task, correction - 2 * reach, correction + 2 * reach, &st, &scan);
    return scan.value[scan.best];
}

/* How much larger the deviation is than of independent pairs (radius_offset.h). */
static int shared_errors(struct task *task, const struct reading *reading, double *factor)
{
    const struct overlap_sample *sample = &task->sample;
    double *of_grain = calloc(sample->grains + 1, sizeof *of_grain),
           *of_pair = calloc(sample->count + 1, sizeof(double));
    double alone = 0, together = 0;
    *factor = 1;
    for (int side = -1; of_grain && of_pair && side <= 1; side += 2) {
        struct pair_statistics st = reading->statistics;
        log_likelihood(task, reading->scan.mean + side * reading->scan.deviation, &st);
        for (size_t k = 0; k < sample->count; k++)
            of_pair[k] += side * pair_odds(&st, sample->x[k], sample->s[k]).log_density;
    }
    for (size_t k = 0; of_grain && of_pair && k < sample->count; k++) {
        of_grain[sample->pair[k].i] += of_pair[k];
        of_grain[sample->pair[k].j] += of_pair[k];
        alone += of_pair[k] * of_pair[k];
    }
    for (size_t g = 0; of_grain && g < sample->grains; g++)
        together += of_grain[g] * of_grain[g];
    if (alone > 0)
        *factor = sqrt(fmax(1, together / alone - 1)); /* every pair is in the sums of two grains */
    int status = of_grain && of_pair ? 0 : error_memory("scores of the pairs");
    free(of_grain);
    free(of_pair);
    return status;
}

/* The most likely blur at this correction: from coarse steps, halved around the best one. */
static double likely_blur(struct task *task, double correction)
{
    double step = 2 * task->sample.error, blur = step, highest = -INFINITY;
    struct pair_statistics st = {0};
    for (int half = 0; half <= HALVINGS; half++, step /= 2) {
        double middle = blur;
        for (int side = -1; side <= 1; side++) {
            double trial = fabs(middle + side * step);
            overlap_sample_blur(&task->sample, trial);
            double value = log_likelihood(task, correction, &st);
            blur = value > highest ? trial : blur;
            highest = fmax(value, highest);
        }
    }
    return blur;
}

/* Where the sum of the overlaps is known, the width of the pile-up tells the errors and its middle the zero: one after
 * the other, from the mode on. */
static void read_loaded(struct task *task, double mode, double width, struct reading *reading)
{
    double at = -mode;
    for (int round = 0; round < 2; round++) {
        read_blurred(task, likely_blur(task, at), at - 2 * width, at + 2 * width, reading);
        at = reading->scan.mean;
    }
}

/* The mean overlap is that of the loads. */
static void judge_loaded(const struct overlap_sample *sample, struct radius_correction *correction)
{
    double lever = sample->mean_lever, spread = hypot(sample->error, correction->blur);
    correction->error =
        hypot(correction->error, hypot(LOADED_ERROR * correction->overlap, GAPS_ERROR * spread) / lever);
    correction->decided = 1;
    if (correction->error * lever > correction->overlap)
        correction->doubt = "under these loads the overlaps are smaller than what their zero is known to";
}

/* Errors may be 1.4 times those stated (WIDER: how far that is believed): the distance of both readings is an error,
 * and where the edge is hidden, their mean is the value. */
static void doubt_errors(struct task *task, const struct reading *stated, int hidden,
                         struct radius_correction *correction)
{
    struct reading wider;
    double reach = pair_mean_overlap(&stated->statistics) / task->sample.mean_lever;
    read_blurred(task, task->sample.error, correction->value - 2 * reach, correction->value + 2 * reach, &wider);
    double odds = WIDER * exp(fmin(wider.log_likelihood - stated->log_likelihood, 30)), share = odds / (1 + odds);
    double apart = wider.scan.mean - correction->value;
    correction->value += hidden ? share * apart : 0;
    correction->error = hypot(correction->error, sqrt(fmax(share * (1 - share), UNSURE)) * apart);
}

/* Without the loads, or where errors are smaller than the overlaps that they give: the edge tells the zero. */
static void judge_edge(struct task *task, const struct reading *reading, double softness,
                       struct radius_correction *correction)
{
    const struct overlap_sample *sample = &task->sample;
    double lever = sample->mean_lever, mean = pair_mean_overlap(&reading->statistics), error = sample->error;
    int hidden = error > BLURRED * mean || correction->error * lever > HIDDEN * mean;
    if (!hidden && softness > CLEARLY) {
        correction->why = "the overlaps fall off without an edge (elliptic rods, or errors larger than stated)";
        return;
    }
    correction->decided = 1;
    correction->error =
        hypot(correction->error, hypot(MODEL_ERROR * mean, BLUR_ERROR * error * mean / hypot(error, mean)) / lever);
    if (error > DULL * mean)
        doubt_errors(task, reading, hidden, correction);
    double unlike = correction->loaded > 0 ? fabs(log(mean / correction->loaded)) : 0;
    if (hidden)
        correction->doubt = "the errors of the overlaps hide the edge";
    else if (unlike > log(UNLIKE))
        correction->doubt = "the overlaps are not those that the loads give: check kn, scale and loads";
}

/* softness: infinite where no edge was found. */
static int maximise(struct task *task, double mode, double width, struct radius_correction *correction,
                    double *softness)
{
    struct reading reading;
    double factor, mean;
    if (task->sum > 0)
        read_loaded(task, mode, width, &reading);
    else
        read_blurred(task, 0, -mode - width, -mode + 3 * width, &reading);
    if (reading.at_end) {
        correction->why = "the pile-up of contacts has no lower edge";
        return 0;
    }
    if (shared_errors(task, &reading, &factor))
        return -1;
    correction->value = reading.scan.mean;
    correction->error = factor * reading.scan.deviation;
    correction->overlap = mean = pair_mean_overlap(&reading.statistics);
    correction->loaded = task->loaded / (reading.statistics.touching * (double)reading.statistics.pairs);
    correction->blur = reading.blur;
    if (!(task->sum > 0))
        *softness = best_when_blurred(task, reading.scan.mean, UNSHARP * mean) - reading.scan.value[reading.scan.best];
    double spread = task->sum > 0 ? hypot(task->sample.error, reading.blur) : 0;
    struct pair_odds odds = pair_odds(&reading.statistics, 0, spread);
    if (odds.touching + odds.resting < LEAST_CONTRAST * odds.apart)
        correction->why = "contacts do not pile up against gaps";
    else if (task->sum > 0)
        judge_loaded(&task->sample, correction);
    else
        judge_edge(task, &reading, *softness, correction);
    return 0;
}

/* From one reading of the rims; the softness of the edge (infinite: none was found) tells readings apart. */
static int estimate(const struct grains *grains, const struct pairs *pairs, const struct overlap_choice *choice,
                    int round, double loaded, struct radius_correction *correction, double *softness)
{
    struct task task = {0};
    double mode, width;
    int status = overlap_sample_take(grains, pairs, choice, round, &task.sample);
    *correction = (struct radius_correction){0};
    *softness = INFINITY;
    if (status == 0 && task.sample.count < LEAST_PAIRS) {
        correction->why = "too few pairs";
    } else if (status == 0) {
        overlap_sample_pile(&task.sample, &mode, &width);
        overlap_sample_cut(&task.sample, mode - FAR_GAPS * width);
        task.loaded = loaded * task.sample.share / task.sample.mean_branch;
        task.sum = task.loaded < HELD * task.sample.error * (double)task.sample.count ? task.loaded : 0;
        if (!(task.sum > 0))
            overlap_sample_cut(&task.sample, mode - NEAR_GAPS * width);
        status = maximise(&task, mode, width, correction, softness);
    }
    if (!correction->decided)
        correction->value = correction->error = 0;
    overlap_sample_free(&task.sample);
    return status;
}

int radius_correction_estimate(const struct grains *grains, const struct pairs *pairs,
                               const struct overlap_choice *choice, double loaded, struct radius_correction *correction)
{
    double soft, soft_round;
    struct radius_correction round;
    if (estimate(grains, pairs, choice, 0, loaded, correction, &soft))
        return -1;
    if (!grains->shape_c || !grains->shape_s)
        return 0;
    if (estimate(grains, pairs, choice, 1, loaded, &round, &soft_round))
        return -1;
    if (round.decided && (!correction->decided || (!round.doubt && soft_round < soft))) {
        *correction = round;
        correction->unbalanced = soft_round < soft - SHARPER;
    }
    return 0;
}
