/* The tracker's inner loop against the machine: share of the FMA peak and of the bandwidth of memory, both measured
 * here and now on the same core. */
#include <stdio.h>
#include <time.h>

#include "tests/dots.h"
#include "tracker/subset/kernel.h"
#include "pipeline/numbers/simd.h"

static double cpu_seconds(void)
{
    struct timespec now;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

SIMD_CLONES static float fma_chain(long rounds)
{
    enum { LANES = 256 };
    float a[LANES], sum = 0;
    for (int l = 0; l < LANES; l++)
        a[l] = (float)l;
    for (long r = 0; r < rounds; r++)
        for (int l = 0; l < LANES; l++)
            a[l] = __builtin_fmaf(a[l], 0.999f, 0.5f);
    for (int l = 0; l < LANES; l++)
        sum += a[l];
    return sum;
}

SIMD_CLONES static unsigned read_all(const unsigned *from, size_t n)
{
    unsigned sum = 0;
    for (size_t k = 0; k < n; k++)
        sum += from[k];
    return sum;
}

/* Largest of several rates: what the machine gives when nobody else has it. */
static double peak_flops(void)
{
    double best = 0;
    volatile float sink;
    for (int k = 0; k < 20; k++) {
        const long rounds = 200000;
        double begin = cpu_seconds();
        sink = fma_chain(rounds);
        best = fmax(best, 2.0 * 256 * (double)rounds / (cpu_seconds() - begin));
    }
    (void)sink;
    return best;
}

static double peak_bandwidth(void)
{
    const size_t n = (size_t)1 << 26; /* 256 MB, more than the caches hold */
    unsigned *from = malloc(n * sizeof *from);
    volatile unsigned sink;
    double best = 0;
    if (!from)
        abort();
    memset(from, 1, n * sizeof *from);
    for (int k = 0; k < 6; k++) {
        double begin = cpu_seconds();
        sink = read_all(from, n);
        best = fmax(best, (double)(n * sizeof *from) / (cpu_seconds() - begin));
    }
    (void)sink;
    free(from);
    return best;
}

/* Iterations of one subset again and again (hot in the cache), and of many in turn (from memory). */
static void kernel_rate(int subsets, enum bspline_order order, double flops_per_pixel, double flops, double bandwidth)
{
    const struct shape shape = {.cx = 100, .cy = 100, .radius = 80};
    const struct motion motion = {0.3, 0.4, 0.002};
    struct canvas canvas = canvas_make(201, 201, 0.8);
    struct dots dots = dots_make(90, DOTS_NORMAL, 77);
    struct subset *subset = calloc((size_t)subsets, sizeof *subset);
    struct patch patch = {0};
    struct kernel_sums sums;
    double best = INFINITY;
    canvas_add(&canvas, &dots, 100, 100, 0, 0);
    struct photo photo = canvas_photo(&canvas, 1, 0, 0.01, 1);
    for (int k = 0; subset && k < subsets; k++)
        if (subset_build(&photo, &shape, NULL, &subset[k]))
            abort();
    if (!subset || patch_load(&photo, 15, 15, 185, 185, 30000, order, &patch))
        abort();
    for (int round = 0; round < 12; round++) {
        double begin = cpu_seconds();
        for (int k = 0; k < 2000; k++)
            kernel_sums(&subset[k % subsets], &patch, &motion, &sums);
        best = fmin(best, (cpu_seconds() - begin) / 2000 / (double)subset[0].count);
    }
    printf("%-8s %4d subsets | %.2f ns per pixel, %.1f GFLOP/s = %.0f %% of the FMA peak of %.0f; planes %.1f GB/s = "
           "%.0f %% "
           "of the read bandwidth of %.0f\n",
           order == BSPLINE_CUBIC ? "cubic" : "quintic", subsets, 1e9 * best, 1e-9 * flops_per_pixel / best,
           100 * flops_per_pixel / best / flops, 1e-9 * flops, 16e-9 / best, 1600 / best / bandwidth, 1e-9 * bandwidth);
    for (int k = 0; k < subsets; k++)
        subset_free(&subset[k]);
    free(subset);
    patch_free(&patch);
    dots_free(&dots);
    canvas_free(&canvas);
    free(photo.pixels);
}

/* Operations per pixel, counted in the source (an FMA is two): positions 6, weights 2 x 13 (cubic) or 2 x 34 (quintic),
 * taps 2 x (16 + 4) or 2 x (36 + 6), products 12. */
int main(void)
{
    double flops = peak_flops(), bandwidth = peak_bandwidth();
    puts("Inner kernel, subset of radius 80 px, one thread");
    kernel_rate(1, BSPLINE_CUBIC, 84, flops, bandwidth);
    kernel_rate(400, BSPLINE_CUBIC, 84, flops, bandwidth);
    kernel_rate(1, BSPLINE_QUINTIC, 170, flops, bandwidth);
    return 0;
}
