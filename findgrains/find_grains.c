#include "findgrains/find_grains.h"

#include "findgrains/detect.h"
#include "findgrains/refine_all.h"
#include "pipeline/error.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define LEAST_SUPPORT 0.25 /* of a rim after its refinement: less is not a grain */
#define WEAK_SUPPORT 0.40  /* less is flagged */
#define LEAST_STEP 0.15    /* of the contrast: a sector with less has no edge */
#define FIRST_BLUR 1.0     /* px, before it is estimated */
#define FIRST_NOISE 0.03   /* of the contrast, before it is estimated */
#define VOID_SPREAD 0.25   /* of the contrast: how far the void's level may be from its median */
#define SECTOR 3.0         /* px along the rim */
#define STILL 0.004        /* px of the last step: far below any standard error */
#define ROUNDS 10
#define CUT_DEPTH 1.5 /* px that a rim may lie beyond the frame before the grain counts as cut */

static int radius_range(const struct find_options *options, const struct zone *zone, double range[2])
{
    double smaller = fmin(zone->x1 - zone->x0, zone->y1 - zone->y0);
    range[0] = options->radius_min_px > 0 ? options->radius_min_px : fmax(5, smaller / 100);
    range[1] = options->radius_max_px > 0 ? options->radius_max_px : fmin(0.25 * smaller, 40 * range[0]);
    if (!(range[1] > range[0]))
        range[1] = range[0] * 1.1;
    return 0;
}

