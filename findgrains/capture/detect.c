/* Octave by octave of the radius, from the largest down; within an octave window by window, at a pixel with which its
 * smallest radius is DETECT_VOTE_RADIUS pixels while voting and twice that while capturing: cost and memory per octave
 * do not depend on the size of the grains.
 *
 * What looks like a grain within a grain is the danger: speckle makes circles of any size. Three rules stand against
 * it. A sure grain covers its pixels for all smaller octaves; a candidate must be supported better the smaller it is
 * (candidates_merit); and the search ends with the first octave in which hardly any likely circle stands its ground
 * against those found. */
#include "findgrains/capture/detect.h"

#include "findgrains/capture/votes.h"
#include "findgrains/capture/capture.h"
#include "findgrains/look/level.h"
#include "findgrains/capture/polish.h"
#include "pipeline/speak/error.h"

#include <math.h>
#include <stdlib.h>

#define FINEST 6.0      /* level pixels of the smallest radius when the photo has to be magnified */
#define MARGIN 1.06     /* radii this much outside the range are looked for as well */
#define SAME_PLACE 0.08 /* of R_i + R_j: peaks of the votes nearer than this lead to the same capture */
#define LEAST_SUPPORT 0.30
#define SURE_SUPPORT 0.6 /* circles of specks reach 0.55 */
#define SURE_ONE_SIDED 0.5
#define LEAST_GREY 0.2 /* of the contrast: a grain is at least that much brighter than the voids */
#define MOST_ONE_SIDED 0.72
#define GROWN 1.2 /* of the radius */
#define LIKELY_SUPPORT 0.5
#define FEW 0.02           /* of the sure grains so far: an octave with fewer likely ones is the last */
#define TILE_PIXELS 4.0e6  /* of the level for captures: bounds the memory */
#define SMALLEST_TILE 64.0 /* px: smaller radii than 1 px would make tiles of nothing */
enum { AGAIN = 3, CHUNK = 256, MOST_OCTAVES = 24 };

/* One search of a photo; `sure` collects circles that later windows need not look at. */
struct search {
    const struct photo *photo;
    const struct zone *zone;
    const struct grey_levels *levels;
    double contrast, vote_radius;
    struct candidates *found, sure;
    size_t looked_at;
};

/* One octave in one window of the photo. */
struct octave {
    double low, high;          /* radii, px */
    int x0, y0, x1, y1;        /* centres of peaks are inside, px */
    struct level fine, coarse; /* of capture; of votes */
    int factor;                /* coarse pixels per fine pixel */
    struct cover cover;        /* of the coarse level */
};

static double fine_scale(const struct search *search, double low)
{
    return fmax(low / (2 * search->vote_radius), fmin(1, low / FINEST));
}

static int make_levels(const struct search *search, struct octave *octave)
{
    struct zone window = *search->zone;
    double margin = 2 * MARGIN * octave->high;
    window.x0 = (int)fmax(window.x0, octave->x0 - margin);
    window.y0 = (int)fmax(window.y0, octave->y0 - margin);
    window.x1 = (int)fmin(window.x1, octave->x1 + margin);
    window.y1 = (int)fmin(window.y1, octave->y1 + margin);
    if (level_make(search->photo, &window, fine_scale(search, octave->low), search->levels->void_level, &octave->fine))
        return -1;
    octave->factor = octave->low / octave->fine.scale >= 1.9 * search->vote_radius ? 2 : 1;
    return level_shrink(&octave->fine, octave->factor, &octave->coarse) ||
                   cover_make(&octave->coarse, &search->sure, &octave->cover)
               ? -1
               : 0;
}

/* Accepts what a failed make_levels() leaves. */
static void free_levels(struct octave *octave)
{
    cover_free(&octave->cover);
    level_free(&octave->fine);
    level_free(&octave->coarse);
}

/* From px of the photo to pixels of a level; to_photo() goes back. */
static struct rim to_level(const struct level *level, const struct rim *rim)
{
    return (struct rim){.x = (rim->x - level->x0) / level->scale,
                        .y = (rim->y - level->y0) / level->scale,
                        .radius = rim->radius / level->scale};
}

