/* Interpolating splines (Unser, IEEE Signal Processing Magazine 16 (1999) 22): grey(x) = sum over k of c_k B(x - k), B
 * the B-spline of degree 3 or 5, with c so that grey(i) is pixel i. On the pixels B is the filter 1 4 1 / 6, or 1 26 66
 * 26 1 / 120; c is the photo filtered by its inverse, a sum of two-sided exponentials z^|k| whose poles lie at z =
 * -0.268 (cubic), -0.431 and -0.043 (quintic). Unser runs them as recursive filters from border to border; for a patch,
 * some taps of the impulse response do the same and every patch stands alone. In two dimensions rows and columns are
 * filtered one after the other. */
#include "tracker/subset/bspline.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <pthread.h>

#include "pipeline/speak/error.h"
#include "pipeline/numbers/simd.h"

enum { CUBIC_TAPS = 8, QUINTIC_TAPS = 16, MAX_TAPS = 16, BLOCK = 32 };

static int reach_of(enum bspline_order order)
{
    return order == BSPLINE_CUBIC ? CUBIC_TAPS : QUINTIC_TAPS;
}

/* Adds to taps[k] the Fourier coefficients of factor / (2 cos w - root), root < -2: a two-sided exponential with the
 * pole z, z + 1/z = root. */
static void add_exponential(double root, double factor, int reach, double taps[])
{
    double z = (root + sqrt(root * root - 4)) / 2, term = -factor * z / (1 - z * z);
    for (int k = 0; k <= reach; k++, term *= z)
        taps[k] += term;
}

/* taps[k] = taps[-k]: the inverse of the sampled B-spline, 6 / (4 + 2 cos w) or 120 / (66 + 52 cos w + 2 cos 2w), the
 * latter in partial fractions. Scaled so that constants are kept exactly. */
static void inverse_filter(enum bspline_order order, double taps[MAX_TAPS + 1])
{
    int reach = reach_of(order);
    double total = 0;
    for (int k = 0; k <= reach; k++)
        taps[k] = 0;
    if (order == BSPLINE_CUBIC) {
        add_exponential(-4, 6, reach, taps);
    } else {
        double near = -13 + sqrt(105), far = -13 - sqrt(105);
        add_exponential(near, 120 / (near - far), reach, taps);
        add_exponential(far, -120 / (near - far), reach, taps);
    }
    for (int k = 0; k <= reach; k++)
        total += k ? 2 * taps[k] : taps[k];
    for (int k = 0; k <= reach; k++)
        taps[k] /= total;
}

static int mirror(int i, int n)
{
    if (n == 1)
        return 0;
    int period = 2 * (n - 1);
    i = ((i % period) + period) % period;
    return i < n ? i : period - i;
}

static int reserve(float **buffer, size_t *capacity, size_t needed)
{
    if (*capacity >= needed)
        return 0;
    float *grown = realloc(*buffer, needed * sizeof *grown);
    if (!grown)
        return error_memory("a patch of a photo");
    *buffer = grown;
    *capacity = needed;
    return 0;
}

/* Grey values of the patch and `reach` px around it. */
SIMD_CLONES static void load_grey(const struct photo *photo, int x0, int y0, int width, int height, float level,
                                  float *grey)
{
    int inside = x0 >= 0 && x0 + width <= photo->width;
    for (int y = 0; y < height; y++, grey += width) {
        const uint16_t *row = photo_row(photo, mirror(y0 + y, photo->height));
        if (inside)
            for (int x = 0; x < width; x++)
                grey[x] = (float)row[x0 + x] - level;
        else
            for (int x = 0; x < width; x++)
                grey[x] = (float)row[mirror(x0 + x, photo->width)] - level;
    }
}

/* out[x] = sum over k of taps[|k|] in[x + k step], for x in [0, n): BLOCK at a time, whose sums stay in registers; the
 * last block goes back over the one before. */
SIMD_CLONES static void filter_line(const float *in, ptrdiff_t step, int n, const float *taps, int reach, float *out)
{
    for (int next = 0; next < n && n >= BLOCK; next += BLOCK) {
        int begin = next + BLOCK <= n ? next : n - BLOCK;
        float sum[BLOCK];
        const float *middle = in + begin, *before = middle, *after = middle;
        for (int x = 0; x < BLOCK; x++)
            sum[x] = taps[0] * middle[x];
        for (int k = 1; k <= reach; k++) {
            const float tap = taps[k];
            before -= step;
            after += step;
            for (int x = 0; x < BLOCK; x++)
                sum[x] += tap * (before[x] + after[x]);
        }
        memcpy(out + begin, sum, sizeof sum);
    }
    for (int x = 0; x < n && n < BLOCK; x++) {
        float sum = taps[0] * in[x];
        for (int k = 1; k <= reach; k++)
            sum += taps[k] * (in[x - k * step] + in[x + k * step]);
        out[x] = sum;
    }
}

