#include "simulation/placement.h"

#include <math.h>

#include "pipeline/error.h"
#include "pipeline/random.h"

enum { KEY_SHUFFLE = 1, KEY_JITTER = 2 };

static uint64_t key_of(const struct simulation *simulation, uint64_t purpose)
{
    return random_bits(simulation->seed, purpose);
}

static void grain_give(struct dem_grain *grain, double radius, const struct simulation *simulation)
{
    const double pi = 3.141592653589793;
    grain->radius = radius;
    grain->mass = simulation->density * simulation->length * pi * radius * radius;
    grain->inertia = 0.5 * grain->mass * radius * radius;
}

/* Fisher and Yates: any order of the radii is equally likely. */
static void shuffle(struct dem *dem, uint64_t key)
{
    for (size_t k = dem->count; k > 1; k--) {
        size_t other = (size_t)(random_uniform(key, k) * (double)k);
        struct dem_grain grain = dem->grains[k - 1];
        dem->grains[k - 1] = dem->grains[other];
        dem->grains[other] = grain;
    }
}

int placement_loose(const struct simulation *simulation, struct dem *dem)
{
    size_t count = 0, k = 0;
    double largest = 0;
    for (size_t g = 0; g < simulation->grade_count; g++) {
        count += (size_t)simulation->grading[g].count;
        largest = fmax(largest, 0.5 * simulation->grading[g].diameter);
    }
    if (!count)
        return error_input("simulation: no grains: give grading [[count, diameter_m], ...]");
    if (dem_alloc(dem, count))
        return -1;
    for (size_t g = 0; g < simulation->grade_count; g++)
        for (long c = 0; c < simulation->grading[g].count; c++)
            grain_give(&dem->grains[k++], 0.5 * simulation->grading[g].diameter, simulation);
    shuffle(dem, key_of(simulation, KEY_SHUFFLE));

    size_t columns = (size_t)ceil(sqrt((double)count * simulation->aspect));
    size_t rows = (count + columns - 1) / columns;
    double cell = 2.05 * largest;
    for (k = 0; k < count; k++) {
        struct dem_grain *grain = &dem->grains[k];
        double free = 0.5 * cell - grain->radius;
        grain->x = ((double)(k % columns) + 0.5) * cell;
        grain->y = ((double)(k / columns) + 0.5) * cell;
        grain->x += free * (2 * random_uniform(key_of(simulation, KEY_JITTER), 2 * k) - 1);
        grain->y += free * (2 * random_uniform(key_of(simulation, KEY_JITTER), 2 * k + 1) - 1);
    }
    dem->box.given = 1;
    dem->box.size[BOX_WIDTH] = (double)columns * cell;
    dem->box.size[BOX_HEIGHT] = (double)rows * cell;
    return 0;
}
