#include "findgrains/measure.h"

#include "findgrains/detect.h"

#include <math.h>

#define SURE 0.5    /* support at the capture that keeps a row whose fine fit failed */
#define STILL 0.004 /* px of the last step: far below any standard error */
#define ROUNDS 10

/* The rims that are to be kept, best first, none over another. */
static int keep_supported(struct rims *rims)
{
    struct candidates list = {0};
    int status = 0;
    for (size_t k = 0; k < rims->count && !status; k++) {
        struct candidate item = rims->origin[k];
        int measured = rims->items[k].support >= MEASURE_LEAST_SUPPORT;
        item.rim = measured ? rims->items[k].rim : item.captured;
        item.support = (measured ? rims->items[k].support : 0) + item.by_hand;
        if (measured || item.by_hand || item.sure >= SURE)
            status = candidates_add(&list, &item);
    }
    candidates_thin(&list, DETECT_OVERLAP);
    rims_free(rims);
    if (!status)
        status = rims_make(&list, rims);
    candidates_free(&list);
    return status;
}

/* Ellipses pay when the second harmonics of the rims exceed their standard errors all over the photo. */
static int ellipses_show(const struct rims *rims, double correlation)
{
    double sum = 0, count = 0;
    for (size_t k = 0; k < rims->count; k++) {
        const struct refined *item = &rims->items[k];
        if (!(item->s_shape > 0) || item->support < MEASURE_WEAK_SUPPORT)
            continue;
        double size2 = item->rim.c2 * item->rim.c2 + item->rim.s2 * item->rim.s2;
        double s = item->s_shape * correlation;
        sum += fmin(9, size2 / (2 * s * s));
        count += 1;
    }
    return count > 0 && sum / count > 1.5;
}

static void forget_shapes(struct rims *rims)
{
    for (size_t k = 0; k < rims->count; k++)
        rims->items[k].rim.c2 = rims->items[k].rim.s2 = 0;
}

/* At least once, at most `most` times, until 98 % of the rims stand still. */
static int iterate(const struct photo *photo, const struct zone *zone, const struct rims_state *state,
                   struct rims *rims, int most)
{
    for (int k = 0; k < most; k++) {
        if (rims_iterate(photo, zone, state, rims))
            return -1;
        size_t moving = 0;
        for (size_t j = 0; j < rims->count; j++)
            moving += rims->items[j].moved > STILL;
        if (moving * 50 <= rims->count)
            break;
    }
    return 0;
}

int measure_rims(const struct photo *photo, const struct zone *zone, enum find_shape shape, int keep_all,
                 struct rims_state *state, struct rims *rims)
{
    state->ellipse = shape != FIND_SHAPE_CIRCLE;
    if (rims_approach(photo, zone, state, rims) || (!keep_all && keep_supported(rims)) ||
        rims_estimate_blur(photo, zone, state, rims))
        return -1;
    state->window = 2.5 * state->blur;
    if (iterate(photo, zone, state, rims, ROUNDS))
        return -1;
    if (shape == FIND_SHAPE_AUTO && !ellipses_show(rims, rims_correlation(rims))) {
        state->ellipse = 0;
        forget_shapes(rims);
    }
    if (rims_choose_window(photo, zone, state, rims) || (!keep_all && keep_supported(rims)) ||
        iterate(photo, zone, state, rims, ROUNDS))
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
