#include "tracker/subset.h"

#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "pipeline/error.h"

enum { SLOPE_REACH = 2 }; /* px that the slope needs around a pixel */
static const double pi = 3.141592653589793;

/* First and last column of the shape in row y; an empty range when it has none. */
static void columns_of(const struct shape *shape, int y, int *first, int *last)
{
    double half = shape->half_w, dy = y - shape->cy;
    if (!(half > 0)) {
        double square = shape->radius * shape->radius - dy * dy;
        half = square >= 0 ? sqrt(square) : -1;
    }
    *first = (int)ceil(shape->cx - half);
    *last = (int)floor(shape->cx + half);
}

static void rows_of(const struct shape *shape, int *first, int *last)
{
    double half = shape->half_h > 0 ? shape->half_h : shape->radius;
    *first = (int)ceil(shape->cy - half);
    *last = (int)floor(shape->cy + half);
}

/* Does the warp carry this pixel to a place where the spline of the searched photo is its own? */
static int lands_inside(const struct subset_mask *mask, const struct shape *shape, int x, int y)
{
    double c = cos(mask->angle), s = sin(mask->angle), dx = x - shape->cx, dy = y - shape->cy;
    double px = shape->cx + mask->u + c * dx + s * dy, py = shape->cy + mask->v - s * dx + c * dy;
    return px >= SLOPE_REACH && py >= SLOPE_REACH && px <= mask->photo->width - 1 - SLOPE_REACH &&
           py <= mask->photo->height - 1 - SLOPE_REACH;
}

static int is_used(const struct photo *reference, const struct shape *shape, const struct subset_mask *mask, int x,
                   int y)
{
    if (mask->saturation && photo_row(reference, y)[x] >= mask->saturation)
        return 0;
    if (mask->photo && !lands_inside(mask, shape, x, y))
        return 0;
    for (size_t k = 0; k < mask->neighbour_count; k++) {
        double dx = x - mask->neighbours[k].cx, dy = y - mask->neighbours[k].cy;
        if (dx * dx + dy * dy < mask->neighbours[k].radius * mask->neighbours[k].radius)
            return 0;
    }
    return 1;
}

static int add_run(struct subset *subset, size_t *capacity, int x, int y, int count)
{
    if (subset->run_count == *capacity) {
        size_t grown = *capacity ? 2 * *capacity : 64;
        struct run *runs = realloc(subset->runs, grown * sizeof *runs);
        if (!runs)
            return error_memory("the runs of a subset");
        subset->runs = runs;
        *capacity = grown;
    }
    subset->runs[subset->run_count++] = (struct run){x, y, count, subset->count};
    subset->count += (size_t)count;
    return 0;
}

/* Row by row, the pixels of the shape that may be used. */
static int find_runs(const struct photo *reference, const struct subset_mask *mask, struct subset *subset)
{
    const struct shape *shape = &subset->shape;
    int masked = mask->saturation || mask->photo || mask->neighbour_count;
    int y_first, y_last;
    size_t capacity = 0, all = 0;
    rows_of(shape, &y_first, &y_last);
    for (int y = y_first; y <= y_last; y++) {
        int first, last;
        columns_of(shape, y, &first, &last);
        all += last >= first ? (size_t)(last - first + 1) : 0;
        if (y < SLOPE_REACH || y >= reference->height - SLOPE_REACH)
            continue;
        first = first < SLOPE_REACH ? SLOPE_REACH : first;
        last = last >= reference->width - SLOPE_REACH ? reference->width - SLOPE_REACH - 1 : last;
        for (int x = first; x <= last;) {
            int begin = x;
            while (x <= last && (!masked || is_used(reference, shape, mask, x, y)))
                x++;
            if (x > begin && add_run(subset, &capacity, begin, y, x - begin))
                return -1;
            for (; x <= last && masked && !is_used(reference, shape, mask, x, y); x++)
                if (mask->saturation && photo_row(reference, y)[x] >= mask->saturation)
                    subset->saturated++;
        }
    }
    subset->used = all ? (double)subset->count / (double)all : 0;
    return 0;
}

/* The planes before orthogonalisation: slopes (central, fourth order), slope of the angle, grey minus the mean. */
static void fill_planes(const struct photo *reference, struct subset *subset)
{
    const size_t n = subset->count;
    const ptrdiff_t w = reference->width;
    double total = 0;
    for (size_t k = 0; k < subset->run_count; k++) {
        const struct run *run = &subset->runs[k];
        const uint16_t *grey = photo_row(reference, run->y) + run->x;
        uint64_t sum = 0;
        for (int i = 0; i < run->count; i++)
            sum += grey[i];
        total += (double)sum;
    }
    subset->mean = n ? total / (double)n : 0;
    for (size_t k = 0; k < subset->run_count; k++) {
        const struct run *run = &subset->runs[k];
        const uint16_t *grey = photo_row(reference, run->y) + run->x;
        float *jx = subset->planes + run->offset, *jy = jx + n, *ja = jy + n, *level = ja + n;
        const float mean = (float)subset->mean, dy = (float)(run->y - subset->shape.cy);
        const float dx = (float)(run->x - subset->shape.cx);
        for (int i = 0; i < run->count; i++) {
            const uint16_t *g = grey + i;
            float gx = (float)(8 * (g[1] - g[-1]) - (g[2] - g[-2])) * (1.0f / 12);
            float gy = (float)(8 * (g[w] - g[-w]) - (g[2 * w] - g[-2 * w])) * (1.0f / 12);
            jx[i] = gx;
            jy[i] = gy;
            ja[i] = gx * dy - gy * (dx + (float)i);
            level[i] = (float)g[0] - mean;
        }
    }
}