static void to_photo(const struct level *level, struct candidate *item)
{
    item->rim.x = level->x0 + item->rim.x * level->scale;
    item->rim.y = level->y0 + item->rim.y * level->scale;
    item->rim.radius *= level->scale;
    item->spread *= level->scale;
}

/* Supported nearly all round, and from every side. */
static int is_sure(const struct candidate *item)
{
    return item->support >= SURE_SUPPORT && item->one_side <= SURE_ONE_SIDED;
}

/* From a peak to the rim that is supported best around it: a circle of specks that touches the rim from inside is left
 * by looking again from there, and from a larger one. */
static int capture_peak(const struct search *search, const struct octave *octave, const struct rim *peak, uint64_t key,
                        struct candidate *found)
{
    double void_level = search->levels->void_level, least = LEAST_GREY * search->contrast;
    const struct rim start = to_level(&octave->fine, peak);
    if (!capture_rim(&octave->fine, &start, void_level, key, least, found) || found->support < LEAST_SUPPORT)
        return 0;
    for (uint64_t again = 1; again <= AGAIN && !is_sure(found); again++) {
        struct rim place = found->rim;
        struct candidate other;
        if (again % 2 == 0)
            place.radius *= GROWN;
        if (capture_rim(&octave->fine, &place, void_level, key + (again << 32), least, &other) &&
            other.support > found->support)
            *found = other;
    }
    to_photo(&octave->fine, found);
    double slack = octave->fine.scale; /* a capture is not exact */
    return found->rim.radius >= octave->low / MARGIN - slack && found->rim.radius <= octave->high * MARGIN + slack &&
           found->one_side <= MOST_ONE_SIDED;
}

/* Capture a run of peaks, whatever the cover says meanwhile; those that hold are added. */
static int capture_chunk(struct search *search, struct octave *octave, const struct candidate *peaks, size_t count)
{
    struct candidate captured[CHUNK];
    int held[CHUNK];
#pragma omp parallel for schedule(dynamic, 8)
    for (size_t k = 0; k < count; k++)
        held[k] = capture_peak(search, octave, &peaks[k].rim, search->looked_at + k, &captured[k]);
    search->looked_at += count;
    for (size_t k = 0; k < count; k++) {
        const struct candidate *item = &captured[k];
        if (!held[k])
            continue;
        if (candidates_add(search->found, item))
            return -1;
        if (!is_sure(item) || cover_at(&octave->cover, item->rim.x, item->rim.y))
            continue;
        cover_add(&octave->cover, &item->rim);
        if (candidates_add(&search->sure, item))
            return -1;
    }
    return 0;
}

/* Best peaks first, in chunks of a fixed length, so that the outcome never depends on the number of threads. */
static int capture_peaks(struct search *search, struct octave *octave, struct candidates *peaks)
{
    struct candidate chunk[CHUNK];
    size_t count = 0;
    for (size_t k = 0; k < peaks->count; k++) {
        struct candidate peak = peaks->items[k];
        to_photo(&octave->coarse, &peak);
        if (peak.rim.x < octave->x0 || peak.rim.x >= octave->x1 || peak.rim.y < octave->y0 ||
            peak.rim.y >= octave->y1 || cover_at(&octave->cover, peak.rim.x, peak.rim.y))
            continue;
        chunk[count++] = peak;
        if (count == CHUNK) {
            if (capture_chunk(search, octave, chunk, count))
                return -1;
            count = 0;
        }
    }
    return capture_chunk(search, octave, chunk, count);
}

static int search_window(struct search *search, struct octave *octave)
{
    struct candidates peaks = {0};
    int status = make_levels(search, octave);
    double scale = octave->coarse.scale;
    if (!status)
        status = candidates_vote(&octave->coarse, &octave->cover, octave->low / MARGIN / scale,
                                 octave->high * MARGIN / scale, search->contrast, &peaks);
    if (!status)
        status =
            candidates_thin(&peaks, SAME_PLACE, candidates_support) || capture_peaks(search, octave, &peaks) ? -1 : 0;
    candidates_free(&peaks);
    free_levels(octave);
    return status;
}

