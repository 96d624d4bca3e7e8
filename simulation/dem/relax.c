/* Relaxation to static equilibrium: inertial relaxation with power control (FIRE; Bitzek and others, Phys. Rev. Lett.
 * 97, 170201, 2006) with fictitious masses that bring all frequencies together. Only positions and friction springs
 * matter at the end; the dashpots are out. Coulomb's law holds all along, so sliding is kept as it happened. Sums over
 * grains go by blocks of fixed size: they do not depend on the number of threads. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "pipeline/speak/error.h"
#include "simulation/dem/dem_motion.h"

enum { BEGIN_STEPS = 20, CHECK_EVERY = 20, BLOCK = 512 };
static const double LONGEST = 0.30; /* of sqrt(m/k): below the stability limit of 2 over the highest frequency */
static const double GROW = 1.1, SHRINK = 0.5, MIX = 0.1, MIX_SHRINK = 0.99;

/* State of one relaxation; `block` holds one sum per block of grains, so that totals do not depend on the number of
 * threads. */
struct fire {
    double mass;      /* fictitious, of a grain of mean radius, kg */
    double radius;    /* mean, m */
    double wall_mass; /* kg */
    double dt, longest, mix;
    long downhill; /* steps since the power was last negative */
    double (*block)[2];
    size_t blocks;
};

/* Fictitious, kg: only the end counts, so masses are chosen for speed. */
static double grain_mass(const struct fire *fire, const struct dem_grain *g)
{
    return fire->mass * 0.5 * (1 + g->radius / fire->radius); /* about as many contacts as its rim holds */
}

/* Fictitious mass of a freedom of the box, kg; kg m2 for the shear. */
static double box_mass(const struct dem *dem, const struct fire *fire, int freedom)
{
    double arm = freedom == BOX_SHEAR ? dem->box.size[BOX_HEIGHT] : 1;
    return fire->wall_mass * arm * arm;
}

/* What drives a freedom of the box, N (N m for the shear): the grains inside less what holds it outside. */
static double box_force(const struct dem *dem, const struct servo *servo, int freedom)
{
    return dem->box.push[freedom] + servo_load(dem, servo, freedom);
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
    imbalance.mean_fn = fmax(imbalance.mean_fn, dem->dust);
    double largest = 0;
    for (size_t k = 0; k < dem->count; k++) {
        const struct dem_grain *g = &dem->grains[k];
        if (!g->fixed)
            largest = fmax(largest, fmax(fmax(fabs(g->fx), fabs(g->fy)), fabs(g->moment) / g->radius));
    }
    for (int f = 0; f < BOX_FREEDOMS && dem->box.given; f++)
        if (servo->hold[f] == HOLD_STRESS)
            largest = fmax(largest, fabs(box_force(dem, servo, f)) / (f == BOX_SHEAR ? dem->box.size[BOX_HEIGHT] : 1));
    imbalance.largest = largest;
    return imbalance;
}

/* All velocities to zero: FIRE's answer to going uphill. */
static void stop(struct dem *dem)
{
    for (size_t k = 0; k < dem->count; k++)
        dem->grains[k].vx = dem->grains[k].vy = dem->grains[k].spin = 0;
    for (int f = 0; f < BOX_FREEDOMS; f++)
        dem->box.rate[f] = 0;
}

/* Work of all forces per time, W: positive while the motion goes downhill. */
static double power(const struct dem *dem, const struct servo *servo, const struct fire *fire)
{
#pragma omp parallel for schedule(static) if (dem->count >= dem->parallel_from)
    for (size_t b = 0; b < fire->blocks; b++) {
        size_t end = (b + 1) * BLOCK < dem->count ? (b + 1) * BLOCK : dem->count;
        double sum = 0;
        for (size_t k = b * BLOCK; k < end; k++) {
            const struct dem_grain *g = &dem->grains[k];
            sum += g->fx * g->vx + g->fy * g->vy + g->moment * g->spin;
        }
        fire->block[b][0] = sum;
    }
    double sum = 0;
    for (size_t b = 0; b < fire->blocks; b++)
        sum += fire->block[b][0];
    for (int f = 0; f < BOX_FREEDOMS && dem->box.given; f++)
        sum += box_force(dem, servo, f) * dem->box.rate[f];
    return sum;
}

