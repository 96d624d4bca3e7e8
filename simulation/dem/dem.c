/* The packing as such: its memory, where the walls of its box stand, its energy.
 *
 * The box maps the unit square by x = W a + g H b, y = H b. Its sides are the lines of that parallelogram; the normal
 * of the tilted ones is (1, -g) / (1 + g^2)^1/2. With the rates W', H', g' a point of a side wall at the height y above
 * its foot moves with the foot and by g' y along x; the top moves by (g' H + g H', H'). */
#include "simulation/dem/dem.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "pipeline/speak/error.h"

int dem_alloc(struct dem *dem, size_t count)
{
    memset(dem, 0, sizeof *dem);
    dem->count = count;
    dem->parallel_from = DEM_PARALLEL_FROM;
    dem->grains = calloc(count + 1, sizeof *dem->grains);
    dem->first = calloc(count + 1, sizeof *dem->first);
    dem->wall_first = calloc(count + 1, sizeof *dem->wall_first);
    dem->back_first = calloc(count + 2, sizeof *dem->back_first);
    dem->searched_at = calloc(count + 1, sizeof *dem->searched_at);
    if (!dem->grains || !dem->first || !dem->wall_first || !dem->back_first || !dem->searched_at) {
        dem_free(dem);
        return error_memory("grains of the simulation");
    }
    return 0;
}

/* A copy of `count` elements of `size` bytes with room for `room`; NULL stays NULL. */
static void *copy_of(const void *from, size_t count, size_t room, size_t size, int *failed)
{
    if (!from)
        return NULL;
    void *to = malloc((room + 1) * size);
    if (!to)
        *failed = 1;
    else
        memcpy(to, from, count * size);
    return to;
}

int dem_copy(const struct dem *from, struct dem *to)
{
    int failed = 0;
    size_t n = from->count, grain_pairs = from->first[n];
    *to = *from;
    to->grains = copy_of(from->grains, n, n, sizeof *to->grains, &failed);
    to->pairs = copy_of(from->pairs, from->pair_count, from->pair_capacity, sizeof *to->pairs, &failed);
    to->pair_law = copy_of(from->pair_law, from->pair_count, from->pair_capacity, sizeof *to->pair_law, &failed);
    to->first = copy_of(from->first, n + 1, n + 1, sizeof *to->first, &failed);
    to->wall_first = copy_of(from->wall_first, n + 1, n + 1, sizeof *to->wall_first, &failed);
    to->back_first = copy_of(from->back_first, n + 2, n + 2, sizeof *to->back_first, &failed);
    to->back = copy_of(from->back, grain_pairs, grain_pairs, sizeof *to->back, &failed);
    to->searched_at = copy_of(from->searched_at, n, n + 1, sizeof *to->searched_at, &failed);
    if (!failed)
        return 0;
    dem_free(to);
    return error_memory("a copy of the packing");
}

void dem_free(struct dem *dem)
{
    free(dem->grains);
    free(dem->pairs);
    free(dem->pair_law);
    free(dem->first);
    free(dem->wall_first);
    free(dem->back_first);
    free(dem->back);
    free(dem->searched_at);
    memset(dem, 0, sizeof *dem);
}

/* Spring and dashpot without tension: the overlap is x = (v/w') exp(-z w t) sin(w' t), w' = w cos a, z = sin a; its
 * force k x + c x' vanishes at w' t = M_PI - 2 a, where the velocity is v exp(-(M_PI - 2 a) tan a). */
double dem_damping_ratio(double restitution)
{
    double low = 0, high = 0.5 * M_PI;
    for (int k = 0; k < 200; k++) {
        double a = 0.5 * (low + high);
        if (exp(-(M_PI - 2 * a) * tan(a)) > restitution)
            low = a;
        else
            high = a;
    }
    return restitution >= 1 ? 0 : sin(0.5 * (low + high));
}

double dem_time_unit(const struct dem *dem, double stiffness)
{
    double lightest = INFINITY;
    for (size_t k = 0; k < dem->count; k++)
        if (!dem->grains[k].fixed)
            lightest = fmin(lightest, dem->grains[k].mass);
    return sqrt(lightest / stiffness);
}

struct vec dem_corner_at(const struct dem_box *box, int k)
{
    double width = box->size[BOX_WIDTH], height = box->size[BOX_HEIGHT], lean = box->size[BOX_SHEAR] * height;
    int right = k == BOX_BOTTOM_RIGHT || k == BOX_TOP_RIGHT, top = k == BOX_TOP_RIGHT || k == BOX_TOP_LEFT;
    return vec((right ? width : 0) + (top ? lean : 0), top ? height : 0);
}

/* Each goes in x with its side wall, in y with the bottom or the top. */
static void place_corners(struct dem_box *box)
{
    struct vec right = box->side[SIDE_RIGHT].velocity, top = box->side[SIDE_TOP].velocity;
    for (int k = 0; k < BOX_CORNERS; k++)
        box->corner[k].at = dem_corner_at(box, k);
    box->corner[BOX_BOTTOM_LEFT].velocity = vec(0, 0);
    box->corner[BOX_BOTTOM_RIGHT].velocity = right;
    box->corner[BOX_TOP_RIGHT].velocity = vec_add(right, top);
    box->corner[BOX_TOP_LEFT].velocity = top;
}

void dem_place_walls(struct dem *dem)
{
    struct dem_box *box = &dem->box;
    if (!box->given)
        return;
    const double *size = box->size, *rate = box->rate;
    double shear = size[BOX_SHEAR], length = hypot(1, shear);
    struct dem_side *side = box->side;
    side[SIDE_BOTTOM] = (struct dem_side){.inward = {0, 1}};
    side[SIDE_LEFT] = (struct dem_side){.inward = {1 / length, -shear / length}, .tilt_rate = rate[BOX_SHEAR]};
    side[SIDE_RIGHT] = (struct dem_side){.point = {size[BOX_WIDTH], 0},
                                         .inward = {-1 / length, shear / length},
                                         .velocity = {rate[BOX_WIDTH], 0},
                                         .tilt_rate = rate[BOX_SHEAR]};
    side[SIDE_TOP] = (struct dem_side){
        .point = {shear * size[BOX_HEIGHT], size[BOX_HEIGHT]},
        .inward = {0, -1},
        .velocity = {rate[BOX_SHEAR] * size[BOX_HEIGHT] + shear * rate[BOX_HEIGHT], rate[BOX_HEIGHT]}};
    if (box->corner_radius > 0)
        place_corners(box);
}

const struct contact_pair *dem_pair_law(const struct dem *dem, size_t p)
{
    return contact_law_row(&dem->law)->linear ? &dem->linear : &dem->pair_law[p];
}

struct dem_energy dem_energy(const struct dem *dem)
{
    struct dem_energy energy = {0};
    for (size_t k = 0; k < dem->count; k++) {
        const struct dem_grain *g = &dem->grains[k];
        if (!g->fixed)
            energy.kinetic += 0.5 * (g->mass * (g->vx * g->vx + g->vy * g->vy) + g->inertia * g->spin * g->spin);
        energy.lost += g->lost;
    }
    for (size_t p = 0; p < dem->pair_count; p++)
        if (dem->pairs[p].touching)
            energy.stored +=
                contact_spring_energy(&dem->law, dem_pair_law(dem, p), dem->pairs[p].overlap, &dem->pairs[p].spring);
    return energy;
}
