#include "tracker/kernel.h"

/* Where the pixels of a run land in the patch: (x + i step_x, y + i step_y). */
struct line {
    float x, y, step_x, step_y;
};

static struct line line_of_run(const struct subset *subset, const struct patch *patch, const struct motion *motion,
                               const struct run *run)
{
    double c = cos(motion->angle), s = sin(motion->angle);
    double dx = run->x - subset->shape.cx, dy = run->y - subset->shape.cy;
    return (struct line){(float)(subset->shape.cx + motion->u + c * dx + s * dy - patch->x0),
                         (float)(subset->shape.cy + motion->v - s * dx + c * dy - patch->y0), (float)c, (float)-s};
}

static float interpolate_cubic(const float *coefficients, ptrdiff_t width, float x, float y)
{
    int ix = (int)x, iy = (int)y; /* x, y >= BSPLINE_MARGIN - 1 */
    const float *row = coefficients + (iy - 1) * width + ix - 1;
    float wx[4], wy[4], value = 0;
    bspline_cubic_weights(x - (float)ix, wx);
    bspline_cubic_weights(y - (float)iy, wy);
    for (int k = 0; k < 4; k++, row += width)
        value += wy[k] * (wx[0] * row[0] + wx[1] * row[1] + wx[2] * row[2] + wx[3] * row[3]);
    return value;
}

static float interpolate_quintic(const float *coefficients, ptrdiff_t width, float x, float y)
{
    int ix = (int)x, iy = (int)y;
    const float *row = coefficients + (iy - 2) * width + ix - 2;
    float wx[6], wy[6], value = 0;
    bspline_quintic_weights(x - (float)ix, wx);
    bspline_quintic_weights(y - (float)iy, wy);
    for (int k = 0; k < 6; k++, row += width)
        value += wy[k] *
                 (wx[0] * row[0] + wx[1] * row[1] + wx[2] * row[2] + wx[3] * row[3] + wx[4] * row[4] + wx[5] * row[5]);
    return value;
}

/* Sums of one run: few enough pixels for single precision. */
static void add_products(const float *t, const float *planes, size_t plane_size, int count, struct kernel_sums *sums)
{
    const float *jx = planes, *jy = jx + plane_size, *ja = jy + plane_size, *grey = ja + plane_size;
    float one = 0, square = 0, x = 0, y = 0, a = 0, g = 0;
    for (int i = 0; i < count; i++) {
        one += t[i];
        square += t[i] * t[i];
        x += t[i] * jx[i];
        y += t[i] * jy[i];
        a += t[i] * ja[i];
        g += t[i] * grey[i];
    }
    sums->one += one;
    sums->square += square;
    sums->plane[SUBSET_ZX] += x;
    sums->plane[SUBSET_ZY] += y;
    sums->plane[SUBSET_ZA] += a;
    sums->plane[SUBSET_GREY] += g;
}

enum { STRETCH = 128 }; /* pixels at a time */

static void add_stretch(const struct patch *patch, const struct line *line, int begin, int count, const float *planes,
                        size_t plane_size, struct kernel_sums *sums)
{
    float t[STRETCH];
    for (int i = 0; i < count; i++) {
        float x = line->x + (float)(begin + i) * line->step_x, y = line->y + (float)(begin + i) * line->step_y;
        t[i] = patch->order == BSPLINE_CUBIC ? interpolate_cubic(patch->coefficients, patch->width, x, y)
                                             : interpolate_quintic(patch->coefficients, patch->width, x, y);
    }
    add_products(t, planes, plane_size, count, sums);
}

void kernel_sums(const struct subset *subset, const struct patch *patch, const struct motion *motion,
                 struct kernel_sums *sums)
{
    *sums = (struct kernel_sums){0};
    for (size_t k = 0; k < subset->run_count; k++) {
        const struct run *run = &subset->runs[k];
        struct line line = line_of_run(subset, patch, motion, run);
        for (int begin = 0; begin < run->count; begin += STRETCH) {
            int count = run->count - begin < STRETCH ? run->count - begin : STRETCH;
            add_stretch(patch, &line, begin, count, subset->planes + run->offset + begin, subset->count, sums);
        }
    }
}