/* v += dt F/m of one block; sums of |v|^2 and |F/m|^2 weighted by the fictitious masses. */
static void kick_block(struct dem *dem, const struct fire *fire, size_t begin, size_t end, double sums[2])
{
    sums[0] = sums[1] = 0;
    for (size_t k = begin; k < end; k++) {
        struct dem_grain *g = &dem->grains[k];
        if (g->fixed)
            continue;
        double m = grain_mass(fire, g), inertia = m * g->radius * g->radius;
        g->vx += fire->dt * g->fx / m;
        g->vy += fire->dt * g->fy / m;
        g->spin += fire->dt * g->moment / inertia;
        sums[0] += m * (g->vx * g->vx + g->vy * g->vy) + inertia * g->spin * g->spin;
        sums[1] += (g->fx * g->fx + g->fy * g->fy) / m + g->moment * g->moment / inertia;
    }
}

/* Returns |v| / |F/m|. */
static double kick(struct dem *dem, const struct servo *servo, const struct fire *fire)
{
#pragma omp parallel for schedule(static) if (dem->count >= dem->parallel_from)
    for (size_t b = 0; b < fire->blocks; b++)
        kick_block(dem, fire, b * BLOCK, (b + 1) * BLOCK < dem->count ? (b + 1) * BLOCK : dem->count, fire->block[b]);
    double velocity = 0, acceleration = 0;
    for (size_t b = 0; b < fire->blocks; b++) {
        velocity += fire->block[b][0];
        acceleration += fire->block[b][1];
    }
    for (int f = 0; f < BOX_FREEDOMS && dem->box.given; f++) {
        if (servo->hold[f] != HOLD_STRESS)
            continue;
        double m = box_mass(dem, fire, f), force = box_force(dem, servo, f);
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
#pragma omp parallel for schedule(static) if (dem->count >= dem->parallel_from)
    for (size_t k = 0; k < dem->count; k++) {
        struct dem_grain *g = &dem->grains[k];
        if (g->fixed)
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
        double force = box_force(dem, servo, f);
        dem->box.rate[f] = keep * dem->box.rate[f] + turn * force / box_mass(dem, fire, f);
        dem->box.size[f] += fire->dt * dem->box.rate[f];
    }
}

/* FIRE's rule: after BEGIN_STEPS downhill steps the time step grows and the steering weakens; one step uphill stops
 * everything and starts again with a shorter one. The longest stable step follows the stiffest contact. */
static void steer(struct dem *dem, struct fire *fire, double work)
{
    if (dem->stiffest > 0)
        fire->longest = LONGEST * sqrt(fire->mass / dem->stiffest);
    if (work > 0) {
        if (++fire->downhill > BEGIN_STEPS) {
            fire->dt *= GROW;
            fire->mix *= MIX_SHRINK;
        }
    } else if (work < 0) {
        stop(dem);
        fire->dt = fmax(fire->dt * SHRINK, 0.05 * fire->longest);
        fire->mix = MIX;
        fire->downhill = 0;
    }
    fire->dt = fmin(fire->dt, fire->longest);
}

/* `stiffness`, N/m, sets the first time step. -1 without memory. */
static int fire_begin(const struct dem *dem, double stiffness, struct fire *fire)
{
    *fire = (struct fire){.mass = 1, .mix = MIX, .blocks = (dem->count + BLOCK - 1) / BLOCK};
    fire->block = calloc(fire->blocks + 1, sizeof *fire->block);
    if (!fire->block)
        return error_memory("relaxation");
    for (size_t k = 0; k < dem->count; k++)
        fire->radius += dem->grains[k].radius / (double)dem->count;
    fire->wall_mass = fire->mass * sqrt((double)dem->count);
    fire->longest = LONGEST * sqrt(fire->mass / stiffness);
    fire->dt = 0.3 * fire->longest;
    return 0;
}

int dem_relax(struct dem *dem, const struct servo *servo, const struct patience *patience, long *steps)
{
    struct fire fire;
    int status = 0;
    if (fire_begin(dem, patience->stiffness, &fire))
        return -1;
    stop(dem);
    for (long step = 0; step <= patience->max_steps && !status; step++, ++*steps) {
        /* Friction springs follow the last displacement. */
        if (dem_forces_static(dem, step ? fire.dt : 0)) {
            status = -1;
            break;
        }
        if (step % CHECK_EVERY == 0) {
            struct imbalance imbalance = dem_imbalance(dem, servo);
            status = imbalance.largest <= patience->tolerance * imbalance.mean_fn;
        }
        if (!status) {
            steer(dem, &fire, power(dem, servo, &fire));
            drift(dem, servo, &fire, kick(dem, servo, &fire));
        }
    }
    free(fire.block);
    stop(dem);
    /* Out of patience: the forces belong to the place before the last move. */
    if (!status && dem_forces_static(dem, 0))
        return -1;
    return status;
}
