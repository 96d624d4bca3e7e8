/* Relaxation to static equilibrium: inertial relaxation with power control (FIRE; Bitzek and others, Phys. Rev. Lett.
 * 97, 170201, 2006) with fictitious masses that make all frequencies alike. Only positions and friction springs
 * matter at the end; the dashpots are out. Coulomb's law holds all along, so sliding is kept as it happened. */
#include <math.h>

#include "simulation/motion.h"

enum { BEGIN_STEPS = 20, CHECK_EVERY = 20 };
static const double LONGEST = 0.30; /* of sqrt(m/kn): below the stability limit of 2 over the highest frequency */
static const double GROW = 1.1, SHRINK = 0.5, MIX = 0.1, MIX_SHRINK = 0.99;

struct fire {
    double mass;      /* fictitious, of a grain of mean radius, kg */
    double radius;    /* mean, m */
    double wall_mass; /* kg */
    double dt, longest, mix;
    long downhill; /* steps since the power was last negative */
};

static double grain_mass(const struct fire *fire, const struct dem_grain *g)
{
    return fire->mass * 0.5 * (1 + g->radius / fire->radius); /* about as many contacts as its rim holds */
}

static double box_mass(const struct dem *dem, const struct fire *fire, int freedom)
{
    double arm = freedom == BOX_SHEAR ? dem->box.size[BOX_HEIGHT] : 1;
    return fire->wall_mass * arm * arm;
}

struct imbalance dem_imbalance(const struct dem *dem, const struct servo *servo)
{
    struct imbalance imbalance = {0};
    for (size_t p = 0; p < dem->pair_count; p++)
        if (dem->pairs[p].touching) {
            imbalance.mean_fn += dem->pairs[p].fn;
            imbalance.contacts++;
        }
    if (imbalance.contacts)
        imbalance.mean_fn /= (double)imbalance.contacts;
    double largest = 0;
    for (size_t k = 0; k < dem->count; k++) {
        const struct dem_grain *g = &dem->grains[k];
        if (!isinf(g->mass))
            largest = fmax(largest, fmax(fmax(fabs(g->fx), fabs(g->fy)), fabs(g->moment) / g->radius));
    }
    for (int f = 0; f < BOX_FREEDOMS && dem->box.given; f++)
        if (servo->hold[f] == HOLD_STRESS)
            largest = fmax(largest, fabs(dem->box.push[f] + servo_load(dem, servo, f)) /
                                        (f == BOX_SHEAR ? dem->box.size[BOX_HEIGHT] : 1));
    imbalance.largest = largest;
    return imbalance;
}

static void stop(struct dem *dem)
{
    for (size_t k = 0; k < dem->count; k++)
        dem->grains[k].vx = dem->grains[k].vy = dem->grains[k].spin = 0;
    for (int f = 0; f < BOX_FREEDOMS; f++)
        dem->box.rate[f] = 0;
}

static double power(const struct dem *dem, const struct servo *servo)
{
    double sum = 0;
    for (size_t k = 0; k < dem->count; k++) {
        const struct dem_grain *g = &dem->grains[k];
        sum += g->fx * g->vx + g->fy * g->vy + g->moment * g->spin;
    }
    for (int f = 0; f < BOX_FREEDOMS && dem->box.given; f++)
        sum += (dem->box.push[f] + servo_load(dem, servo, f)) * dem->box.rate[f];
    return sum;
}

