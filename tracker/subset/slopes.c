/* Finite differences. The plain slope is the central difference of sixth order, (3/4, -3/20, 1/60) on pixels 1, 2 and 3
 * away: within 1 % for waves of six pixels, 7 % for waves of four. The smoothed photo is that filtered by 1 2 1 / 4
 * along x and y; its slopes are the instruments Z of subset.c. The Laplacian is the five-point one of the smoothed
 * photo: to first order a change of focus adds a multiple of it (a Gaussian blur is diffusion). */
#include "tracker/subset/slopes.h"

#include <stdlib.h>

#include "pipeline/speak/error.h"
#include "pipeline/numbers/simd.h"

/* Central differences of sixth order; smoothing by 1 2 1 in both directions. */
static const float difference[SLOPES_REACH + 1] = {0, 0.75f, -0.15f, 1.0f / 60};
static const float binomial[2] = {0.5f, 0.25f};
enum { BINOMIAL_REACH = 1, MARGIN = SLOPES_REACH + BINOMIAL_REACH };

static int clamp(int i, int n)
{
    return i < 0 ? 0 : i >= n ? n - 1 : i;
}

static void load_row(const struct photo *photo, int x0, int y, int count, float level, float *grey)
{
    const uint16_t *row = photo_row(photo, clamp(y, photo->height));
    if (x0 >= 0 && x0 + count <= photo->width)
        for (int x = 0; x < count; x++)
            grey[x] = (float)row[x0 + x] - level;
    else
        for (int x = 0; x < count; x++)
            grey[x] = (float)row[clamp(x0 + x, photo->width)] - level;
}

/* out[x] = sum of taps[|k|] in[x + k step]. */
SIMD_CLONES static void smooth_row(const float *in, ptrdiff_t step, int count, float *restrict out)
{
    const float b0 = binomial[0], b1 = binomial[1];
    for (int x = 0; x < count; x++)
        out[x] = b0 * in[x] + b1 * (in[x - step] + in[x + step]);
}

int slopes_load(const struct photo *photo, int x0, int y0, int x1, int y1, float level, struct slopes *slopes)
{
    *slopes = (struct slopes){.x0 = x0 - MARGIN, .y0 = y0 - MARGIN};
    slopes->width = x1 + 1 + MARGIN - slopes->x0;
    slopes->height = y1 + 1 + MARGIN - slopes->y0;
    size_t width = (size_t)slopes->width, area = width * (size_t)slopes->height;
    slopes->grey = malloc((2 * area + width) * sizeof *slopes->grey);
    if (!slopes->grey)
        return error_memory("the slopes of a subset");
    slopes->smooth = slopes->grey + area;
    float *line = slopes->smooth + area;
    for (int y = 0; y < slopes->height; y++)
        load_row(photo, slopes->x0, slopes->y0 + y, slopes->width, level, slopes->grey + (size_t)y * width);
    for (int y = BINOMIAL_REACH; y < slopes->height - BINOMIAL_REACH; y++) {
        smooth_row(slopes->grey + (size_t)y * width, slopes->width, slopes->width, line);
        smooth_row(line + BINOMIAL_REACH, 1, slopes->width - 2 * BINOMIAL_REACH,
                   slopes->smooth + (size_t)y * width + BINOMIAL_REACH);
    }
    return 0;
}

void slopes_free(struct slopes *slopes)
{
    free(slopes->grey);
    *slopes = (struct slopes){0};
}

SIMD_CLONES static void differ(const float *in, ptrdiff_t step, int count, float *restrict out)
{
    const float d1 = difference[1], d2 = difference[2], d3 = difference[3];
    for (int x = 0; x < count; x++)
        out[x] = d1 * (in[x + step] - in[x - step]) + d2 * (in[x + 2 * step] - in[x - 2 * step]) +
                 d3 * (in[x + 3 * step] - in[x - 3 * step]);
}

SIMD_CLONES static void add_second_differences(const float *in, ptrdiff_t width, int count, float *restrict out)
{
    for (int x = 0; x < count; x++)
        out[x] = in[x + 1] + in[x - 1] + in[x + width] + in[x - width] - 4 * in[x];
}

static size_t at(const struct slopes *slopes, int x, int y)
{
    return (size_t)(y - slopes->y0) * (size_t)slopes->width + (size_t)(x - slopes->x0);
}

const float *slopes_grey(const struct slopes *slopes, int x, int y)
{
    return slopes->grey + at(slopes, x, y);
}

void slopes_plain(const struct slopes *slopes, int x, int y, int count, float *gx, float *gy)
{
    const float *grey = slopes_grey(slopes, x, y);
    differ(grey, 1, count, gx);
    differ(grey, slopes->width, count, gy);
}

void slopes_smooth(const struct slopes *slopes, int x, int y, int count, float *gx, float *gy)
{
    const float *smooth = slopes->smooth + at(slopes, x, y);
    differ(smooth, 1, count, gx);
    differ(smooth, slopes->width, count, gy);
}

void slopes_laplacian(const struct slopes *slopes, int x, int y, int count, float *laplacian)
{
    add_second_differences(slopes->smooth + at(slopes, x, y), slopes->width, count, laplacian);
}

/* The difference after smoothing along its own direction: odd, taps at 1 .. MARGIN. */
static double smooth_difference(int k)
{
    double tap = 0;
    for (int j = -BINOMIAL_REACH; j <= BINOMIAL_REACH; j++) {
        int i = k - j;
        if (i && abs(i) <= SLOPES_REACH)
            tap += binomial[abs(j)] * (i > 0 ? difference[i] : -difference[-i]);
    }
    return tap;
}

/* White noise of variance 1 in the pixels is seen by a smooth slope s and a plain slope p of the same pixel: their
 * covariance is the sum of the products of their taps along the direction of the slope. Across it the plain slope looks
 * at its own row only, where the smooth one has the binomial's middle tap. */
double slopes_noise(void)
{
    double along = 0;
    for (int k = 1; k <= SLOPES_REACH; k++)
        along += 2 * smooth_difference(k) * difference[k];
    return along * binomial[0];
}
