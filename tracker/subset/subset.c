/* The normal equations of a subset, as far as they do not depend on the photo that is searched.
 *
 * A motion m = (u, v, angle) carries a point at (dx, dy) from the centre by (dy, -dx) per radian (y down), so that a
 * small motion changes the grey value by J m with the slopes J = (gx, gy, gx dy - gy dx). With inverse composition
 * (Baker and Matthews, IJCV 56 (2004) 221, section 3.2) these are slopes of the reference: made once, not in every
 * iteration.
 *
 * The equations are multiplied from the left by Z' instead of J': Z are the slopes of the smoothed reference, less
 * noisy instruments. Gain, offset and a change of focus multiply N = (grey, Laplacian, 1); with
 *
 *     Z <- Z - N (N'N)^-1 N'Z
 *
 * Z'N = 0 and none of the three is seen by the iteration. What remains is H = Z'J, 3 x 3 and not symmetric, and Z'Z for
 * the covariance of the estimate.
 *
 * Products of single pixels are summed in floats, in LANES of their own, and every 32 runs into doubles: fast, right to
 * the last digits of a float, and the same on every machine. */
#include "tracker/subset/subset.h"

#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "pipeline/speak/error.h"
#include "pipeline/numbers/simd.h"
#include "tracker/subset/slopes.h"

/* What the normal equations are made of, pixel by pixel: instruments, grey, Laplacian, 1, plain slopes. */
enum { Z = 0, GREY = 3, BLUR, ONE, J, VECTORS = J + 3, STRETCH = 256, LANES = 32 };

/* Sums of products: only rows Z and nuisances (GREY, BLUR, ONE), against everything. Lanes are added at the end, so
 * that the sums are the same on every machine. */
struct products {
    float lanes[J][VECTORS][LANES];
    double sum[J][VECTORS];
};

SIMD_CLONES static void add_products(const float (*restrict vectors)[STRETCH], int count,
                                     float (*restrict lanes)[VECTORS][LANES])
{
    for (int a = Z; a < J; a++)
        for (int b = a; b < VECTORS; b++) {
            const float *p = vectors[a], *q = vectors[b];
            float sum[LANES];
            memcpy(sum, lanes[a][b], sizeof sum);
            for (int i = 0; i < count; i += LANES)
                for (int l = 0; l < LANES; l++)
                    sum[l] += p[i + l] * q[i + l];
            memcpy(lanes[a][b], sum, sizeof sum);
        }
}

/* Single precision is enough for the pixels of a lane in some rows. */
static void flush_products(struct products *products)
{
    for (int a = Z; a < J; a++)
        for (int b = a; b < VECTORS; b++)
            for (int l = 0; l < LANES; l++)
                products->sum[a][b] += products->lanes[a][b][l];
    memset(products->lanes, 0, sizeof products->lanes);
}

/* The slope of the angle: gx dy - gy dx. */
SIMD_CLONES static void turn_slope(const float *restrict gx, const float *restrict gy, float dx, float dy, int count,
                                   float *restrict ga)
{
    for (int i = 0; i < count; i++)
        ga[i] = gx[i] * dy - gy[i] * (dx + (float)i);
}

/* memcpy() of a few hundred bytes, which compilers make a slow string instruction of. */
SIMD_CLONES static void copy(const float *restrict from, int count, float *restrict to)
{
#pragma omp simd
    for (int i = 0; i < count; i++)
        to[i] = from[i];
}

/* Fill the planes of one stretch of a run, Z not yet orthogonal, and add its products. */
static void add_stretch(const struct slopes *slopes, int x, int y, int count, size_t offset, struct subset *subset,
                        struct products *products)
{
    const float dx = (float)(x - subset->shape.cx), dy = (float)(y - subset->shape.cy);
    const int padded = (count + LANES - 1) / LANES * LANES;
    float v[VECTORS][STRETCH];
    slopes_smooth(slopes, x, y, count, v[Z], v[Z + 1]);
    slopes_laplacian(slopes, x, y, count, v[BLUR]);
    slopes_plain(slopes, x, y, count, v[J], v[J + 1]);
    turn_slope(v[Z], v[Z + 1], dx, dy, count, v[Z + 2]);
    turn_slope(v[J], v[J + 1], dx, dy, count, v[J + 2]);
    copy(slopes_grey(slopes, x, y), count, v[GREY]);
    for (int i = 0; i < count; i++)
        v[ONE][i] = 1;
    for (int a = 0; a < VECTORS; a++)
        memset(v[a] + count, 0, (size_t)(padded - count) * sizeof(float));
    add_products(v, count, products->lanes);
    for (int plane = 0; plane < SUBSET_PLANES; plane++) /* Z and grey stand first */
        copy(v[plane], count, subset->planes + (size_t)plane * subset->count + offset);
}

