/* In plain C, and which of the versions is taken: the widest registers that this machine has. All of them compute
 * positions by the same operations in single precision, so that a pixel falls between the same four (six) taps
 * everywhere; sums are in another order, which moves values by rounding. */
#include "tracker/subset/interpolate.h"

#include "pipeline/numbers/simd.h"

/* The loops are written so that a compiler can take several pixels at a time: weights and taps by name, no aliases. */
void interpolate_cubic_plain(const struct patch *patch, const struct line *line, int begin, int count,
                             float *restrict t)
{
    const float *restrict c = patch->coefficients;
    const int width = patch->width;
    for (int i = 0; i < count; i++) {
        float x = line->x + (float)(begin + i) * line->step_x, y = line->y + (float)(begin + i) * line->step_y;
        int ix = (int)x, iy = (int)y, at = (iy - 1) * width + ix - 1; /* x, y >= BSPLINE_MARGIN - 1 */
        float wx[4], wy[4], value = 0;
        bspline_cubic_weights(x - (float)ix, wx);
        bspline_cubic_weights(y - (float)iy, wy);
        for (int k = 0; k < 4; k++, at += width)
            value += wy[k] * (wx[0] * c[at] + wx[1] * c[at + 1] + wx[2] * c[at + 2] + wx[3] * c[at + 3]);
        t[i] = value;
    }
}

/* One row of six taps. */
#define ROW(k)                                                                                                         \
    (x0 * c[at + (k)*width] + x1 * c[at + (k)*width + 1] + x2 * c[at + (k)*width + 2] + x3 * c[at + (k)*width + 3] +   \
     x4 * c[at + (k)*width + 4] + x5 * c[at + (k)*width + 5])

SIMD_CLONES void interpolate_quintic_plain(const struct patch *patch, const struct line *line, int begin, int count,
                                           float *restrict t)
{
    const float *restrict c = patch->coefficients;
    const int width = patch->width;
    const float x_first = line->x, y_first = line->y, step_x = line->step_x, step_y = line->step_y;
#pragma omp simd
    for (int i = 0; i < count; i++) {
        float x = x_first + (float)(begin + i) * step_x, y = y_first + (float)(begin + i) * step_y;
        int ix = (int)x, iy = (int)y, at = (iy - 2) * width + ix - 2;
        float fx = x - (float)ix, fy = y - (float)iy, gx = 1 - fx, gy = 1 - fy;
        float x0 = bspline_quintic_outer(fx + 2), x1 = bspline_quintic_middle(fx + 1), x2 = bspline_quintic_inner(fx);
        float x5 = bspline_quintic_outer(gx + 2), x4 = bspline_quintic_middle(gx + 1), x3 = bspline_quintic_inner(gx);
        float outer = bspline_quintic_outer(fy + 2) * ROW(0) + bspline_quintic_outer(gy + 2) * ROW(5);
        float middle = bspline_quintic_middle(fy + 1) * ROW(1) + bspline_quintic_middle(gy + 1) * ROW(4);
        t[i] = outer + middle + (bspline_quintic_inner(fy) * ROW(2) + bspline_quintic_inner(gy) * ROW(3));
    }
}
#undef ROW

static enum interpolate_level limit = INTERPOLATE_AVX512;

enum interpolate_level interpolate_machine(void)
{
#ifdef INTERPOLATE_X86
    if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq"))
        return INTERPOLATE_AVX512;
    if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma"))
        return INTERPOLATE_AVX2;
#endif
    return INTERPOLATE_PLAIN;
}

void interpolate_limit(enum interpolate_level level)
{
    limit = level;
}

interpolate_line *interpolate_chosen(enum bspline_order order)
{
    enum interpolate_level level = interpolate_machine();
    level = level < limit ? level : limit;
#ifdef INTERPOLATE_X86
    if (level == INTERPOLATE_AVX512)
        return order == BSPLINE_CUBIC ? interpolate_cubic_avx512 : interpolate_quintic_avx512;
    if (level == INTERPOLATE_AVX2 && order == BSPLINE_CUBIC)
        return interpolate_cubic_avx2;
#endif
    return order == BSPLINE_CUBIC ? interpolate_cubic_plain : interpolate_quintic_plain;
}