/* Sums of products of the planes among themselves and with 1. */
static void plane_products(const struct subset *subset, double product[SUBSET_PLANES][SUBSET_PLANES],
                           double total[SUBSET_PLANES])
{
    const size_t n = subset->count;
    enum { BLOCK = 1024 };
    memset(product, 0, sizeof(double) * SUBSET_PLANES * SUBSET_PLANES);
    memset(total, 0, sizeof(double) * SUBSET_PLANES);
    for (size_t begin = 0; begin < n; begin += BLOCK) {
        size_t count = n - begin < BLOCK ? n - begin : BLOCK;
        for (int a = 0; a < SUBSET_PLANES; a++) {
            const float *p = subset->planes + (size_t)a * n + begin;
            double sum = 0;
            for (size_t i = 0; i < count; i++)
                sum += p[i];
            total[a] += sum;
            for (int b = a; b < SUBSET_PLANES; b++) {
                const float *q = subset->planes + (size_t)b * n + begin;
                double dot = 0;
                for (size_t i = 0; i < count; i++)
                    dot += (double)p[i] * q[i];
                product[a][b] += dot;
            }
        }
    }
}

int subset_invert(double h[3][3], double inverse[3][3])
{
    double c00 = h[1][1] * h[2][2] - h[1][2] * h[1][2], c01 = h[0][2] * h[1][2] - h[0][1] * h[2][2];
    double c02 = h[0][1] * h[1][2] - h[0][2] * h[1][1];
    double determinant = h[0][0] * c00 + h[0][1] * c01 + h[0][2] * c02;
    if (!(determinant > 1e-9 * h[0][0] * h[1][1] * h[2][2]))
        return 0;
    inverse[0][0] = c00 / determinant;
    inverse[0][1] = inverse[1][0] = c01 / determinant;
    inverse[0][2] = inverse[2][0] = c02 / determinant;
    inverse[1][1] = (h[0][0] * h[2][2] - h[0][2] * h[0][2]) / determinant;
    inverse[1][2] = inverse[2][1] = (h[0][1] * h[0][2] - h[0][0] * h[1][2]) / determinant;
    inverse[2][2] = (h[0][0] * h[1][1] - h[0][1] * h[0][1]) / determinant;
    return 1;
}

/* J <- J - alpha grey - beta: orthogonal to grey (whose mean is zero) and to 1. */
static void orthogonalise(struct subset *subset)
{
    const size_t n = subset->count;
    double product[SUBSET_PLANES][SUBSET_PLANES], total[SUBSET_PLANES];
    plane_products(subset, product, total);
    subset->energy = product[SUBSET_GREY][SUBSET_GREY];
    double slopes = product[SUBSET_JX][SUBSET_JX] + product[SUBSET_JY][SUBSET_JY];
    subset->speckle = slopes > 0 ? sqrt(2 * subset->energy / slopes) : 0;
    subset->speckle_count = subset->speckle > 0 ? (double)n / (pi * subset->speckle * subset->speckle) : 0;
    if (!(subset->energy > 0))
        return;
    for (int a = 0; a < 3; a++) {
        float alpha = (float)(product[a][SUBSET_GREY] / subset->energy), beta = (float)(total[a] / (double)n);
        float *restrict j = subset->planes + (size_t)a * n;
        const float *restrict grey = subset->planes + SUBSET_GREY * n;
        for (size_t i = 0; i < n; i++)
            j[i] -= alpha * grey[i] + beta;
        for (int b = a; b < 3; b++)
            subset->hessian[a][b] = subset->hessian[b][a] =
                product[a][b] - total[a] * total[b] / (double)n -
                product[a][SUBSET_GREY] * product[b][SUBSET_GREY] / subset->energy;
    }
    if (!subset_invert(subset->hessian, subset->inverse))
        subset->energy = 0;
}

/* Pixel noise makes the slopes larger than they are: by (2 * 8^2 + 2) / 12^2 of its variance per pixel. */
static void noise_of_slopes(struct subset *subset)
{
    double second = 0;
    for (size_t k = 0; k < subset->run_count; k++) {
        const struct run *run = &subset->runs[k];
        double dy = run->y - subset->shape.cy, dx = run->x + 0.5 * (run->count - 1) - subset->shape.cx;
        double m = run->count;
        second += m * (dx * dx + dy * dy + (m * m - 1) / 12);
    }
    const double gain = 130.0 / 144;
    subset->noise_slope[0] = subset->noise_slope[1] = gain * (double)subset->count;
    subset->noise_slope[2] = gain * second;
}

int subset_build(const struct photo *reference, const struct shape *shape, const struct subset_mask *mask,
                 struct subset *subset)
{
    static const struct subset_mask no_mask = {0};
    *subset = (struct subset){.shape = *shape};
    if (find_runs(reference, mask ? mask : &no_mask, subset)) {
        subset_free(subset);
        return -1;
    }
    if (!subset->count)
        return 0;
    subset->planes = malloc(SUBSET_PLANES * subset->count * sizeof *subset->planes);
    if (!subset->planes) {
        subset_free(subset);
        return error_memory("the pixels of a subset");
    }
    fill_planes(reference, subset);
    orthogonalise(subset);
    noise_of_slopes(subset);
    return 0;
}

int subset_usable(const struct subset *subset)
{
    return subset->count >= 16 && subset->energy > 0;
}

void subset_free(struct subset *subset)
{
    free(subset->runs);
    free(subset->planes);
    *subset = (struct subset){0};
}
