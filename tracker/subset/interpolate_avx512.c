/* Sixteen pixels at a time. Gathers are slow: each pixel's four taps of a row are one load of 128 bits, four pixels
 * share a register, and one transposition at the end puts the pixels in order. */
#include "tracker/subset/interpolate.h"

#ifdef INTERPOLATE_X86
#include <immintrin.h>
#include <string.h>

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

/* Sixteen pixels of a line: the whole part of their positions as offsets of the first tap, and the fractions. Those
 * beyond the end repeat the first pixel. */
INLINE __mmask16 place(const struct patch *patch, const struct line *line, int first, int count, int reach,
                       int offset[16], __m512 *fx, __m512 *fy)
{
    const __m512 ramp = _mm512_set_ps(15, 14, 13, 12, 11, 10, 9, 8, 7, 6, 5, 4, 3, 2, 1, 0);
    __mmask16 there = count < 16 ? (__mmask16)((1u << count) - 1) : 0xffff;
    __m512 begin = _mm512_set1_ps((float)first), k = _mm512_mask_add_ps(begin, there, begin, ramp);
    __m512 x = _mm512_add_ps(_mm512_set1_ps(line->x), _mm512_mul_ps(k, _mm512_set1_ps(line->step_x)));
    __m512 y = _mm512_add_ps(_mm512_set1_ps(line->y), _mm512_mul_ps(k, _mm512_set1_ps(line->step_y)));
    __m512i ix = _mm512_cvttps_epi32(x), iy = _mm512_cvttps_epi32(y), back = _mm512_set1_epi32(reach);
    __m512i rows = _mm512_mullo_epi32(_mm512_sub_epi32(iy, back), _mm512_set1_epi32(patch->width));
    _mm512_store_si512(offset, _mm512_add_epi32(rows, _mm512_sub_epi32(ix, back)));
    *fx = _mm512_sub_ps(x, _mm512_cvtepi32_ps(ix));
    *fy = _mm512_sub_ps(y, _mm512_cvtepi32_ps(iy));
    return there;
}

/* Sums over four taps, each register holding those of four pixels: times their weights, in the order of the pixels. */
INLINE __m512 weigh(__m512 a, __m512 b, __m512 c, __m512 d, const __m512 w[4])
{
    __m512 ab = _mm512_unpacklo_ps(a, b), cd = _mm512_unpacklo_ps(c, d);
    __m512 sum = _mm512_mul_ps(_mm512_shuffle_ps(ab, cd, 0x44), w[0]);
    sum = _mm512_fmadd_ps(_mm512_shuffle_ps(ab, cd, 0xee), w[1], sum);
    ab = _mm512_unpackhi_ps(a, b);
    cd = _mm512_unpackhi_ps(c, d);
    sum = _mm512_fmadd_ps(_mm512_shuffle_ps(ab, cd, 0x44), w[2], sum);
    return _mm512_fmadd_ps(_mm512_shuffle_ps(ab, cd, 0xee), w[3], sum);
}

TARGET void interpolate_cubic_avx512(const struct patch *patch, const struct line *line, int begin, int count, float *t)
{
    int offset[16] __attribute__((aligned(64)));
    for (int i = 0; i < count; i += 16) {
        __m512 fx, fy;
        __mmask16 there = place(patch, line, begin + i, count - i, 1, offset, &fx, &fy);
        struct weights wx = cubic_weights(fx), wy = cubic_weights(fy);
        __m512 sum = weigh(PIXELS(0), PIXELS(1), PIXELS(2), PIXELS(3), wx.w);
        _mm512_mask_storeu_ps(t + i, there, sum);
    }
}

/* ---- quintic: four taps as above, the last two of a row as pairs, eight pixels to a register ---- */

struct six {
    __m512 w[6];
};

INLINE __m512 quintic_inner(__m512 a)
{
    __m512 q = _mm512_mul_ps(a, a), sum = _mm512_fnmadd_ps(a, _mm512_set1_ps(1.0f / 12), _mm512_set1_ps(0.25f));
    sum = _mm512_fmadd_ps(q, sum, _mm512_set1_ps(-0.5f));
    return _mm512_fmadd_ps(q, sum, _mm512_set1_ps(0.55f));
}

INLINE __m512 quintic_middle(__m512 b)
{
    __m512 sum = _mm512_fmadd_ps(b, _mm512_set1_ps(1.0f / 24), _mm512_set1_ps(-0.375f));
    sum = _mm512_fmadd_ps(b, sum, _mm512_set1_ps(1.25f));
    sum = _mm512_fmadd_ps(b, sum, _mm512_set1_ps(-1.75f));
    sum = _mm512_fmadd_ps(b, sum, _mm512_set1_ps(0.625f));
    return _mm512_fmadd_ps(b, sum, _mm512_set1_ps(0.425f));
}

