#include "tests/bench/packed.h"

#include <math.h>

#include "simulation/dem/simulate.h"

#define PX_PER_M (67 / 4e-3)
#define BORDER 60.0 /* px */

struct target {
    struct photo_grains *grains;
    int width, height;
};

static int keep_grains(const struct packing *packing, const struct simulation_state *state, void *user)
{
    static const char *const columns[] = {"x_px", "y_px", "radius_px", "angle", "shape_c", "shape_s", NULL};
    struct target *target = user;
    struct photo_grains *to = target->grains;
    const struct grains *from = &packing->grains;
    double x0 = INFINITY, y0 = INFINITY, x1 = -INFINITY, y1 = -INFINITY;
    (void)state;
    if (table_alloc(&PHOTO_GRAINS, to, from->count, columns))
        return -1;
    for (size_t k = 0; k < from->count; k++) {
        x0 = fmin(x0, from->x[k] - from->radius[k]);
        y0 = fmin(y0, from->y[k] - from->radius[k]);
        x1 = fmax(x1, from->x[k] + from->radius[k]);
        y1 = fmax(y1, from->y[k] + from->radius[k]);
    }
    for (size_t k = 0; k < from->count; k++) {
        to->x_px[k] = BORDER + PX_PER_M * (from->x[k] - x0);
        to->y_px[k] = BORDER + PX_PER_M * (y1 - from->y[k]);
        to->radius_px[k] = PX_PER_M * from->radius[k];
        to->angle[k] = to->shape_c[k] = to->shape_s[k] = 0;
    }
    target->width = (int)(PX_PER_M * (x1 - x0) + 2 * BORDER);
    target->height = (int)(PX_PER_M * (y1 - y0) + 2 * BORDER);
    return 0;
}

int packed_grains(uint64_t seed, long count, struct photo_grains *grains, int *width, int *height)
{
    double share = (double)count / 1850;
    const struct grade grading[] = {{lround(798 * share), 8e-3},
                                    {lround(426 * share), 12e-3},
                                    {lround(406 * share), 14e-3},
                                    {lround(220 * share), 20e-3}};
    struct simulation simulation = SIMULATION_DEFAULT;
    struct target target = {.grains = grains};
    simulation.seed = seed;
    simulation.grading = grading;
    simulation.grade_count = 4;
    simulation.aspect = 1.33;
    simulation.kappa = 1000;
    simulation.tolerance = 1e-3;
    simulation.law = (struct contact_law){.row = &linear_law, .kn = 1.09e7, .kt_over_kn = 1, .mu = 0.3};
    if (simulate(&simulation, keep_grains, &target) < 0)
        return -1;
    *width = target.width;
    *height = target.height;
    return 0;
}