static double mean_grey(const struct photo *reference, const struct subset *subset)
{
    double total = 0;
    for (size_t k = 0; k < subset->run_count; k++) {
        const uint16_t *grey = photo_row(reference, subset->runs[k].y) + subset->runs[k].x;
        uint64_t sum = 0;
        for (int i = 0; i < subset->runs[k].count; i++)
            sum += grey[i];
        total += (double)sum;
    }
    return total / (double)subset->count;
}

static int load_slopes(const struct photo *reference, struct subset *subset, struct slopes *slopes)
{
    int x0 = reference->width, x1 = 0;
    for (size_t k = 0; k < subset->run_count; k++) {
        const struct run *run = &subset->runs[k];
        x0 = run->x < x0 ? run->x : x0;
        x1 = run->x + run->count - 1 > x1 ? run->x + run->count - 1 : x1;
    }
    subset->mean = mean_grey(reference, subset);
    return slopes_load(reference, x0, subset->runs[0].y, x1, subset->runs[subset->run_count - 1].y, (float)subset->mean,
                       slopes);
}

static void fill_planes(const struct slopes *slopes, struct subset *subset, struct products *products)
{
    for (size_t k = 0; k < subset->run_count; k++) {
        const struct run *run = &subset->runs[k];
        for (int i = 0; i < run->count; i += STRETCH)
            add_stretch(slopes, run->x + i, run->y, run->count - i < STRETCH ? run->count - i : STRETCH,
                        run->offset + (size_t)i, subset, products);
        if (k % 32 == 31 || k + 1 == subset->run_count)
            flush_products(products);
    }
}

/* By cofactors (Cramer's rule): exact enough for three unknowns whose scales are known, and H is not symmetric. The
 * determinant is compared with the product of the diagonal, which it equals where the unknowns do not depend on each
 * other. */
int subset_invert(double (*h)[3], double (*inverse)[3])
{
    double minor[3][3], determinant = 0;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            int a = (i + 1) % 3, b = (i + 2) % 3, c = (j + 1) % 3, d = (j + 2) % 3;
            minor[i][j] = h[a][c] * h[b][d] - h[a][d] * h[b][c];
        }
    for (int j = 0; j < 3; j++)
        determinant += h[0][j] * minor[0][j];
    if (!(h[0][0] > 0 && h[1][1] > 0 && determinant > 1e-9 * h[0][0] * h[1][1] * h[2][2]))
        return 0;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            inverse[j][i] = minor[i][j] / determinant;
    return 1;
}

/* share[k][a]: how much of nuisance k (grey, Laplacian, 1) must be taken from Z[a]: (N'N)^-1 N'Z. Without independent
 * content the Laplacian is left alone. */
static int nuisance_shares(const struct products *p, double share[3][3])
{
    double gram[3][3], inverse[3][3];
    for (int k = 0; k < 3; k++)
        for (int l = 0; l < 3; l++)
            gram[k][l] = k <= l ? p->sum[GREY + k][GREY + l] : p->sum[GREY + l][GREY + k];
    if (!subset_invert(gram, inverse)) {
        for (int k = 0; k < 3; k++)
            gram[k][1] = gram[1][k] = k == 1;
        if (!subset_invert(gram, inverse))
            return 0;
        inverse[1][1] = 0;
    }
    for (int k = 0; k < 3; k++)
        for (int a = 0; a < 3; a++) {
            share[k][a] = 0;
            for (int l = 0; l < 3; l++)
                share[k][a] += inverse[k][l] * p->sum[Z + a][GREY + l];
        }
    return 1;
}

/* Z'J and Z'Z after the nuisances are taken out of Z. */
static void set_matrices(const struct products *p, const double share[3][3], struct subset *subset)
{
    for (int a = 0; a < 3; a++)
        for (int b = 0; b < 3; b++) {
            subset->hessian[a][b] = p->sum[Z + a][J + b];
            subset->instrument[a][b] = a <= b ? p->sum[Z + a][Z + b] : p->sum[Z + b][Z + a];
            for (int k = 0; k < 3; k++) {
                subset->hessian[a][b] -= share[k][a] * p->sum[GREY + k][J + b];
                subset->instrument[a][b] -= share[k][a] * p->sum[Z + b][GREY + k];
            }
        }
}

/* Z <- Z - nuisances, on the planes. */
SIMD_CLONES static void take_out(float *restrict z, const float *restrict grey, const float *restrict laplacian,
                                 float a, float b, float c, int count)
{
    for (int i = 0; i < count; i++)
        z[i] -= a * grey[i] + b * laplacian[i] + c;
}

/* Takes the nuisances out of Z; of the Laplacian, the sampled runs are kept, less what it has of grey (`likeness`) and
 * its mean. */
