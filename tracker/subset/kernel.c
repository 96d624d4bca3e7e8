/* Most of the tracker's time is spent here: T, the searched photo at the warped pixels of a subset, and the dot
 * products Z'T, grey'T, 1'T and T'T that an iteration needs (icgn.c). A rotation is a shear along each run, so that the
 * pixels of a run lie on a straight line with even steps. */
#include "tracker/subset/kernel.h"

#include "pipeline/numbers/simd.h"

enum { STRETCH = 128, LANES = 16 }; /* pixels at a time; partial sums, the same on every machine */

struct line kernel_line(const struct subset *subset, const struct patch *patch, const struct motion *motion,
                        const struct run *run)
{
    double c = cos(motion->angle), s = sin(motion->angle);
    double dx = run->x - subset->shape.cx, dy = run->y - subset->shape.cy;
    return (struct line){(float)(subset->shape.cx + motion->u + c * dx + s * dy - patch->x0),
                         (float)(subset->shape.cy + motion->v - s * dx + c * dy - patch->y0), (float)c, (float)-s};
}

struct partial {
    float one[LANES], square[LANES], plane[SUBSET_PLANES][LANES];
};

/* The products of pixel i into lane l. */
static inline void add_product(const float *t, const float *planes, size_t plane_size, int i, int l,
                               struct partial *restrict sums)
{
    float v = t[i];
    sums->one[l] += v;
    sums->square[l] += v * v;
    for (int p = 0; p < SUBSET_PLANES; p++)
        sums->plane[p][l] += v * planes[(size_t)p * plane_size + (size_t)i];
}

/* Sums of one stretch: few enough pixels for single precision. */
SIMD_CLONES static void add_products(const float *restrict t, const float *restrict planes, size_t plane_size,
                                     int count, struct partial *restrict sums)
{
    int i = 0;
    for (; i + LANES <= count; i += LANES)
        for (int l = 0; l < LANES; l++)
            add_product(t, planes, plane_size, i + l, l, sums);
    for (int l = 0; i + l < count; l++)
        add_product(t, planes, plane_size, i + l, l, sums);
}

static double total(const float lanes[LANES])
{
    double sum = 0;
    for (int l = 0; l < LANES; l++)
        sum += lanes[l];
    return sum;
}

/* Move the partial sums into the double ones. */
static void flush(struct partial *partial, struct kernel_sums *sums)
{
    sums->one += total(partial->one);
    sums->square += total(partial->square);
    for (int p = 0; p < SUBSET_PLANES; p++)
        sums->plane[p] += total(partial->plane[p]);
    *partial = (struct partial){0};
}

void kernel_sums(const struct subset *subset, const struct patch *patch, const struct motion *motion,
                 struct kernel_sums *sums)
{
    interpolate_line *interpolate = interpolate_chosen(patch->order);
    struct partial partial = {0};
    float t[STRETCH];
    int waiting = 0;
    *sums = (struct kernel_sums){0};
    for (size_t k = 0; k < subset->run_count; k++) {
        const struct run *run = &subset->runs[k];
        struct line line = kernel_line(subset, patch, motion, run);
        for (int begin = 0; begin < run->count; begin += STRETCH) {
            int count = run->count - begin < STRETCH ? run->count - begin : STRETCH;
            interpolate(patch, &line, begin, count, t);
            add_products(t, subset->planes + run->offset + begin, subset->count, count, &partial);
            waiting += count;
            if (waiting > 16 * STRETCH) {
                flush(&partial, sums);
                waiting = 0;
            }
        }
    }
    flush(&partial, sums);
}
