/* Eight pixels at a time, two per register, as in interpolate_avx512.c; what is left over is done in plain C. */
#include "tracker/subset/interpolate.h"

#ifdef INTERPOLATE_X86
#include <immintrin.h>

#define TARGET __attribute__((target("avx2,fma")))
#define INLINE static inline __attribute__((always_inline)) TARGET

struct weights {
    __m256 w[4];
};

INLINE struct weights cubic_weights(__m256 t)
{
    const __m256 one = _mm256_set1_ps(1), sixth = _mm256_set1_ps(1.0f / 6), two_thirds = _mm256_set1_ps(2.0f / 3);
    const __m256 half = _mm256_set1_ps(0.5f);
    __m256 r = _mm256_sub_ps(one, t), t2 = _mm256_mul_ps(t, t), r2 = _mm256_mul_ps(r, r);
    return (struct weights){
        {_mm256_mul_ps(_mm256_mul_ps(r2, r), sixth), _mm256_fnmadd_ps(t2, _mm256_fnmadd_ps(half, t, one), two_thirds),
         _mm256_fnmadd_ps(r2, _mm256_fnmadd_ps(half, r, one), two_thirds), _mm256_mul_ps(_mm256_mul_ps(t2, t), sixth)}};
}

/* One row of taps of the pixels m and 4 + m. */
INLINE __m256 two_rows(const float *row, const int *offset)
{
    return _mm256_insertf128_ps(_mm256_castps128_ps256(_mm_loadu_ps(row + offset[0])), _mm_loadu_ps(row + offset[4]),
                                1);
}

INLINE __m256 two_pixels(const float *base, ptrdiff_t width, const int *offset, __m256 w0, __m256 w1, __m256 w2,
                         __m256 w3)
{
    __m256 sum = _mm256_mul_ps(two_rows(base, offset), w0);
    sum = _mm256_fmadd_ps(two_rows(base + width, offset), w1, sum);
    sum = _mm256_fmadd_ps(two_rows(base + 2 * width, offset), w2, sum);
    return _mm256_fmadd_ps(two_rows(base + 3 * width, offset), w3, sum);
}

#define PIXELS(m)                                                                                                      \
    two_pixels(patch->coefficients, patch->width, offset + (m), _mm256_permute_ps(wy.w[0], 0x55 * (m)),                \
               _mm256_permute_ps(wy.w[1], 0x55 * (m)), _mm256_permute_ps(wy.w[2], 0x55 * (m)),                         \
               _mm256_permute_ps(wy.w[3], 0x55 * (m)))

TARGET void interpolate_cubic_avx2(const struct patch *patch, const struct line *line, int begin, int count, float *t)
{
    const __m256 ramp = _mm256_set_ps(7, 6, 5, 4, 3, 2, 1, 0);
    int offset[8] __attribute__((aligned(32))), i = 0;
    for (; i + 8 <= count; i += 8) {
        __m256 k = _mm256_add_ps(_mm256_set1_ps((float)(begin + i)), ramp);
        __m256 x = _mm256_add_ps(_mm256_set1_ps(line->x), _mm256_mul_ps(k, _mm256_set1_ps(line->step_x)));
        __m256 y = _mm256_add_ps(_mm256_set1_ps(line->y), _mm256_mul_ps(k, _mm256_set1_ps(line->step_y)));
        __m256i ix = _mm256_cvttps_epi32(x), iy = _mm256_cvttps_epi32(y), one = _mm256_set1_epi32(1);
        struct weights wx = cubic_weights(_mm256_sub_ps(x, _mm256_cvtepi32_ps(ix)));
        struct weights wy = cubic_weights(_mm256_sub_ps(y, _mm256_cvtepi32_ps(iy)));
        __m256i rows = _mm256_mullo_epi32(_mm256_sub_epi32(iy, one), _mm256_set1_epi32(patch->width));
        _mm256_store_si256((__m256i *)offset, _mm256_add_epi32(rows, _mm256_sub_epi32(ix, one)));

        __m256 a = PIXELS(0), b = PIXELS(1), c = PIXELS(2), d = PIXELS(3);
        __m256 ab = _mm256_unpacklo_ps(a, b), cd = _mm256_unpacklo_ps(c, d);
        __m256 sum = _mm256_mul_ps(_mm256_shuffle_ps(ab, cd, 0x44), wx.w[0]);
        sum = _mm256_fmadd_ps(_mm256_shuffle_ps(ab, cd, 0xee), wx.w[1], sum);
        ab = _mm256_unpackhi_ps(a, b);
        cd = _mm256_unpackhi_ps(c, d);
        sum = _mm256_fmadd_ps(_mm256_shuffle_ps(ab, cd, 0x44), wx.w[2], sum);
        sum = _mm256_fmadd_ps(_mm256_shuffle_ps(ab, cd, 0xee), wx.w[3], sum);
        _mm256_storeu_ps(t + i, sum);
    }
    if (i < count)
        interpolate_cubic_plain(patch, line, begin + i, count - i, t + i);
}
#endif