/* v += dt F/m. Returns |v| / |F/m|, both weighted by the fictitious masses. */
static double kick(struct dem *dem, const struct servo *servo, const struct fire *fire)
{
    double velocity = 0, acceleration = 0;
    for (size_t k = 0; k < dem->count; k++) {
        struct dem_grain *g = &dem->grains[k];
        if (isinf(g->mass))
            continue;
        double m = grain_mass(fire, g), inertia = m * g->radius * g->radius;
        g->vx += fire->dt * g->fx / m;
        g->vy += fire->dt * g->fy / m;
        g->spin += fire->dt * g->moment / inertia;
        velocity += m * (g->vx * g->vx + g->vy * g->vy) + inertia * g->spin * g->spin;
        acceleration += (g->fx * g->fx + g->fy * g->fy) / m + g->moment * g->moment / inertia;
    }
    for (int f = 0; f < BOX_FREEDOMS && dem->box.given; f++) {
        if (servo->hold[f] != HOLD_STRESS)
            continue;
        double m = box_mass(dem, fire, f), force = dem->box.push[f] + servo_load(dem, servo, f);
        dem->box.rate[f] += fire->dt * force / m;
        velocity += m * dem->box.rate[f] * dem->box.rate[f];
        acceleration += force * force / m;
    }
    return acceleration > 0 ? sqrt(velocity / acceleration) : 0;
}

/* Turn the velocities towards the forces and move. */
static void drift(struct dem *dem, const struct servo *servo, const struct fire *fire, double ratio)
{
    double keep = 1 - fire->mix, turn = fire->mix * ratio;
    for (size_t k = 0; k < dem->count; k++) {
        struct dem_grain *g = &dem->grains[k];
        if (isinf(g->mass))
            continue;
        double m = grain_mass(fire, g), inertia = m * g->radius * g->radius;
        g->vx = keep * g->vx + turn * g->fx / m;
        g->vy = keep * g->vy + turn * g->fy / m;
        g->spin = keep * g->spin + turn * g->moment / inertia;
        g->x += fire->dt * g->vx;
        g->y += fire->dt * g->vy;
        g->angle += fire->dt * g->spin;
    }
    for (int f = 0; f < BOX_FREEDOMS && dem->box.given; f++) {
        if (servo->hold[f] != HOLD_STRESS)
            continue;
        double force = dem->box.push[f] + servo_load(dem, servo, f);
        dem->box.rate[f] = keep * dem->box.rate[f] + turn * force / box_mass(dem, fire, f);
        dem->box.size[f] += fire->dt * dem->box.rate[f];
    }
}

static void steer(struct dem *dem, struct fire *fire, double work)
{
    if (work > 0) {
        if (++fire->downhill > BEGIN_STEPS) {
            fire->dt = fmin(fire->dt * GROW, fire->longest);
            fire->mix *= MIX_SHRINK;
        }
    } else if (work < 0) {
        stop(dem);
        fire->dt = fmax(fire->dt * SHRINK, 0.05 * fire->longest);
        fire->mix = MIX;
        fire->downhill = 0;
    }
}

static struct fire fire_begin(const struct dem *dem)
{
    struct fire fire = {.mass = 1, .mix = MIX};
    for (size_t k = 0; k < dem->count; k++)
        fire.radius += dem->grains[k].radius / (double)dem->count;
    fire.wall_mass = fire.mass * sqrt((double)dem->count);
    fire.longest = LONGEST * sqrt(fire.mass / dem->law.kn);
    fire.dt = 0.3 * fire.longest;
    return fire;
}

int dem_relax(struct dem *dem, const struct servo *servo, double tolerance, long max_steps, long *steps)
{
    struct fire fire = fire_begin(dem);
    stop(dem);
    for (long step = 0; step <= max_steps; step++, ++*steps) {
        /* Friction springs follow the last displacement; the dashpots are out because their coefficient is. */
        if (dem_forces_static(dem, step ? fire.dt : 0))
            return -1;
        if (step % CHECK_EVERY == 0) {
            struct imbalance imbalance = dem_imbalance(dem, servo);
            if (imbalance.largest <= tolerance * imbalance.mean_fn) {
                stop(dem);
                return 1;
            }
        }
        steer(dem, &fire, power(dem, servo));
        drift(dem, servo, &fire, kick(dem, servo, &fire));
    }
    stop(dem);
    return 0;
}