static void orthogonalise(const struct slopes *slopes, const double share[3][3], double likeness, double mean,
                          struct subset *subset)
{
    const size_t n = subset->count;
    float laplacian[STRETCH], *blur = subset->blur;
    for (size_t k = 0; k < subset->run_count; k++) {
        const struct run *run = &subset->runs[k];
        for (int i = 0; i < run->count; i += STRETCH) {
            int count = run->count - i < STRETCH ? run->count - i : STRETCH;
            float *planes = subset->planes + run->offset + i;
            slopes_laplacian(slopes, run->x + i, run->y, count, laplacian);
            for (int a = 0; a < 3; a++)
                take_out(planes + (size_t)a * n, planes + SUBSET_GREY * n, laplacian, (float)share[0][a],
                         (float)share[1][a], (float)share[2][a], count);
            if (!subset_sampled(subset, k))
                continue;
            copy(laplacian, count, blur);
            take_out(blur, planes + SUBSET_GREY * n, laplacian, (float)likeness, 0, (float)mean, count);
            blur += count;
        }
    }
}

/* Of a small subset every run, of a large one every n-th strip of SUBSET_STRIP rows, down to SUBSET_ENOUGH pixels. */
static int alloc_blur(struct subset *subset)
{
    size_t sampled = 0;
    subset->every = (int)(subset->count / SUBSET_ENOUGH);
    for (size_t k = 0; k < subset->run_count; k++)
        sampled += subset_sampled(subset, k) ? (size_t)subset->runs[k].count : 0;
    subset->sampled = sampled;
    subset->blur = malloc(sampled * sizeof *subset->blur);
    return subset->blur ? 0 : error_memory("the pixels of a subset");
}

/* Pixel noise makes slopes larger than they are, and turns with the square of the distance. */
static void noise_of_slopes(struct subset *subset)
{
    double second = 0, n = (double)subset->count;
    for (size_t k = 0; k < subset->run_count; k++) {
        const struct run *run = &subset->runs[k];
        double dy = run->y - subset->shape.cy, dx = run->x + 0.5 * (run->count - 1) - subset->shape.cx;
        double m = run->count;
        second += m * (dx * dx + dy * dy + (m * m - 1) / 12);
    }
    for (int a = 0; a < 3; a++) {
        subset->noise_hessian[a] = slopes_noise() * (a < 2 ? n : second);
    }
}

/* Pixels that carry the texture: all for a Gaussian one, those of the specks where there are few ((sum g2)^2 / sum g4,
 * times 3, its kurtosis). */
static double textured_pixels(const struct subset *subset)
{
    const float *grey = subset->planes + SUBSET_GREY * subset->count;
    double second = 0, fourth = 0;
    for (size_t k = 0; k < subset->count; k++) {
        double square = (double)grey[k] * grey[k];
        second += square;
        fourth += square * square;
    }
    return fourth > 0 ? fmin(3 * second * second / fourth, (double)subset->count) : 0;
}

/* Planes, blur and matrices of a subset whose runs are there. Without texture: energy 0. */
static int fill(const struct photo *reference, struct subset *subset)
{
    struct products products = {0};
    struct slopes slopes;
    double share[3][3];
    subset->planes = malloc(SUBSET_PLANES * subset->count * sizeof *subset->planes);
    if (!subset->planes)
        return error_memory("the pixels of a subset");
    if (alloc_blur(subset) || load_slopes(reference, subset, &slopes))
        return -1;
    fill_planes(&slopes, subset, &products);
    double slope2 = products.sum[Z][J] + products.sum[Z + 1][J + 1], n = (double)subset->count;
    subset->energy = products.sum[GREY][GREY] - products.sum[GREY][ONE] * products.sum[GREY][ONE] / n;
    subset->speckle = slope2 > 0 ? sqrt(2 * subset->energy / slope2) : 0;
    subset->speckle_count =
        subset->speckle > 0 ? textured_pixels(subset) / (M_PI * subset->speckle * subset->speckle) : 0;
    if (subset->energy > 0 && nuisance_shares(&products, share)) {
        set_matrices(&products, share, subset);
        orthogonalise(&slopes, share, products.sum[GREY][BLUR] / products.sum[GREY][GREY], products.sum[BLUR][ONE] / n,
                      subset);
        noise_of_slopes(subset);
        if (!subset_invert(subset->hessian, subset->inverse))
            subset->energy = 0;
    } else {
        subset->energy = 0;
    }
    slopes_free(&slopes);
    return 0;
}

int subset_build(const struct photo *reference, const struct shape *shape, const struct subset_mask *mask,
                 struct subset *subset)
{
    static const struct subset_mask no_mask = {0};
    struct runs runs;
    *subset = (struct subset){.shape = *shape};
    if (runs_find(reference, shape, mask ? mask : &no_mask, &runs))
        return -1;
    subset->runs = runs.items;
    subset->run_count = runs.count;
    subset->count = runs.pixels;
    subset->used = runs.used;
    subset->saturated = runs.saturated;
    int status = subset->count ? fill(reference, subset) : 0;
    if (status)
        subset_free(subset);
    return status;
}

int subset_usable(const struct subset *subset)
{
    return subset->count >= 16 && subset->energy > 0;
}

void subset_free(struct subset *subset)
{
    free(subset->runs);
    free(subset->planes);
    free(subset->blur);
    *subset = (struct subset){0};
}
