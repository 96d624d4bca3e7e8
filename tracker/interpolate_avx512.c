/* Sixteen pixels at a time. Gathers are slow: each pixel's four taps of a row are one load of 128 bits, four pixels
 * share a register, and one transposition at the end puts the pixels in order. */
#include "tracker/interpolate.h"

#ifdef INTERPOLATE_X86
#include <immintrin.h>

#define TARGET __attribute__((target("avx512f,avx512dq")))
#define INLINE static inline __attribute__((always_inline)) TARGET

struct weights {
    __m512 w[4];
};

/* bspline_cubic_weights() of 16 fractions. */
INLINE struct weights cubic_weights(__m512 t)
{
    const __m512 one = _mm512_set1_ps(1), sixth = _mm512_set1_ps(1.0f / 6), two_thirds = _mm512_set1_ps(2.0f / 3);
    const __m512 half = _mm512_set1_ps(0.5f);
    __m512 r = _mm512_sub_ps(one, t), t2 = _mm512_mul_ps(t, t), r2 = _mm512_mul_ps(r, r);
    return (struct weights){
        {_mm512_mul_ps(_mm512_mul_ps(r2, r), sixth), _mm512_fnmadd_ps(t2, _mm512_fnmadd_ps(half, t, one), two_thirds),
         _mm512_fnmadd_ps(r2, _mm512_fnmadd_ps(half, r, one), two_thirds), _mm512_mul_ps(_mm512_mul_ps(t2, t), sixth)}};
}

/* One row of taps of the pixels m, 4 + m, 8 + m, 12 + m: one in each quarter. */
INLINE __m512 four_rows(const float *row, const int *offset)
{
    __m512 v = _mm512_broadcast_f32x4(_mm_loadu_ps(row + offset[0]));
    v = _mm512_mask_broadcast_f32x4(v, 0x00f0, _mm_loadu_ps(row + offset[4]));
    v = _mm512_mask_broadcast_f32x4(v, 0x0f00, _mm_loadu_ps(row + offset[8]));
    return _mm512_mask_broadcast_f32x4(v, 0xf000, _mm_loadu_ps(row + offset[12]));
}

/* The four rows of those pixels, added with their weights. */
INLINE __m512 four_pixels(const float *base, ptrdiff_t width, const int *offset, __m512 w0, __m512 w1, __m512 w2,
                          __m512 w3)
{
    __m512 sum = _mm512_mul_ps(four_rows(base, offset), w0);
    sum = _mm512_fmadd_ps(four_rows(base + width, offset), w1, sum);
    sum = _mm512_fmadd_ps(four_rows(base + 2 * width, offset), w2, sum);
    return _mm512_fmadd_ps(four_rows(base + 3 * width, offset), w3, sum);
}

#define PIXELS(m)                                                                                                      \
    four_pixels(patch->coefficients, patch->width, offset + (m), _mm512_permute_ps(wy.w[0], 0x55 * (m)),               \
                _mm512_permute_ps(wy.w[1], 0x55 * (m)), _mm512_permute_ps(wy.w[2], 0x55 * (m)),                        \
                _mm512_permute_ps(wy.w[3], 0x55 * (m)))

TARGET void interpolate_cubic_avx512(const struct patch *patch, const struct line *line, int begin, int count, float *t)
{
    const __m512 ramp = _mm512_set_ps(15, 14, 13, 12, 11, 10, 9, 8, 7, 6, 5, 4, 3, 2, 1, 0);
    int offset[16] __attribute__((aligned(64)));
    for (int i = 0; i < count; i += 16) {
        __mmask16 there = count - i < 16 ? (__mmask16)((1u << (count - i)) - 1) : 0xffff;
        __m512 k = _mm512_maskz_add_ps(there, _mm512_set1_ps((float)(begin + i)), ramp);
        if (there != 0xffff) /* the others repeat the first pixel */
            k = _mm512_mask_mov_ps(_mm512_set1_ps((float)(begin + i)), there, k);
        __m512 x = _mm512_add_ps(_mm512_set1_ps(line->x), _mm512_mul_ps(k, _mm512_set1_ps(line->step_x)));
        __m512 y = _mm512_add_ps(_mm512_set1_ps(line->y), _mm512_mul_ps(k, _mm512_set1_ps(line->step_y)));
        __m512i ix = _mm512_cvttps_epi32(x), iy = _mm512_cvttps_epi32(y), one = _mm512_set1_epi32(1);
        struct weights wx = cubic_weights(_mm512_sub_ps(x, _mm512_cvtepi32_ps(ix)));
        struct weights wy = cubic_weights(_mm512_sub_ps(y, _mm512_cvtepi32_ps(iy)));
        __m512i rows = _mm512_mullo_epi32(_mm512_sub_epi32(iy, one), _mm512_set1_epi32(patch->width));
        _mm512_store_si512(offset, _mm512_add_epi32(rows, _mm512_sub_epi32(ix, one)));

        __m512 a = PIXELS(0), b = PIXELS(1), c = PIXELS(2), d = PIXELS(3);
        __m512 ab = _mm512_unpacklo_ps(a, b), cd = _mm512_unpacklo_ps(c, d);
        __m512 sum = _mm512_mul_ps(_mm512_shuffle_ps(ab, cd, 0x44), wx.w[0]);
        sum = _mm512_fmadd_ps(_mm512_shuffle_ps(ab, cd, 0xee), wx.w[1], sum);
        ab = _mm512_unpackhi_ps(a, b);
        cd = _mm512_unpackhi_ps(c, d);
        sum = _mm512_fmadd_ps(_mm512_shuffle_ps(ab, cd, 0x44), wx.w[2], sum);
        sum = _mm512_fmadd_ps(_mm512_shuffle_ps(ab, cd, 0xee), wx.w[3], sum);
        _mm512_mask_storeu_ps(t + i, there, sum);
    }
}
#endif
