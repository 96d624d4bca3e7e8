/* Motion in true time. Leapfrog: velocities stand at half steps, v(t + dt/2) = v(t - dt/2) + dt F(t) / m, positions at
 * whole ones: second order, and stable below dt = 2 / (highest frequency). A drag d relative to the motion u of the box
 * is taken implicitly, v <- u + (v + dt F/m - u) / (1 + d dt), so that it never overshoots.
 *
 * The freedoms q of the box move under the generalised force Q = dW/dq of the grains and of the servo: m' q'' = Q. The
 * shear is an angle: its mass is m' H^2. */
#include "simulation/dem/dem_motion.h"

#include <math.h>

/* Work per unit of the width is force over the height of the side walls, and so on; of the shear: over the area. */
double servo_load(const struct dem *dem, const struct servo *servo, int freedom)
{
    const double *size = dem->box.size;
    switch (freedom) {
    case BOX_WIDTH:
        return -servo->stress_x * size[BOX_HEIGHT];
    case BOX_HEIGHT:
        return -servo->stress_y * size[BOX_WIDTH];
    default:
        return -servo->stress_xy * size[BOX_WIDTH] * size[BOX_HEIGHT];
    }
}

double box_stress(const struct dem *dem, int freedom)
{
    double width = dem->box.size[BOX_WIDTH], height = dem->box.size[BOX_HEIGHT];
    return dem->box.push[freedom] / (freedom == BOX_WIDTH ? height : freedom == BOX_HEIGHT ? width : width * height);
}

/* A wall moves like a row of grains across the box. */
static double wall_mass(const struct dem *dem)
{
    double mass = 0;
    size_t free = 0;
    for (size_t k = 0; k < dem->count; k++)
        if (!dem->grains[k].fixed) {
            mass += dem->grains[k].mass;
            free++;
        }
    return free ? mass / sqrt((double)free) : 1;
}

/* Walls under a stress are accelerated, within the servo's fastest rate; the others have the rate that they are given.
 */
static void box_step(struct dem *dem, const struct servo *servo, double dt)
{
    struct dem_box *box = &dem->box;
    double mass = wall_mass(dem);
    for (int f = 0; f < BOX_FREEDOMS; f++) {
        double arm = f == BOX_SHEAR ? box->size[BOX_HEIGHT] : 1;
        if (servo->hold[f] == HOLD_STRESS) {
            double force = box->push[f] + servo_load(dem, servo, f);
            double most = servo->fastest * (f == BOX_SHEAR ? 1 : box->size[f]);
            box->rate[f] += dt * force / (mass * arm * arm);
            box->rate[f] = fmax(-most, fmin(most, box->rate[f]));
        } else {
            box->rate[f] = servo->hold[f] == HOLD_RATE ? servo->rate[f] : 0;
        }
    }
}

/* Velocity of the homogeneous motion of the box at a point. */
static struct vec box_velocity(const struct dem_box *box, double x, double y)
{
    double up = box->rate[BOX_HEIGHT] / box->size[BOX_HEIGHT];
    double sheared = x - box->size[BOX_SHEAR] * y;
    return vec(box->rate[BOX_WIDTH] / box->size[BOX_WIDTH] * sheared + box->rate[BOX_SHEAR] * y +
                   box->size[BOX_SHEAR] * up * y,
               up * y);
}

int dem_step(struct dem *dem, const struct servo *servo, const struct stepping *stepping)
{
    double dt = stepping->dt, keep = 1 / (1 + stepping->drag * dt);
    if (dem_forces(dem, dt))
        return -1;
    if (dem->box.given)
        box_step(dem, servo, dt);
#pragma omp parallel for schedule(static) if (dem->count >= dem->parallel_from)
    for (size_t k = 0; k < dem->count; k++) {
        struct dem_grain *g = &dem->grains[k];
        if (g->fixed)
            continue;
        struct vec carried = stepping->follow ? box_velocity(&dem->box, g->x, g->y) : vec(0, 0);
        g->vx = carried.x + keep * (g->vx + dt * g->fx / g->mass - carried.x);
        g->vy = carried.y + keep * (g->vy + dt * g->fy / g->mass - carried.y);
        g->spin = keep * (g->spin + dt * g->moment / g->inertia);
        g->x += dt * g->vx;
        g->y += dt * g->vy;
        g->angle += dt * g->spin;
    }
    for (int f = 0; f < BOX_FREEDOMS; f++)
        dem->box.size[f] += dt * dem->box.rate[f];
    return 0;
}
