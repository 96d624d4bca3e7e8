/* The order matters: a blur that is a guess makes wrong steps, a place that is a guess makes a wrong blur. So a sample
 * approaches with small steps, tells the blur, then circles or ellipses, texture and band, then the blur again, now
 * that texture is known to widen edges; only then all rims are fitted.
 *
 * Circles or ellipses: for circles the fitted second harmonics over their errors have a mean square of 1; where the
 * sample's exceeds ELLIPSES_SHOW the rods are not round and all are fitted with shapes. */
#include "findgrains/rims/measure.h"

#include "findgrains/capture/detect.h"

#include <math.h>

#define SURE 0.5 /* support at the capture that keeps a row whose fine fit failed */
#define ROUNDS 10
#define ELLIPSES_SHOW 1.5 /* mean square of shapes over standard errors: 1 for circles */

/* The rims that are to be kept, best first, none over another. */
static int keep_supported(struct rims *rims)
{
    struct candidates list = {0};
    int status = 0;
    for (size_t k = 0; k < rims->count && !status; k++) {
        struct candidate item = rims->origin[k];
        int measured = rims->items[k].support >= MEASURE_LEAST_SUPPORT;
        item.rim = measured ? rims->items[k].rim : item.captured;
        item.support = 0.5 * (item.sure + (measured ? rims->items[k].support : 0)) + item.by_hand;
        if (measured || item.by_hand || item.sure >= SURE)
            status = candidates_add(&list, &item);
    }
    if (!status)
        status = candidates_thin(&list, DETECT_OVERLAP, candidates_merit);
    rims_free(rims);
    if (!status)
        status = rims_make(&list, rims);
    candidates_free(&list);
    return status;
}

/* Ellipses pay when the second harmonics of the rims exceed their standard errors all over the photo. */
static int ellipses_show(const struct rims *rims, struct rows rows, double correlation)
{
    double sum = 0, count = 0;
    for (size_t at = 0; at < rows.count; at++) {
        const struct refined *item = &rims->items[rows.list[at]];
        if (!(item->s_shape > 0) || item->support < MEASURE_WEAK_SUPPORT)
            continue;
        double size2 = item->rim.c2 * item->rim.c2 + item->rim.s2 * item->rim.s2;
        double s = item->s_shape * correlation;
        sum += fmin(9, size2 / (2 * s * s));
        count += 1;
    }
    return count > 0 && sum / count > ELLIPSES_SHOW;
}

static void forget_shapes(struct rims *rims)
{
    for (size_t k = 0; k < rims->count; k++)
        rims->items[k].rim.c2 = rims->items[k].rim.s2 = 0;
}

/* What a sample of the rims tells about the photo: blur, circles or ellipses, texture and band. */
static int learn(const struct photo *photo, const struct zone *zone, enum find_shape shape, struct rims_state *state,
                 struct rims *rims)
{
    size_t list[RIMS_SAMPLE];
    struct rows sample;
    state->ellipse = shape != FIND_SHAPE_CIRCLE;
    if (rims_sample(rims, list, &sample) || rims_approach(photo, zone, state, 0, rims, sample) ||
        rims_estimate_blur(photo, zone, state, rims, sample))
        return -1;
    state->window = 2.5 * state->blur;
    if (rims_iterate(photo, zone, state, ROUNDS, rims, sample))
        return -1;
    if (shape == FIND_SHAPE_AUTO && !ellipses_show(rims, sample, rims_correlation(rims))) {
        state->ellipse = 0;
        forget_shapes(rims);
    }
    if (rims_choose_window(photo, zone, state, rims, sample))
        return -1;
    /* Specks widen edges: once their size is known, the blur proper. */
    double band = state->window / state->blur;
    if (state->texture > 0 && rims_estimate_blur(photo, zone, state, rims, sample))
        return -1;
    state->window = band * state->blur;
    return 0;
}

int measure_rims(const struct photo *photo, const struct zone *zone, enum find_shape shape, int keep_all,
                 struct rims_state *state, struct rims *rims)
{
    if (learn(photo, zone, shape, state, rims) || rims_approach(photo, zone, state, 1, rims, rims_all(rims)) ||
        (!keep_all && keep_supported(rims)) || rims_iterate(photo, zone, state, ROUNDS, rims, rims_all(rims)))
        return -1;
    state->correlation = rims_correlation(rims);
    return 0;
}

size_t measure_count(const struct rims *rims)
{
    size_t count = 0;
    for (size_t k = 0; k < rims->count; k++)
        count += rims->items[k].support >= MEASURE_LEAST_SUPPORT;
    return count;
}
