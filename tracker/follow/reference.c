/* What is kept of the reference: the targets (paper, markers, grains), which other rims reach into each, who is near
 * whom, and the grey value at which the sensor clips. Subsets are built when they are first asked for (target_keep). */
#include <math.h>
#include <omp.h>
#include <stdlib.h>

#include "pipeline/speak/error.h"
#include "tracker/follow/follow.h"
#include "tracker/follow/track_grains.h"
#include "tracker/search/neighbours.h"
#include "pipeline/numbers/simd.h"

SIMD_CLONES static uint16_t largest_of(const uint16_t *grey, size_t n)
{
    uint16_t largest = 0;
    for (size_t k = 0; k < n; k++)
        largest = grey[k] > largest ? grey[k] : largest;
    return largest;
}

SIMD_CLONES static size_t count_of(const uint16_t *grey, size_t n, uint16_t value)
{
    size_t count = 0;
    for (size_t k = 0; k < n; k++)
        count += grey[k] == value;
    return count;
}

/* The grey value at which the sensor clips: the largest one, when far more pixels hold it than chance would put there.
 * 0: none. */
static uint16_t saturation_of(const struct photo *photo)
{
    /* A grey value in the upper half of the range; one pixel in 100000 may have it by chance. */
    size_t n = (size_t)photo->width * (size_t)photo->height;
    uint16_t largest = largest_of(photo->pixels, n);
    unsigned range = photo->bits == 8 ? 255 : 65535;
    return largest > range / 2 && count_of(photo->pixels, n, largest) > 16 + n / 100000 ? largest : 0;
}

static struct target grain_target(const struct photo_grains *grains, size_t k, double subset)
{
    struct target target = {
        .shape = {.cx = grains->x_px[k], .cy = grains->y_px[k], .radius = subset * grains->radius_px[k]}};
    target.given = isfinite(target.shape.cx) && isfinite(target.shape.cy) && target.shape.radius > 0 &&
                   fabs(target.shape.cx) < 1e6 && fabs(target.shape.cy) < 1e6 && target.shape.radius < 1e4;
    return target;
}

static struct target rect_target(const struct rect *rect)
{
    double w = (rect->x1 - rect->x0) / 2, h = (rect->y1 - rect->y0) / 2;
    return (struct target){
        .shape = {.cx = rect->x0 + w, .cy = rect->y0 + h, .radius = hypot(w, h), .half_w = w, .half_h = h},
        .given = w > 0 && h > 0};
}

/* Quarter `k` of a piece of paper. */
static struct target quarter_target(const struct rect *rect, int k)
{
    double mx = (rect->x0 + rect->x1) / 2, my = (rect->y0 + rect->y1) / 2;
    return rect_target(&(struct rect){k % 2 ? mx + 0.5 : rect->x0, k / 2 ? my + 0.5 : rect->y0,
                                      k % 2 ? rect->x1 : mx - 0.5, k / 2 ? rect->y1 : my - 0.5});
}

/* Rims that reach into a grain's subset, with a margin for the slopes and the point spread: they move with their own
 * grain. */
static void find_intruders(struct tracker *tracker)
{
    const double margin = 3; /* px */
    const size_t base = tracker->patch_count;
    for (size_t k = 0; k < tracker->grains->count; k++) {
        struct target *target = &tracker->targets[base + k];
        for (int i = 0; target->given && i < NEIGHBOURS && tracker->nearest[k * NEIGHBOURS + (size_t)i] >= 0; i++) {
            size_t other = (size_t)tracker->nearest[k * NEIGHBOURS + (size_t)i];
            struct shape rim = {.cx = tracker->grains->x_px[other],
                                .cy = tracker->grains->y_px[other],
                                .radius = tracker->grains->radius_px[other] + margin};
            double away = hypot(rim.cx - target->shape.cx, rim.cy - target->shape.cy);
            if (away < rim.radius + target->shape.radius)
                target->neighbours[target->neighbour_count++] = rim;
        }
    }
}

static int make_targets(struct tracker *tracker)
{
    const struct tracker_options *options = &tracker->options;
    tracker->first_quarter = options->drift_count + options->marker_count;
    tracker->patch_count = tracker->first_quarter + (options->drift_count == 1 ? QUARTERS : 0);
    tracker->count = tracker->patch_count + tracker->grains->count;
    tracker->targets = calloc(tracker->count ? tracker->count : 1, sizeof *tracker->targets);
    if (!tracker->targets)
        return error_memory("the grains to follow");
    for (size_t k = 0; k < options->drift_count; k++)
        tracker->targets[k] = rect_target(&options->drift[k]);
    for (size_t k = 0; k < options->marker_count; k++)
        tracker->targets[options->drift_count + k] = rect_target(&options->markers[k].rect);
    for (size_t k = tracker->first_quarter; k < tracker->patch_count; k++)
        tracker->targets[k] = quarter_target(&options->drift[0], (int)(k - tracker->first_quarter));
    for (size_t k = 0; k < tracker->grains->count; k++)
        tracker->targets[tracker->patch_count + k] = grain_target(tracker->grains, k, options->subset);
    tracker->nearest = neighbours_find(tracker->targets + tracker->patch_count, tracker->grains->count);
    if (!tracker->nearest)
        return -1;
    find_intruders(tracker);
    return 0;
}

struct tracker *tracker_open(const struct photo *reference, const struct photo_grains *grains,
                             const struct tracker_options *options)
{
    struct tracker *tracker = calloc(1, sizeof *tracker);
    if (!tracker) {
        error_set(EXIT_FAILED, "out of memory: tracker: use a machine with more memory");
        return NULL;
    }
    tracker->reference = reference;
    tracker->grains = grains;
    tracker->options = *options;
    tracker->saturation = saturation_of(reference);
    tracker->threads = omp_get_max_threads();
    tracker->workspaces = calloc((size_t)tracker->threads, sizeof *tracker->workspaces);
    if (!tracker->workspaces || make_targets(tracker)) {
        error_set(EXIT_FAILED, "out of memory: tracker: use a machine with more memory");
        tracker_close(tracker);
        return NULL;
    }
    return tracker;
}

void tracker_close(struct tracker *tracker)
{
    if (!tracker)
        return;
    for (size_t k = 0; tracker->targets && k < tracker->count; k++)
        subset_free(&tracker->targets[k].subset);
    for (int k = 0; tracker->workspaces && k < tracker->threads; k++)
        search_workspace_free(&tracker->workspaces[k]);
    pyramid_free(&tracker->reference_pyramid);
    free(tracker->targets);
    free(tracker->workspaces);
    free(tracker->nearest);
    free(tracker);
}