/* Keep the rims that the refinement confirmed, best first, none over another. */
static int keep_supported(struct rims *rims)
{
    struct candidates list = {0};
    int status = 0;
    for (size_t k = 0; k < rims->count && !status; k++) {
        struct candidate item = {.rim = rims->items[k].rim, .support = rims->items[k].support};
        if (item.support >= LEAST_SUPPORT)
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
        if (!(item->s_shape > 0) || item->support < WEAK_SUPPORT)
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

static int refine(const struct photo *photo, const struct zone *zone, enum find_shape shape, struct rims_state *state,
                  struct rims *rims)
{
    state->ellipse = shape != FIND_SHAPE_CIRCLE;
    if (rims_approach(photo, zone, state, rims) || keep_supported(rims) || rims_estimate_blur(photo, zone, state, rims))
        return -1;
    state->window = 2.5 * state->blur;
    if (iterate(photo, zone, state, rims, ROUNDS))
        return -1;
    if (shape == FIND_SHAPE_AUTO && !ellipses_show(rims, rims_correlation(rims))) {
        state->ellipse = 0;
        forget_shapes(rims);
    }
    if (rims_choose_window(photo, zone, state, rims) || keep_supported(rims) ||
        iterate(photo, zone, state, rims, ROUNDS))
        return -1;
    state->correlation = rims_correlation(rims);
    return 0;
}

static uint32_t flags_of(const struct zone *zone, const struct refined *item)
{
    uint32_t flags = 0;
    double x = item->rim.x, y = item->rim.y, r = item->rim.radius;
    if (zone_photo_depth(zone, x, y) < r || zone_depth(zone, x, y) < r - fmax(CUT_DEPTH, 0.03 * r))
        flags |= GRAIN_CUT;
    if (item->support < WEAK_SUPPORT)
        flags |= GRAIN_WEAK_EDGE;
    if (!(item->moved < fmax(0.02, item->s_radius)))
        flags |= GRAIN_NOT_CONVERGED;
    if (!(item->s_radius > 0))
        flags |= GRAIN_NO_CONTRAST;
    return flags;
}

static int reading_order(const void *left, const void *right)
{
    const struct refined *a = left, *b = right;
    int order = (a->rim.y > b->rim.y) - (a->rim.y < b->rim.y);
    return order ? order : (a->rim.x > b->rim.x) - (a->rim.x < b->rim.x);
}

static int fill_table(const struct zone *zone, const struct rims_state *state, struct rims *rims,
                      struct photo_grains *grains)
{
    static const char *const circle[] = {"x_px", "y_px", "radius_px", "s_x", "s_y", "s_radius", "flags", NULL};
    static const char *const shape[] = {"shape_c", "shape_s", "s_shape"};
    if (table_alloc(&PHOTO_GRAINS, grains, rims->count, circle))
        return -1;
    for (int k = 0; state->ellipse && k < 3; k++)
        if (table_add(&PHOTO_GRAINS, grains, shape[k])) {
            table_free(&PHOTO_GRAINS, grains);
            return -1;
        }
    if (rims->count)
        qsort(rims->items, rims->count, sizeof *rims->items, reading_order);
    for (size_t k = 0; k < rims->count; k++) {
        const struct refined *item = &rims->items[k];
        grains->x_px[k] = item->rim.x;
        grains->y_px[k] = item->rim.y;
        grains->radius_px[k] = item->rim.radius;
        grains->s_x[k] = item->s_x * state->correlation;
        grains->s_y[k] = item->s_y * state->correlation;
        grains->s_radius[k] = item->s_radius * state->correlation;
        if (state->ellipse) {
            grains->shape_c[k] = item->rim.c2;
            grains->shape_s[k] = -item->rim.s2; /* y down to counter-clockwise as seen */
            grains->s_shape[k] = item->s_shape * state->correlation;
        }
        grains->flags[k] = flags_of(zone, item);
    }
    return 0;
}

static double median_noise(const struct rims *rims)
{
    double sum = 0, count = 0;
    for (size_t k = 0; k < rims->count; k++)
        if (rims->items[k].support > 0) {
            sum += rims->items[k].noise;
            count += 1;
        }
    return count > 0 ? sum / count : NAN;
}

static int no_grain(const char *why)
{
    return error_input("no grain found: %s: check the photo, grains.radius_px and frame.corners_px of the scene", why);
}

int find_grains(const struct photo *photo, const struct find_options *options, struct photo_grains *grains,
                struct find_notes *notes)
{
    struct find_notes own = {0};
    struct candidates found = {0};
    struct rims rims = {0};
    double range[2];
    int status = -1;
    if (!notes)
        notes = &own;
    *notes = own;
    if (zone_make(photo->width, photo->height, options->has_frame ? options->corners_px : NULL,
                  options->corner_radius_px, &notes->zone) ||
        threshold_find(photo, &notes->zone, &notes->levels) || radius_range(options, &notes->zone, range))
        return -1;
    double contrast = notes->levels.grain_level - notes->levels.void_level;
    if (!(contrast > 0))
        return no_grain("the photo has one grey level only");
    struct rims_state state = {.blur = FIRST_BLUR,
                               .window = 2.5 * FIRST_BLUR,
                               .sector = SECTOR,
                               .least_step = LEAST_STEP * contrast,
                               .void_level = notes->levels.void_level,
                               .void_spread = VOID_SPREAD * contrast,
                               .noise = FIRST_NOISE * contrast,
                               .correlation = 1};
    if (detect_grains(photo, &notes->zone, &notes->levels, range[0], range[1], &found, &notes->candidates))
        goto done;
    notes->captured = found.count;
    if (rims_make(&found, &rims) || refine(photo, &notes->zone, options->shape, &state, &rims))
        goto done;
    if (rims.count == 0) {
        status = no_grain("no bright disc with an edge around it");
        goto done;
    }
    notes->radius_min_px = range[0];
    notes->radius_max_px = range[1];
    notes->blur_px = state.blur;
    notes->noise = median_noise(&rims);
    notes->window_px = state.window;
    notes->correlation = state.correlation;
    notes->texture = state.texture;
    notes->ellipses = state.ellipse;
    status = fill_table(&notes->zone, &state, &rims, grains);
done:
    candidates_free(&found);
    rims_free(&rims);
    return status;
}

size_t find_count_flagged(const struct photo_grains *grains)
{
    size_t count = 0;
    for (size_t k = 0; k < grains->count; k++)
        count += (grains->flags[k] & GRAIN_DISTRUST) != 0;
    return count;
}
