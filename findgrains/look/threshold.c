/* Grey levels by Otsu (IEEE Trans. SMC 9 (1979) 62-66): the threshold that maximises the variance between two classes,
 * w (1 - w) (mean_1 - mean_0)^2 with w the share below. Levels of voids and grains are medians of the two classes,
 * which specks on the grains and light between them hardly move. Where a valley without pixels gives a row of equal
 * maxima its middle is taken. */
#include "findgrains/look/threshold.h"

#include "pipeline/speak/error.h"

#include <stdint.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { LEVELS = 65536, SAMPLES = 4000000 };

/* A coarse grid with about SAMPLES points, odd steps so that a periodic texture is not followed. */
static uint64_t fill_histogram(const struct photo *photo, const struct zone *zone, uint32_t *histogram)
{
    int step = 1;
    while ((double)photo->width * photo->height / ((double)step * step) > SAMPLES)
        step += 2;
    uint64_t total = 0;
    for (int y = zone->y0; y < zone->y1; y += step) {
        const uint16_t *row = photo_row(photo, y);
        for (int x = zone->x0; x < zone->x1; x += step) {
            if (zone->has_frame && zone_depth(zone, x, y) <= 0)
                continue;
            histogram[row[x]]++;
            total++;
        }
    }
    return total;
}

/* Grey level below which `rank` of the levels from `first` on lie. */
static int level_of_rank(const uint32_t *histogram, int first, uint64_t rank)
{
    uint64_t sum = 0;
    for (int level = first; level < LEVELS; level++) {
        sum += histogram[level];
        if (sum > rank)
            return level;
    }
    return LEVELS - 1;
}

/* The level that parts the histogram into two groups of largest variance between them (Otsu 1979). */
static void find_otsu(const uint32_t *histogram, uint64_t total, struct grey_levels *levels)
{
    double all = 0, all_squared = 0;
    for (int level = 0; level < LEVELS; level++) {
        all += (double)histogram[level] * level;
        all_squared += (double)histogram[level] * level * level;
    }
    double n = (double)total, below = 0, below_sum = 0, best = 0;
    uint64_t best_below = 0, count = 0;
    int first = -1, last = -1;
    for (int level = 0; level < LEVELS - 1; level++) {
        count += histogram[level];
        below = (double)count;
        below_sum += (double)histogram[level] * level;
        if (count == 0 || count == total)
            continue;
        double gap = below_sum / below - (all - below_sum) / (n - below);
        double between = below / n * (1 - below / n) * gap * gap;
        if (between > best) {
            best = between;
            first = last = level;
            best_below = count;
        } else if (between == best && level == last + 1) {
            last = level; /* an empty valley: take its middle */
        }
    }
    double variance = all_squared / n - all / n * (all / n);
    if (first < 0 || !(variance > 0))
        return;
    levels->threshold = 0.5 * (first + last);
    levels->separation = best / variance;
    levels->void_level = level_of_rank(histogram, 0, best_below / 2);
    levels->void_spread = levels->void_level - level_of_rank(histogram, 0, (uint64_t)(0.16 * (double)best_below));
    levels->grain_level = level_of_rank(histogram, first + 1, (total - best_below) / 2);
}

/* Robust standard deviation of a pixel from I(x-1) - 2 I(x) + I(x+1), whose variance is 6 times a pixel's. */
static double find_noise(const struct photo *photo, const struct zone *zone, uint32_t *histogram)
{
    uint64_t total = 0;
    memset(histogram, 0, LEVELS * sizeof *histogram);
    int step = 1 + (zone->y1 - zone->y0) / 256;
    for (int y = zone->y0; y < zone->y1; y += step) {
        const uint16_t *row = photo_row(photo, y);
        for (int x = zone->x0 + 1; x < zone->x1 - 1; x++) {
            int bend = abs(row[x - 1] - 2 * row[x] + row[x + 1]);
            histogram[bend < LEVELS ? bend : LEVELS - 1]++;
            total++;
        }
    }
    return total ? 1.4826 * level_of_rank(histogram, 0, total / 2) / sqrt(6) : 0;
}

int threshold_find(const struct photo *photo, const struct zone *zone, struct grey_levels *levels)
{
    *levels = (struct grey_levels){0};
    uint32_t *histogram = calloc(LEVELS, sizeof *histogram);
    if (!histogram)
        return error_memory("grey histogram");
    uint64_t total = fill_histogram(photo, zone, histogram);
    if (total)
        find_otsu(histogram, total, levels);
    levels->noise = find_noise(photo, zone, histogram);
    free(histogram);
    return 0;
}