/* Window by window, so that the memory stays bounded however fine the pixels. */
static int search_octave(struct search *search, double low, double high)
{
    const struct zone *zone = search->zone;
    int side = (int)fmax(SMALLEST_TILE, fmax(8 * high, sqrt(TILE_PIXELS) * fine_scale(search, low)));
    int columns = (zone->x1 - zone->x0 + side - 1) / side, rows = (zone->y1 - zone->y0 + side - 1) / side;
    int width = (zone->x1 - zone->x0 + columns - 1) / columns, height = (zone->y1 - zone->y0 + rows - 1) / rows;
    for (int j = 0; j < rows; j++)
        for (int i = 0; i < columns; i++) {
            struct octave octave = {.low = low, .high = high};
            octave.x0 = zone->x0 + i * width;
            octave.y0 = zone->y0 + j * height;
            octave.x1 = octave.x0 + width;
            octave.y1 = octave.y0 + height;
            if (search_window(search, &octave))
                return -1;
        }
    return 0;
}

/* Octave by octave, from large radii to small ones: large grains cover what small circles could be seen in. */
static int search_range(struct search *search, double low, double high)
{
    int octaves = (int)fmax(1, fmin(MOST_OCTAVES, ceil(log2(high / low) - 1e-9)));
    double ratio = pow(high / low, 1.0 / octaves);
    for (int k = 0; k < octaves; k++, high /= ratio)
        if (search_octave(search, high / ratio, high))
            return -1;
    return 0;
}

/* An octave with hardly any likely grain has sure ones or none. */
static void keep_sure(struct candidates *found, size_t first, size_t end)
{
    size_t kept = first;
    for (size_t k = first; k < found->count; k++)
        if (k >= end || is_sure(&found->items[k]))
            found->items[kept++] = found->items[k];
    found->count = kept;
}

/* Likely grains of the octave below `high` that stand their ground: circles of specks inside a larger grain do not. */
static int count_likely(const struct candidates *found, double high, size_t *count)
{
    struct candidates list = {0};
    int status = 0;
    for (size_t k = 0; k < found->count && !status; k++)
        status = candidates_add(&list, &found->items[k]);
    if (!status)
        status = candidates_thin(&list, DETECT_OVERLAP, candidates_merit);
    *count = 0;
    for (size_t k = 0; k < list.count; k++)
        *count += list.items[k].rim.radius < high && list.items[k].support >= LIKELY_SUPPORT;
    candidates_free(&list);
    return status;
}

/* From the largest radius down while octaves show grains. */
static int search_all(struct search *search, double range[2])
{
    const struct zone *zone = search->zone;
    double high = fmax(2 * DETECT_SMALLEST, 0.5 * fmin(zone->x1 - zone->x0, zone->y1 - zone->y0));
    size_t empty = 0; /* found in the octaves before the first grain */
    range[1] = high;
    for (; high > 1.1 * DETECT_SMALLEST; high /= 2) {
        size_t sure = search->sure.count, found = search->found->count, likely;
        range[0] = fmax(DETECT_SMALLEST, high / 2);
        if (search_octave(search, range[0], high))
            return -1;
        if (search->sure.count == 0)
            empty = search->found->count;
        if (count_likely(search->found, high, &likely))
            return -1;
        if (sure && (double)likely <= FEW * (double)sure) {
            keep_sure(search->found, found, search->found->count);
            break;
        }
    }
    if (search->sure.count)
        keep_sure(search->found, 0, empty);
    return 0;
}

int detect_grains_at(double vote_radius, const struct photo *photo, const struct zone *zone,
                     const struct grey_levels *levels, double range[2], struct candidates *found, size_t *peaks)
{
    struct search search = {.photo = photo, .zone = zone, .levels = levels, .vote_radius = vote_radius, .found = found};
    search.contrast = levels->grain_level - levels->void_level;
    int known = range[0] > 0 && range[1] > 0;
    int status = known ? search_range(&search, range[0], range[1]) : search_all(&search, range);
    *peaks = search.looked_at;
    candidates_free(&search.sure);
    if (status || candidates_thin(found, DETECT_OVERLAP, candidates_merit))
        return -1;
    polish_rims(photo, levels, found);
    return 0;
}

int detect_grains(const struct photo *photo, const struct zone *zone, const struct grey_levels *levels, double range[2],
                  struct candidates *found, size_t *peaks)
{
    return detect_grains_at(DETECT_VOTE_RADIUS, photo, zone, levels, range, found, peaks);
}