int patch_load(const struct photo *photo, double x_min, double y_min, double x_max, double y_max, float level,
               enum bspline_order order, struct patch *patch)
{
    int reach = reach_of(order);
    patch->order = order;
    patch->x0 = (int)floor(x_min) - BSPLINE_MARGIN;
    patch->y0 = (int)floor(y_min) - BSPLINE_MARGIN;
    patch->width = (int)floor(x_max) + BSPLINE_MARGIN + 2 - patch->x0;
    patch->height = (int)floor(y_max) + BSPLINE_MARGIN + 2 - patch->y0;
    int grey_width = patch->width + 2 * reach, grey_height = patch->height + 2 * reach;
    if (reserve(&patch->grey, &patch->grey_capacity, (size_t)grey_width * (size_t)grey_height) ||
        reserve(&patch->line, &patch->line_capacity, (size_t)grey_width) ||
        reserve(&patch->coefficients, &patch->coefficient_capacity, (size_t)patch->width * (size_t)patch->height))
        return -1;

    double exact[MAX_TAPS + 1];
    float taps[MAX_TAPS + 1];
    inverse_filter(order, exact);
    for (int k = 0; k <= reach; k++)
        taps[k] = (float)exact[k];
    load_grey(photo, patch->x0 - reach, patch->y0 - reach, grey_width, grey_height, level, patch->grey);
    for (int y = 0; y < patch->height; y++) {
        filter_line(patch->grey + (size_t)(y + reach) * (size_t)grey_width, grey_width, grey_width, taps, reach,
                    patch->line);
        filter_line(patch->line + reach, 1, patch->width, taps, reach,
                    patch->coefficients + (size_t)y * (size_t)patch->width);
    }
    return 0;
}

int patch_covers(const struct patch *patch, double x_min, double y_min, double x_max, double y_max)
{
    return patch->coefficients && x_min - BSPLINE_MARGIN >= patch->x0 && y_min - BSPLINE_MARGIN >= patch->y0 &&
           x_max + BSPLINE_MARGIN + 1 <= patch->x0 + patch->width &&
           y_max + BSPLINE_MARGIN + 1 <= patch->y0 + patch->height;
}

void patch_free(struct patch *patch)
{
    free(patch->coefficients);
    free(patch->grey);
    free(patch->line);
    *patch = (struct patch){0};
}

/* Pixels of white noise s2 give an interpolated value a variance of s2 times the sum of the squares of its weights:
 * least half-way between pixels, 1 on them. What a match leaves is divided by this (icgn.c) to tell the noise of a
 * pixel. In two dimensions the gain is the product of those along x and y. */
/* Sum of squares of the interpolated value's response to each pixel, at fraction t. */
static double noise_gain_at(enum bspline_order order, double t)
{
    double taps[MAX_TAPS + 1], gain = 0;
    inverse_filter(order, taps);
    int reach = reach_of(order), count = order == BSPLINE_CUBIC ? 4 : 6;
    float weights[6];
    if (order == BSPLINE_CUBIC)
        bspline_cubic_weights((float)t, weights);
    else
        bspline_quintic_weights((float)t, weights);
    for (int pixel = -reach; pixel < reach + count; pixel++) {
        double response = 0;
        for (int k = 0; k < count; k++)
            response += abs(pixel - k) <= reach ? weights[k] * taps[abs(pixel - k)] : 0;
        gain += response * response;
    }
    return gain;
}

enum { PHASES = 64 };
static double noise_gains[2][PHASES];

static void fill_noise_gains(void)
{
    for (int order = BSPLINE_CUBIC; order <= BSPLINE_QUINTIC; order++)
        for (int phase = 0; phase < PHASES; phase++)
            noise_gains[order][phase] = noise_gain_at((enum bspline_order)order, (double)phase / PHASES);
}

double bspline_noise_gain(enum bspline_order order, double x)
{
    static pthread_once_t once = PTHREAD_ONCE_INIT;
    pthread_once(&once, fill_noise_gains);
    return noise_gains[order][(int)((x - floor(x)) * PHASES + 0.5) % PHASES];
}
