/* First positions. A grading is shuffled onto a grid of cells slightly wider than the largest disc, each disc anywhere
 * in its cell: a loose packing without contacts and without order, the same for the same seed on every machine. The
 * compression makes a packing of it. Discs by hand stand where they are told, within what a relaxation can mend. */
#include "simulation/dem/placement.h"

#include <math.h>

#include "pipeline/speak/error.h"
#include "pipeline/numbers/random.h"

enum { KEY_SHUFFLE = 1, KEY_JITTER = 2 };

/* Streams of random numbers that do not depend on each other. */
static uint64_t key_of(const struct simulation *simulation, uint64_t purpose)
{
    return random_bits(simulation->seed, purpose);
}

/* A rod of length L seen from its end: m = rho pi R^2 L, I = m R^2 / 2. */
static void grain_give(struct dem_grain *grain, double radius, const struct simulation *simulation)
{
    grain->radius = radius;
    double length = isnan(simulation->length) ? 1 : simulation->length;
    grain->mass = simulation->density * length * M_PI * radius * radius;
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

static int placement_loose(const struct simulation *simulation, struct dem *dem)
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
    double cell = 2.05 * largest, edge = simulation->corner_radius; /* clear of the corner discs */
    for (k = 0; k < count; k++) {
        struct dem_grain *grain = &dem->grains[k];
        double free = 0.5 * cell - grain->radius;
        grain->x = edge + ((double)(k % columns) + 0.5) * cell;
        grain->y = edge + ((double)(k / columns) + 0.5) * cell;
        grain->x += free * (2 * random_uniform(key_of(simulation, KEY_JITTER), 2 * k) - 1);
        grain->y += free * (2 * random_uniform(key_of(simulation, KEY_JITTER), 2 * k + 1) - 1);
    }
    dem->box.given = 1;
    dem->box.size[BOX_WIDTH] = 2 * edge + (double)columns * cell;
    dem->box.size[BOX_HEIGHT] = 2 * edge + (double)rows * cell;
    return 0;
}

/* Two discs that are held may not overlap; others may, a little: the relaxation parts them. */
static int check_discs(const struct simulation *simulation)
{
    for (size_t a = 0; a < simulation->disc_count; a++)
        for (size_t b = a + 1; b < simulation->disc_count; b++) {
            const struct placed_disc *p = &simulation->discs[a], *q = &simulation->discs[b];
            double overlap = p->radius + q->radius - hypot(p->x - q->x, p->y - q->y);
            if (p->fixed && q->fixed && overlap > 0)
                return error_input("simulation: the fixed discs %zu and %zu overlap by %g m: move them apart", a, b,
                                   overlap);
            if (overlap > 0.2 * fmin(p->radius, q->radius))
                return error_input("simulation: discs %zu and %zu overlap by %g m: move them apart", a, b, overlap);
        }
    return 0;
}

/* The corner discs are half a side apart or more, and no grain sits on one. */
static int check_corners(const struct simulation *simulation, const struct dem *dem)
{
    const struct dem_box *box = &dem->box;
    double radius = simulation->corner_radius, area = 0;
    for (size_t k = 0; k < dem->count; k++)
        area += dem->grains[k].radius * dem->grains[k].radius * M_PI;
    if (!box->given)
        return error_input("simulation: corner_radius_m needs a box: give box_m");
    double width = box->size[BOX_WIDTH], height = box->size[BOX_HEIGHT];
    double shortest = fmin(fmin(width, height), sqrt(area * fmin(width / height, height / width)));
    if (!simulation->disc_count && radius > 0.25 * shortest)
        return error_input(
            "simulation: corner_radius_m %g is more than a quarter of the packing's side: make it smaller", radius);
    if (2 * radius > fmin(width, height))
        return error_input("simulation: corner_radius_m %g: the corner discs overlap: make it smaller", radius);
    for (size_t k = 0; k < dem->count; k++)
        for (int c = 0; c < BOX_CORNERS; c++) {
            const struct dem_grain *g = &dem->grains[k];
            struct vec at = dem_corner_at(box, c);
            double overlap = g->radius + radius - hypot(g->x - at.x, g->y - at.y);
            if (overlap > 0.2 * fmin(g->radius, radius))
                return error_input("simulation: disc %zu overlaps a corner disc by %g m: move it", k, overlap);
        }
    return 0;
}

static int placement_by_hand(const struct simulation *simulation, struct dem *dem)
{
    if (check_discs(simulation) || dem_alloc(dem, simulation->disc_count))
        return -1;
    for (size_t k = 0; k < dem->count; k++) {
        const struct placed_disc *disc = &simulation->discs[k];
        struct dem_grain *grain = &dem->grains[k];
        grain_give(grain, disc->radius, simulation);
        grain->x = disc->x, grain->y = disc->y;
        grain->load_x = disc->load_x, grain->load_y = disc->load_y, grain->load_m = disc->load_m;
        grain->fixed = disc->fixed;
    }
    dem->box.given = !isnan(simulation->box[0]);
    if (dem->box.given) {
        dem->box.size[BOX_WIDTH] = simulation->box[0];
        dem->box.size[BOX_HEIGHT] = simulation->box[1];
    }
    return 0;
}

int placement(const struct simulation *simulation, struct dem *dem)
{
    if (simulation->disc_count ? placement_by_hand(simulation, dem) : placement_loose(simulation, dem))
        return -1;
    dem->box.corner_radius = simulation->corner_radius;
    return simulation->corner_radius > 0 ? check_corners(simulation, dem) : 0;
}
