/* A Hough transform with the gradient's direction: each edge pixel votes for one centre per radius, r along its
 * gradient towards the bright side. Votes are summed over 3 x 3 pixels (an edge's direction is known to some degrees)
 * and divided by the rim's length, so that a whole rim counts 1 at every radius. Three layers, of the radii r - 1, r
 * and r + 1, are held at a time. */
#include "findgrains/capture/votes.h"

#include "findgrains/look/opencv_shim.h"
#include "pipeline/speak/error.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* A blurred step of height A has a Scharr gradient of about 0.4 A per pixel at these scales. Edges vote from a tenth
 * of the contrast on (rods differ in brightness by two and more), with full weight from a quarter on. */
#define FAINTEST_EDGE 0.06
#define FULL_EDGE 0.20
#define LOWEST_PEAK 0.20 /* votes of a peak, in votes of a whole rim */
#define LIKELY_PEAK 0.40 /* from here on a peak among centres is enough */

/* Pixels of the level; the gradient's direction and not its size counts, from FULL_EDGE on. */
struct edge {
    float x, y, ux, uy, weight; /* u: unit vector towards the bright side */
};

struct edges {
    struct edge *items;
    size_t count;
};

static int gather_edges(const struct level *level, const struct cover *cover, double contrast, struct edges *edges)
{
    size_t pixels = (size_t)level->width * (size_t)level->height;
    float *gx = malloc(pixels * sizeof *gx), *gy = malloc(pixels * sizeof *gy);
    int status = -1;
    if (!gx || !gy) {
        status = error_memory("gradients");
        goto done;
    }
    if (shim_gradient(level->pixels, level->width, level->height, gx, gy))
        goto done;
    float faintest = (float)(FAINTEST_EDGE * contrast), full = (float)(FULL_EDGE * contrast);
    size_t count = 0;
    for (size_t k = 0; k < pixels; k++)
        count += !cover->pixels[k] && gx[k] * gx[k] + gy[k] * gy[k] > faintest * faintest;
    edges->items = malloc((count ? count : 1) * sizeof *edges->items);
    if (!edges->items) {
        status = error_memory("edge pixels");
        goto done;
    }
    for (size_t k = 0; k < pixels; k++) {
        float square = gx[k] * gx[k] + gy[k] * gy[k];
        if (!cover->pixels[k] && square > faintest * faintest) {
            float size = sqrtf(square);
            edges->items[edges->count++] =
                (struct edge){(float)(k % (size_t)level->width), (float)(k / (size_t)level->width), gx[k] / size,
                              gy[k] / size, size < full ? size / full : 1};
        }
    }
    status = 0;
done:
    free(gx);
    free(gy);
    return status;
}

/* Votes for radius r, summed over 3 x 3 pixels, in units of a rim's length. */
static int fill_layer(const struct level *level, const struct edges *edges, double r, float *layer)
{
    memset(layer, 0, (size_t)level->width * (size_t)level->height * sizeof *layer);
    for (size_t k = 0; k < edges->count; k++) {
        const struct edge *edge = &edges->items[k];
        float x = edge->x + (float)r * edge->ux + 0.5f, y = edge->y + (float)r * edge->uy + 0.5f;
        if (x >= 0 && y >= 0 && x < (float)level->width && y < (float)level->height)
            layer[(size_t)y * (size_t)level->width + (size_t)x] += edge->weight;
    }
    if (shim_sum3(layer, level->width, level->height))
        return -1;
    float unit = (float)(1 / (2 * M_PI * r));
    for (size_t k = 0; k < (size_t)level->width * (size_t)level->height; k++)
        layer[k] *= unit;
    return 0;
}

/* The highest of its neighbours, whose radii are one less and one more as well. Not so a likely one: where specks make
 * up smaller circles inside the rim, the rim's own votes lie on a ridge that rises towards those. */
static int is_peak(const struct level *level, float *const layers[3], size_t at)
{
    float value = layers[1][at];
    int first = value >= LIKELY_PEAK ? 1 : 0;
    for (int k = first; k < 3 - first; k++)
        for (int j = -1; j <= 1; j++)
            for (int i = -1; i <= 1; i++) {
                float other = layers[k][at + (size_t)(j * level->width + i)];
                /* of equal neighbours the last one wins */
                if (other > value || (other == value && (k > 1 || (k == 1 && (j > 0 || (j == 0 && i > 0))))))
                    return 0;
            }
    return 1;
}

static int gather_peaks(const struct level *level, const struct cover *cover, float *const layers[3], double r,
                        struct candidates *peaks)
{
    for (int y = 1; y < level->height - 1; y++)
        for (int x = 1; x < level->width - 1; x++) {
            size_t at = (size_t)y * (size_t)level->width + (size_t)x;
            if (layers[1][at] < LOWEST_PEAK || cover->pixels[at] || !is_peak(level, layers, at))
                continue;
            struct candidate peak = {.rim = {.x = x, .y = y, .radius = r}, .support = layers[1][at], .spread = 1};
            if (candidates_add(peaks, &peak))
                return -1;
        }
    return 0;
}

int candidates_vote(const struct level *level, const struct cover *cover, double low, double high, double contrast,
                    struct candidates *peaks)
{
    struct edges edges = {0};
    size_t pixels = (size_t)level->width * (size_t)level->height;
    float *block = malloc(3 * pixels * sizeof *block), *layers[3] = {block, block + pixels, block + 2 * pixels};
    int status = -1, count = (int)ceil(high - low) + 3;
    if (!block) {
        status = error_memory("layers of votes");
        goto done;
    }
    if (gather_edges(level, cover, contrast, &edges))
        goto done;
    for (int k = 0; k < count; k++) {
        double r = low - 1 + k;
        float *oldest = layers[0];
        layers[0] = layers[1];
        layers[1] = layers[2];
        layers[2] = oldest;
        if (fill_layer(level, &edges, r, layers[2]))
            goto done;
        if (k >= 2 && gather_peaks(level, cover, layers, r - 1, peaks))
            goto done;
    }
    status = 0;
done:
    free(edges.items);
    free(block);
    return status;
}
