/* The searched photo at the warped pixels of a run: plain C, and the same for AVX2 and AVX-512, chosen when the program
 * runs. Positions are computed by the same operations everywhere; values agree to rounding. */
#ifndef TRACKER_INTERPOLATE_H
#define TRACKER_INTERPOLATE_H

#include "tracker/subset/bspline.h"

/* Where the pixels of a run land in the patch: (x + i step_x, y + i step_y). */
struct line {
    float x, y, step_x, step_y;
};

/* t[i] = patch at pixel begin + i of the line, i < count. All of them lie inside what the patch covers: nothing is
 * checked here. t may be written up to `count` only. */
typedef void interpolate_line(const struct patch *patch, const struct line *line, int begin, int count, float *t);

interpolate_line interpolate_cubic_plain, interpolate_quintic_plain;
#if defined(__x86_64__) && defined(__GNUC__)
#define INTERPOLATE_X86
interpolate_line interpolate_cubic_avx2, interpolate_cubic_avx512, interpolate_quintic_avx512; /* where there */
#endif

enum interpolate_level { INTERPOLATE_PLAIN, INTERPOLATE_AVX2, INTERPOLATE_AVX512 };
/* The best that this machine has. */
enum interpolate_level interpolate_machine(void);
/* For tests and benches: use at most this from now on. Not while threads run. */
void interpolate_limit(enum interpolate_level level);
interpolate_line *interpolate_chosen(enum bspline_order order);

#endif
