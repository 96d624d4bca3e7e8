/* Var(Z'e) by tiles. Errors of pixels that lie within a tile may be correlated in any way; tiles are larger than the
 * residual's correlation, so that the sum over tiles of (Z'e over the tile)^2 is right whatever it is (a cluster-robust
 * variance). Compared with the sum over pixels of (z e)^2, which is right for white noise, it gives the ratio by which
 * the white covariance is multiplied. */
#include "tracker/subset/scatter.h"

#include <stdlib.h>
#include <string.h>

#include "pipeline/speak/error.h"
#include "tracker/subset/interpolate.h"
#include "tracker/subset/kernel.h"
#include "pipeline/numbers/simd.h"

enum { TILE_COLUMNS = 16, COMPONENTS = 3 }; /* tiles have SUBSET_STRIP rows */
static const double prior_freedom = 20; /* weight of the expected ratio: a tile's components are 3 degrees of freedom */

/* One strip of tiles: Z e and its square, summed over the strip's rows, column by column. */
struct strip {
    int x0, columns;
    float *product[COMPONENTS], *square[COMPONENTS];
    float *block;
};

struct totals {
    double tiles[COMPONENTS], pixels[COMPONENTS]; /* sums over tiles of (Z'e over the tile)^2; of (z e)^2 over pixels */
    double squares[COMPONENTS];                   /* sums over tiles of the square of the latter */
};

static int strip_make(const struct subset *subset, struct strip *strip)
{
    int x1 = 0;
    strip->x0 = subset->runs[0].x;
    for (size_t k = 0; k < subset->run_count; k++) {
        const struct run *run = &subset->runs[k];
        strip->x0 = run->x < strip->x0 ? run->x : strip->x0;
        x1 = run->x + run->count > x1 ? run->x + run->count : x1;
    }
    strip->columns = (x1 - strip->x0 + TILE_COLUMNS - 1) / TILE_COLUMNS * TILE_COLUMNS;
    strip->block = calloc(2 * COMPONENTS * (size_t)strip->columns, sizeof *strip->block);
    if (!strip->block)
        return error_memory("the scatter of a subset");
    for (int a = 0; a < COMPONENTS; a++) {
        strip->product[a] = strip->block + 2 * a * strip->columns;
        strip->square[a] = strip->product[a] + strip->columns;
    }
    return 0;
}

SIMD_CLONES static void subtract_model(float *restrict t, const float *restrict grey, float gain, float offset,
                                       int count)
{
    for (int i = 0; i < count; i++)
        t[i] -= gain * grey[i] + offset;
}

/* e at the sampled pixels, run after run. */
static void load_residual(const struct subset *subset, const struct patch *patch, const struct motion *motion,
                          double gain, double offset, float *residual)
{
    interpolate_line *interpolate = interpolate_chosen(patch->order);
    for (size_t k = 0; k < subset->run_count; k++) {
        const struct run *run = &subset->runs[k];
        struct line line = kernel_line(subset, patch, motion, run);
        if (!subset_sampled(subset, k))
            continue;
        interpolate(patch, &line, 0, run->count, residual);
        subtract_model(residual, subset->planes + SUBSET_GREY * subset->count + run->offset, (float)gain, (float)offset,
                       run->count);
        residual += run->count;
    }
}

/* Takes out what the Laplacian explains; returns its share of the square. */
static double take_focus_out(const float *restrict blur, size_t count, float *restrict residual)
{
    double product = 0, square = 0, energy = 0;
    for (size_t i = 0; i < count; i++) {
        product += (double)residual[i] * blur[i];
        square += (double)residual[i] * residual[i];
        energy += (double)blur[i] * blur[i];
    }
    if (!(energy > 0 && square > 0))
        return 0;
    const float factor = (float)(product / energy);
    for (size_t i = 0; i < count; i++)
        residual[i] -= factor * blur[i];
    return product * product / (energy * square);
}

SIMD_CLONES static void add_pixels(const float *restrict e, const float *restrict z, int count, float *restrict product,
                                   float *restrict square)
{
    for (int i = 0; i < count; i++) {
        float p = z[i] * e[i];
        product[i] += p;
        square[i] += p * p;
    }
}

/* Tiles of the strip into the totals; the strip is empty again. */
static void take(struct strip *strip, struct totals *totals)
{
    for (int begin = 0; begin < strip->columns; begin += TILE_COLUMNS) {
        for (int a = 0; a < COMPONENTS; a++) {
            double sum = 0, square = 0;
            for (int i = begin; i < begin + TILE_COLUMNS; i++) {
                sum += strip->product[a][i];
                square += strip->square[a][i];
            }
            totals->tiles[a] += sum * sum;
            totals->pixels[a] += square;
            totals->squares[a] += square * square;
        }
    }
    memset(strip->block, 0, 2 * COMPONENTS * (size_t)strip->columns * sizeof *strip->block);
}

static void add_tiles(const struct subset *subset, const float *residual, struct strip *strip, struct totals *totals)
{
    int last = 0;
    for (size_t k = 0; k < subset->run_count; k++) {
        const struct run *run = &subset->runs[k];
        if (!subset_sampled(subset, k))
            continue;
        if (subset_strip(subset, k) != last)
            take(strip, totals);
        last = subset_strip(subset, k);
        for (int a = 0; a < COMPONENTS; a++)
            add_pixels(residual, subset->planes + (size_t)a * subset->count + run->offset, run->count,
                       strip->product[a] + (run->x - strip->x0), strip->square[a] + (run->x - strip->x0));
        residual += run->count;
    }
    take(strip, totals);
}

int scatter_measure(const struct subset *subset, const struct patch *patch, const struct motion *motion, double gain,
                    double offset, double expected, struct scatter *scatter)
{
    struct strip strip = {0};
    struct totals totals = {{0}, {0}, {0}};
    float *residual = malloc(subset->sampled * sizeof *residual);
    if (!residual || strip_make(subset, &strip)) {
        free(residual);
        return error_memory("the scatter of a subset");
    }
    load_residual(subset, patch, motion, gain, offset, residual);
    scatter->focus = take_focus_out(subset->blur, subset->sampled, residual);
    add_tiles(subset, residual, &strip, &totals);
    free(strip.block);
    free(residual);
    /* A tile's (Z'e)^2 is one draw of a chi-square law: the ratio of its mean over that of white noise has a relative
     * variance of 2 over the number of tiles, counted by how evenly they share the weight (Kish's effective number).
     * The prior counts as prior_freedom such tiles. */
    double freedom = 0, measured = 0; /* as many tiles as share the weight: few where there are few specks */
    for (int a = 0; a < COMPONENTS; a++)
        if (totals.pixels[a] > 0) {
            double tiles = totals.pixels[a] * totals.pixels[a] / totals.squares[a];
            freedom += tiles;
            measured += tiles * totals.tiles[a] / totals.pixels[a];
        }
    scatter->ratio = (prior_freedom * expected + measured) / (prior_freedom + freedom);
    return 0;
}