/* At c = 3 - r. */
INLINE __m512 quintic_outer(__m512 r)
{
    __m512 q = _mm512_mul_ps(r, r);
    return _mm512_mul_ps(_mm512_mul_ps(_mm512_mul_ps(q, q), r), _mm512_set1_ps(1.0f / 120));
}

INLINE struct six quintic_weights(__m512 t)
{
    const __m512 one = _mm512_set1_ps(1);
    __m512 r = _mm512_sub_ps(one, t);
    return (struct six){{quintic_outer(r), quintic_middle(_mm512_add_ps(t, one)), quintic_inner(t), quintic_inner(r),
                         quintic_middle(_mm512_add_ps(r, one)), quintic_outer(t)}};
}

INLINE __m512 six_rows(const float *base, ptrdiff_t width, const int *offset, const struct six *wy, __m512i lanes)
{
    __m512 sum = _mm512_setzero_ps();
#pragma GCC unroll 6
    for (int k = 0; k < 6; k++, base += width)
        sum = _mm512_fmadd_ps(four_rows(base, offset), _mm512_permutexvar_ps(lanes, wy->w[k]), sum);
    return sum;
}

INLINE __m512 pair(__m512 v, __mmask16 mask, const float *from)
{
    double two;
    memcpy(&two, from, sizeof two);
    return _mm512_castpd_ps(_mm512_mask_broadcastsd_pd(_mm512_castps_pd(v), (__mmask8)mask, _mm_set_sd(two)));
}

/* The last two taps of the rows of eight pixels. */
INLINE __m512 six_pairs(const float *base, ptrdiff_t width, const int *offset, const struct six *wy, __m512i lanes)
{
    __m512 sum = _mm512_setzero_ps();
#pragma GCC unroll 6
    for (int k = 0; k < 6; k++, base += width) {
        __m512 v = pair(_mm512_setzero_ps(), 0xff, base + offset[0]);
        v = pair(v, 0x02, base + offset[1]);
        v = pair(v, 0x04, base + offset[2]);
        v = pair(v, 0x08, base + offset[3]);
        v = pair(v, 0x10, base + offset[4]);
        v = pair(v, 0x20, base + offset[5]);
        v = pair(v, 0x40, base + offset[6]);
        v = pair(v, 0x80, base + offset[7]);
        sum = _mm512_fmadd_ps(v, _mm512_permutexvar_ps(lanes, wy->w[k]), sum);
    }
    return sum;
}

TARGET void interpolate_quintic_avx512(const struct patch *patch, const struct line *line, int begin, int count,
                                       float *t)
{
    const __m512i quarter = _mm512_set_epi32(12, 12, 12, 12, 8, 8, 8, 8, 4, 4, 4, 4, 0, 0, 0, 0);
    const __m512i twice = _mm512_set_epi32(7, 7, 6, 6, 5, 5, 4, 4, 3, 3, 2, 2, 1, 1, 0, 0);
    const __m512i even = _mm512_set_epi32(30, 28, 26, 24, 22, 20, 18, 16, 14, 12, 10, 8, 6, 4, 2, 0);
    const __m512i one = _mm512_set1_epi32(1);
    const ptrdiff_t width = patch->width;
    int offset[16] __attribute__((aligned(64)));
    for (int i = 0; i < count; i += 16) {
        __m512 fx, fy, four[4];
        __mmask16 there = place(patch, line, begin + i, count - i, 2, offset, &fx, &fy);
        struct six wx = quintic_weights(fx), wy = quintic_weights(fy);
        __m512i lanes = quarter;
        for (int m = 0; m < 4; m++, lanes = _mm512_add_epi32(lanes, one))
            four[m] = six_rows(patch->coefficients, width, offset + m, &wy, lanes);
        __m512 low = six_pairs(patch->coefficients + 4, width, offset, &wy, twice);
        __m512 high =
            six_pairs(patch->coefficients + 4, width, offset + 8, &wy, _mm512_add_epi32(twice, _mm512_set1_epi32(8)));
        __m512 sum = weigh(four[0], four[1], four[2], four[3], wx.w);
        sum = _mm512_fmadd_ps(_mm512_permutex2var_ps(low, even, high), wx.w[4], sum);
        sum = _mm512_fmadd_ps(_mm512_permutex2var_ps(low, _mm512_add_epi32(even, one), high), wx.w[5], sum);
        _mm512_mask_storeu_ps(t + i, there, sum);
    }
}
#endif
