#include "findgrains/detect.h"

#include "findgrains/candidates.h"
#include "findgrains/capture.h"
#include "findgrains/level.h"
#include "pipeline/error.h"

#include <math.h>
#include <stdlib.h>

#define VOTE_RADIUS 7.0 /* level pixels of an octave's smallest radius while voting */
#define FINEST 6.0      /* level pixels of the smallest radius when the photo has to be magnified */
#define MARGIN 1.06     /* radii this much outside the range are looked for as well */
#define SAME_PLACE 0.08 /* of R_i + R_j: peaks of the votes nearer than this lead to the same capture */
#define LEAST_SUPPORT 0.30
#define LEAST_GREY 0.2 /* of the contrast: a grain is at least that much brighter than the voids */
#define MOST_ONE_SIDED 0.72

struct octave {
    struct level fine, coarse; /* of capture; of votes */
    int factor;                /* coarse pixels per fine pixel */
};

static int make_octave(const struct photo *photo, const struct zone *zone, double low, double outside,
                       struct octave *octave)
{
    double scale = fmax(low / (2 * VOTE_RADIUS), fmin(1, low / FINEST));
    if (level_make(photo, zone, scale, outside, &octave->fine))
        return -1;
    octave->factor = low / octave->fine.scale >= 1.9 * VOTE_RADIUS ? 2 : 1;
    return level_shrink(&octave->fine, octave->factor, &octave->coarse);
}

static struct rim to_fine(const struct octave *octave, const struct rim *rim)
{
    double f = octave->factor, shift = 0.5 * (f - 1);
    return (struct rim){.x = f * rim->x + shift, .y = f * rim->y + shift, .radius = f * rim->radius};
}

static void to_photo(const struct level *level, struct candidate *item)
{
    item->rim.x = level->x0 + item->rim.x * level->scale;
    item->rim.y = level->y0 + item->rim.y * level->scale;
    item->rim.radius *= level->scale;
    item->spread *= level->scale;
}

/* Capture every peak; those that hold replace them. */
static void capture_peaks(const struct octave *octave, const struct grey_levels *levels, double low, double high,
                          struct candidates *peaks)
{
    double least = LEAST_GREY * (levels->grain_level - levels->void_level);
#pragma omp parallel for schedule(dynamic, 16)
    for (size_t k = 0; k < peaks->count; k++) {
        struct rim place = to_fine(octave, &peaks->items[k].rim);
        struct candidate found;
        int held = capture_rim(&octave->fine, &place, levels->void_level, k, least, &found);
        to_photo(&octave->fine, &found);
        if (!held || found.rim.radius < low / MARGIN || found.rim.radius > high * MARGIN ||
            found.one_side > MOST_ONE_SIDED)
            found.support = 0;
        peaks->items[k] = found;
    }
    size_t kept = 0;
    for (size_t k = 0; k < peaks->count; k++)
        if (peaks->items[k].support >= LEAST_SUPPORT)
            peaks->items[kept++] = peaks->items[k];
    peaks->count = kept;
}

static int detect_octave(const struct photo *photo, const struct zone *zone, const struct grey_levels *levels,
                         double low, double high, struct candidates *found, size_t *looked_at)
{
    struct octave octave = {0};
    struct candidates peaks = {0};
    double contrast = levels->grain_level - levels->void_level;
    int status = make_octave(photo, zone, low, levels->void_level, &octave);
    if (!status)
        status = candidates_vote(&octave.coarse, low / MARGIN / octave.coarse.scale,
                                 high * MARGIN / octave.coarse.scale, contrast, &peaks);
    if (!status) {
        candidates_thin(&peaks, SAME_PLACE);
        *looked_at += peaks.count;
        capture_peaks(&octave, levels, low, high, &peaks);
    }
    for (size_t k = 0; k < peaks.count && !status; k++)
        status = candidates_add(found, &peaks.items[k]);
    candidates_free(&peaks);
    level_free(&octave.fine);
    level_free(&octave.coarse);
    return status;
}

int detect_grains(const struct photo *photo, const struct zone *zone, const struct grey_levels *levels,
                  double radius_min, double radius_max, struct candidates *found, size_t *peaks)
{
    int octaves = (int)fmax(1, ceil(log2(radius_max / radius_min) - 1e-9));
    double ratio = pow(radius_max / radius_min, 1.0 / octaves), high = radius_max;
    *peaks = 0;
    for (int k = 0; k < octaves; k++, high /= ratio)
        if (detect_octave(photo, zone, levels, high / ratio, high, found, peaks))
            return -1;
    candidates_thin(found, DETECT_OVERLAP);
    for (size_t k = 0; k < found->count; k++) {
        found->items[k].captured = found->items[k].rim;
        found->items[k].sure = found->items[k].support;
    }
    return 0;
}
