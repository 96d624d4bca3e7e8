#include "simulation/loading.h"

#include <math.h>
#include <string.h>

#include "pipeline/error.h"

static const double TIME_STEP = 0.1; /* of sqrt(m/kn) of the lightest grain: 1/60 of the period of a contact */

static double mean_mass(const struct dem *dem)
{
    double mass = 0;
    for (size_t k = 0; k < dem->count; k++)
        mass += dem->grains[k].mass / (double)dem->count;
    return mass;
}

static double smallest_radius(const struct dem *dem)
{
    double radius = INFINITY;
    for (size_t k = 0; k < dem->count; k++)
        radius = fmin(radius, dem->grains[k].radius);
    return radius;
}

static void loading_prepare(struct loading *loading)
{
    const struct simulation *simulation = loading->simulation;
    struct dem *dem = &loading->dem;
    dem->law = simulation->law;
    dem->damping_ratio = dem_damping_ratio(simulation->restitution);
    dem->skin = 0.4 * smallest_radius(dem);
    dem->mu = isnan(simulation->preparation_mu) ? simulation->law.mu : simulation->preparation_mu;
    dem->mu_wall = simulation->law.mu_wall;
    loading->pressure = simulation->law.kn / simulation->kappa;
    loading->time_step = TIME_STEP * dem_time_unit(dem);
    loading->strain_rate = simulation->inertial / sqrt(mean_mass(dem) / loading->pressure);
}

static double solid_fraction(const struct dem *dem)
{
    const double pi = 3.141592653589793;
    double area = 0;
    for (size_t k = 0; k < dem->count; k++)
        area += pi * dem->grains[k].radius * dem->grains[k].radius;
    return area / (dem->box.size[BOX_WIDTH] * dem->box.size[BOX_HEIGHT]);
}

/* Both walls carry the pressure to 10 %. */
static int is_loaded(const struct loading *loading)
{
    const struct dem_box *box = &loading->dem.box;
    double x = box->push[BOX_WIDTH] / (loading->pressure * box->size[BOX_HEIGHT]);
    double y = box->push[BOX_HEIGHT] / (loading->pressure * box->size[BOX_WIDTH]);
    return fabs(x - 1) < 0.1 && fabs(y - 1) < 0.1;
}

static int relax(struct loading *loading)
{
    const struct simulation *simulation = loading->simulation;
    return dem_relax(&loading->dem, &loading->servo, simulation->tolerance, simulation->max_steps, &loading->steps);
}

int loading_compress(struct loading *loading)
{
    static const double LOOSE = 0.75, HASTE = 20; /* no force yet below this solid fraction: come faster */
    loading_prepare(loading);
    struct dem *dem = &loading->dem;
    struct servo *servo = &loading->servo;
    servo->hold[BOX_WIDTH] = servo->hold[BOX_HEIGHT] = HOLD_STRESS;
    servo->hold[BOX_SHEAR] = HOLD_SIZE;
    servo->stress_x = servo->stress_y = loading->pressure;
    struct stepping stepping = {.dt = loading->time_step, .drag = 0.1 / loading->time_step * TIME_STEP, .follow = 1};
    long loaded = 0;
    for (long step = 0; loaded < 200; step++) {
        servo->fastest = loading->strain_rate * (solid_fraction(dem) < LOOSE ? HASTE : 1);
        if (dem_step(dem, servo, &stepping))
            return -1;
        loaded = is_loaded(loading) ? loaded + 1 : 0;
        loading->steps++;
        if (step > loading->simulation->max_steps)
            return error_input("simulation: the packing does not take the pressure within %ld steps: raise "
                               "inertial_number or max_steps",
                               step);
    }
    servo->fastest = INFINITY;
    int done = relax(loading);
    if (done >= 0 && dem->mu != loading->simulation->law.mu) {
        dem->mu = loading->simulation->law.mu;
        done = relax(loading);
    }
    memcpy(loading->size, dem->box.size, sizeof loading->size);
    return done;
}

int loading_strain(struct loading *loading, double strain)
{
    struct dem *dem = &loading->dem;
    struct servo *servo = &loading->servo;
    double gone = fabs(strain) * loading->size[BOX_HEIGHT];
    long steps = (long)ceil(fabs(strain) / (loading->strain_rate * loading->time_step)) + 1;
    struct stepping stepping = {.dt = loading->time_step};
    servo->hold[BOX_HEIGHT] = HOLD_RATE;
    servo->rate[BOX_HEIGHT] = copysign(gone, -strain) / ((double)steps * loading->time_step);
    for (long step = 0; step < steps; step++, loading->steps++)
        if (dem_step(dem, servo, &stepping))
            return -1;
    servo->hold[BOX_HEIGHT] = HOLD_SIZE;
    return relax(loading);
}
