#include "tracker/interpolate.h"

#include "tracker/simd.h"

static float cubic_at(const float *coefficients, ptrdiff_t width, float x, float y)
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

static float quintic_at(const float *coefficients, ptrdiff_t width, float x, float y)
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

void interpolate_cubic_plain(const struct patch *patch, const struct line *line, int begin, int count, float *t)
{
    for (int i = 0; i < count; i++)
        t[i] = cubic_at(patch->coefficients, patch->width, line->x + (float)(begin + i) * line->step_x,
                        line->y + (float)(begin + i) * line->step_y);
}

SIMD_CLONES void interpolate_quintic_plain(const struct patch *patch, const struct line *line, int begin, int count,
                                           float *t)
{
    for (int i = 0; i < count; i++)
        t[i] = quintic_at(patch->coefficients, patch->width, line->x + (float)(begin + i) * line->step_x,
                          line->y + (float)(begin + i) * line->step_y);
}

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
    if (order == BSPLINE_QUINTIC)
        return interpolate_quintic_plain;
    level = level < limit ? level : limit;
#ifdef INTERPOLATE_X86
    if (level == INTERPOLATE_AVX512)
        return interpolate_cubic_avx512;
    if (level == INTERPOLATE_AVX2)
        return interpolate_cubic_avx2;
#endif
    return interpolate_cubic_plain;
}
