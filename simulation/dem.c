#include "simulation/dem.h"

#include <stdlib.h>
#include <string.h>

#include "pipeline/error.h"

int dem_alloc(struct dem *dem, size_t count)
{
    memset(dem, 0, sizeof *dem);
    dem->count = count;
    dem->grains = calloc(count ? count : 1, sizeof *dem->grains);
    dem->first = calloc(count + 1, sizeof *dem->first);
    dem->searched_at = calloc(count ? count : 1, sizeof *dem->searched_at);
    if (!dem->grains || !dem->first || !dem->searched_at) {
        dem_free(dem);
        return error_memory("grains of the simulation");
    }
    return 0;
}

void dem_free(struct dem *dem)
{
    free(dem->grains);
    free(dem->pairs);
    free(dem->first);
    free(dem->searched_at);
    memset(dem, 0, sizeof *dem);
}

/* Spring and dashpot without tension: the overlap is x = (v/w') exp(-z w t) sin(w' t), w' = w cos a, z = sin a; its
 * force k x + c x' vanishes at w' t = pi - 2 a, where the velocity is v exp(-(pi - 2 a) tan a). */
double dem_damping_ratio(double restitution)
{
    double low = 0, high = asin(1.0);
    for (int k = 0; k < 200; k++) {
        double a = 0.5 * (low + high);
        if (exp(-(2 * asin(1.0) - 2 * a) * tan(a)) > restitution)
            low = a;
        else
            high = a;
    }
    return restitution >= 1 ? 0 : sin(0.5 * (low + high));
}

double dem_time_unit(const struct dem *dem)
{
    double lightest = INFINITY;
    for (size_t k = 0; k < dem->count; k++)
        lightest = fmin(lightest, dem->grains[k].mass);
    return sqrt(lightest / dem->law.kn);
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
}

/* Velocity of the side where grain g touches it. */
static struct vec side_velocity(const struct dem_side *side, const struct dem_grain *g)
{
    return vec(side->velocity.x + side->tilt_rate * (g->y - side->point.y), side->velocity.y);
}

void dem_relative(const struct dem *dem, const struct dem_pair *pair, double *un, double *ut)
{
    const struct dem_grain *g = &dem->grains[pair->i];
    double half = 0.5 * pair->overlap, turning = (g->radius - half) * g->spin;
    struct vec velocity;
    if ((size_t)pair->j < dem->count) {
        const struct dem_grain *h = &dem->grains[pair->j];
        velocity = vec(h->vx, h->vy);
        turning += (h->radius - half) * h->spin;
    } else {
        velocity = side_velocity(&dem->box.side[(size_t)pair->j - dem->count], g);
    }
    double vx = velocity.x - g->vx, vy = velocity.y - g->vy;
    *un = vx * pair->nx + vy * pair->ny;
    *ut = -vx * pair->ny + vy * pair->nx - turning;
}

/* Normal and overlap now. */
static void pair_geometry(const struct dem *dem, struct dem_pair *pair)
{
    const struct dem_grain *g = &dem->grains[pair->i];
    if ((size_t)pair->j < dem->count) {
        const struct dem_grain *h = &dem->grains[pair->j];
        double dx = h->x - g->x, dy = h->y - g->y, reach = g->radius + h->radius, square = dx * dx + dy * dy;
        if (square >= reach * reach || square == 0) {
            pair->overlap = 0;
            return;
        }
        double distance = sqrt(square);
        pair->nx = dx / distance;
        pair->ny = dy / distance;
        pair->overlap = reach - distance;
        return;
    }
    const struct dem_side *side = &dem->box.side[(size_t)pair->j - dem->count];
    pair->nx = -side->inward.x;
    pair->ny = -side->inward.y;
    pair->overlap = g->radius - vec_dot(vec_sub(vec(g->x, g->y), side->point), side->inward);
}

/* Spring, dashpot, friction. */
static void pair_force(const struct dem *dem, struct dem_pair *pair, double mu, double dt, double dashpots)
{
    double un, ut;
    dem_relative(dem, pair, &un, &ut);
    pair->touching = 1;
    pair->fn = fmax(0, dem->law.kn * pair->overlap - dashpots * pair->damping * un);
    pair->ft -= dem->law.kn * dem->law.kt_over_kn * ut * dt;
    double limit = mu * pair->fn;
    pair->slips = fabs(pair->ft) >= limit;
    if (pair->slips)
        pair->ft = copysign(limit, pair->ft);
}

static void pair_act(struct dem *dem, const struct dem_pair *pair)
{
    struct dem_grain *g = &dem->grains[pair->i];
    double fx = pair->fn * pair->nx - pair->ft * pair->ny, fy = pair->fn * pair->ny + pair->ft * pair->nx;
    double half = 0.5 * pair->overlap;
    g->fx -= fx;
    g->fy -= fy;
    g->moment -= (g->radius - half) * pair->ft;
    if ((size_t)pair->j < dem->count) {
        struct dem_grain *h = &dem->grains[pair->j];
        h->fx += fx;
        h->fy += fy;
        h->moment -= (h->radius - half) * pair->ft;
        return;
    }
    int s = pair->j - (int)dem->count;
    struct dem_side *side = &dem->box.side[s];
    double height = g->y + (g->radius - half) * pair->ny;
    side->force = vec_add(side->force, vec(fx, fy));
    if (s == SIDE_RIGHT || s == SIDE_LEFT)
        dem->box.push[BOX_SHEAR] += fx * height;
    if (s == SIDE_RIGHT)
        dem->box.push[BOX_WIDTH] += fx;
    if (s == SIDE_TOP) {
        dem->box.push[BOX_SHEAR] += fx * dem->box.size[BOX_HEIGHT];
        dem->box.push[BOX_HEIGHT] += fy + fx * dem->box.size[BOX_SHEAR];
    }
}

static void forces_from_outside(struct dem *dem)
{
    for (size_t k = 0; k < dem->count; k++) {
        struct dem_grain *g = &dem->grains[k];
        int fixed = isinf(g->mass);
        g->fx = fixed ? 0 : g->mass * dem->gravity.x;
        g->fy = fixed ? 0 : g->mass * dem->gravity.y;
        g->moment = 0;
    }
    for (int s = 0; s < SIDES; s++)
        dem->box.side[s].force = vec(0, 0);
    for (int f = 0; f < BOX_FREEDOMS; f++)
        dem->box.push[f] = 0;
}

static int all_forces(struct dem *dem, double dt, double dashpots)
{
    dem_place_walls(dem);
    if (dem_find_pairs(dem) < 0)
        return -1;
    forces_from_outside(dem);
    size_t walls = dem->first[dem->count];
    for (size_t p = 0; p < dem->pair_count; p++) {
        struct dem_pair *pair = &dem->pairs[p];
        pair_geometry(dem, pair);
        if (pair->overlap > 0) {
            pair_force(dem, pair, p < walls ? dem->mu : dem->mu_wall, dt, dashpots);
            pair_act(dem, pair);
        } else if (pair->touching) {
            pair->touching = pair->slips = 0;
            pair->fn = pair->ft = 0;
        }
    }
    return 0;
}

int dem_forces(struct dem *dem, double dt)
{
    return all_forces(dem, dt, 1);
}

int dem_forces_static(struct dem *dem, double dt)
{
    return all_forces(dem, dt, 0);
}
