/* The course of a test. Rates follow from the inertial number I = rate (m / p)^1/2 (m the mean mass, p the pressure in
 * the plane, N/m): at I = 1e-3 and below a packing is quasi-static. Time steps are a share of (m / k)^1/2 of the
 * lightest grain at the stiffness that a contact may have, shortened where a contact is stiffer. Each step ends in a
 * relaxation to static equilibrium, so that the saved states do not depend on rate and drag but through the path. */
#include "simulation/dem/loading.h"

#include <math.h>
#include <string.h>

#include "pipeline/speak/error.h"

const char *const LOADING_TEST_NAMES[TESTS + 1] = {"isotropic",    "biaxial_vertical", "biaxial_horizontal",
                                                   "simple_shear", "oedometer",        "cyclic"};

/* kg. */
static double mean_mass(const struct dem *dem)
{
    double mass = 0;
    for (size_t k = 0; k < dem->count; k++)
        mass += dem->grains[k].mass / (double)dem->count;
    return mass;
}

/* m: of the largest or the smallest grain. */
static double extreme_radius(const struct dem *dem, int largest)
{
    double radius = dem->grains[0].radius;
    for (size_t k = 1; k < dem->count; k++)
        radius = largest ? fmax(radius, dem->grains[k].radius) : fmin(radius, dem->grains[k].radius);
    return radius;
}

/* Force that pressure, gravity and loads bring to a contact, N. */
static double expected_force(const struct loading *loading)
{
    double force = 2 * loading->pressure * extreme_radius(&loading->dem, 1);
    for (size_t k = 0; k < loading->dem.count; k++) {
        const struct dem_grain *g = &loading->dem.grains[k];
        force = fmax(force,
                     hypot(g->load_x + g->mass * loading->dem.gravity.x, g->load_y + g->mass * loading->dem.gravity.y));
    }
    return force;
}

/* Scales of the problem: forces, stiffness, time. Discs that only loads and gravity press have the pressure 0: their
 * time unit is infinite, and nothing that goes by a rate is done to them. */
static int loading_prepare(struct loading *loading)
{
    const struct simulation *simulation = loading->simulation;
    struct dem *dem = &loading->dem;
    dem->law = simulation->law;
    dem->gravity = simulation->gravity;
    dem->damping_ratio = dem_damping_ratio(simulation->restitution);
    dem->skin = 0.4 * extreme_radius(dem, 0);
    dem->mu = isnan(simulation->preparation_mu) ? simulation->law.mu : simulation->preparation_mu;
    dem->mu_wall = simulation->law.mu_wall;
    loading->pressure = !isnan(simulation->kappa) ? simulation->law.kn / simulation->kappa
                                                  : (isnan(simulation->pressure) ? 0 : simulation->pressure);
    if (loading->pressure < 0)
        return error_input("simulation: a pressure of %g N/m: give a positive one", loading->pressure);
    double force = expected_force(loading);
    struct contact_pair largest = contact_pair_of(&simulation->law, extreme_radius(dem, 1));
    loading->stiffness = contact_pair_stiffness(&simulation->law, &largest, 10 * force);
    dem->dust = 1e-4 * force;
    if (!(force > 0))
        return error_input("simulation: nothing presses the grains: give kappa, pressure_Pa, gravity or loads");
    loading->time_step = simulation->time_step * dem_time_unit(dem, loading->stiffness);
    loading->time_unit = sqrt(mean_mass(dem) / loading->pressure);
    loading->strain_rate = simulation->inertial / loading->time_unit;
    return 0;
}

static double solid_fraction(const struct dem *dem)
{
    double area = 0;
    for (size_t k = 0; k < dem->count; k++)
        area += M_PI * dem->grains[k].radius * dem->grains[k].radius;
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

int loading_relax(struct loading *loading)
{
    const struct simulation *simulation = loading->simulation;
    struct patience patience = {simulation->tolerance, simulation->max_steps, loading->stiffness};
    return dem_relax(&loading->dem, &loading->servo, &patience, &loading->steps);
}

/* One time step; short enough for the stiffest contact. */
static int step(struct loading *loading, struct stepping *stepping)
{
    struct dem *dem = &loading->dem;
    stepping->dt = loading->time_step;
    if (dem->stiffest > loading->stiffness)
        stepping->dt *= sqrt(loading->stiffness / dem->stiffest);
    loading->steps++;
    return dem_step(dem, &loading->servo, stepping);
}

/* Come together under the pressure of a servo whose rate is limited: slowly enough for the inertial number once there
 * is force, faster before. Done when both walls have carried the pressure for 200 steps on end. */
static int compress(struct loading *loading)
{
    static const double LOOSE = 0.75, HASTE = 20; /* no force yet below this solid fraction: come faster */
    struct servo *servo = &loading->servo;
    servo->hold[BOX_WIDTH] = servo->hold[BOX_HEIGHT] = HOLD_STRESS;
    servo->stress_x = servo->stress_y = loading->pressure;
    struct stepping stepping = {.drag = 0.01 / loading->time_step, .follow = 1};
    long most = loading->steps + 10 * loading->simulation->max_steps;
    for (long loaded = 0; loaded < 200;) {
        servo->fastest = loading->strain_rate * (solid_fraction(&loading->dem) < LOOSE ? HASTE : 1);
        if (step(loading, &stepping))
            return -1;
        loaded = is_loaded(loading) ? loaded + 1 : 0;
        if (loading->steps > most)
            break; /* the relaxation will say whether it is static */
    }
    servo->fastest = INFINITY;
    return 0;
}

/* Let the dashpots bring discs that were placed by hand nearly to rest, in true time: the friction springs follow the
 * way that the grains would go. */
static int settle(struct loading *loading)
{
    enum { CHECK_EVERY = 100 };
    static const double NEARLY = 1e-4;
    struct stepping stepping = {0};
    for (long k = 1; k <= loading->simulation->max_steps; k++) {
        if (step(loading, &stepping))
            return -1;
        if (k % CHECK_EVERY)
            continue;
        struct imbalance imbalance = dem_imbalance(&loading->dem, &loading->servo);
        if (imbalance.largest <= NEARLY * imbalance.mean_fn)
            break;
    }
    return 0;
}

int loading_begin(struct loading *loading)
{
    struct dem *dem = &loading->dem;
    if (loading_prepare(loading))
        return -1;
    if (dem->box.given && loading->pressure > 0 ? compress(loading) : settle(loading))
        return -1;
    int done = loading_relax(loading);
    if (done >= 0 && dem->mu != loading->simulation->law.mu) {
        dem->mu = loading->simulation->law.mu;
        done = loading_relax(loading);
    }
    memcpy(loading->size, dem->box.size, sizeof loading->size);
    return done;
}

static long steps_in(const struct loading *loading, double duration)
{
    return (long)ceil(duration / loading->time_step) + 1;
}

/* So many time steps; set(loading, amount, share of them that is done) moves the servo before each. */
static int ramp(struct loading *loading, long steps, void (*set)(struct loading *, double, double), double amount)
{
    /* A slight drag brings loose grains to rest. */
    struct stepping stepping = {.drag = 1e-3 / loading->time_step, .follow = 1};
    loading->fastest = 0;
    for (long k = 0; k < steps; k++) {
        if (set)
            set(loading, amount, (double)(k + 1) / (double)steps);
        if (step(loading, &stepping))
            return -1;
        const struct dem_box *box = &loading->dem.box;
        for (int f = 0; f < BOX_FREEDOMS; f++)
            loading->fastest = fmax(loading->fastest, fabs(box->rate[f]) / (f == BOX_SHEAR ? 1 : box->size[f]));
    }
    return 0;
}

/* Move one freedom by so much of its size in state 0, then hold it there (or hold the stress that it has now). */
static int strain_step(struct loading *loading, int freedom, double strain)
{
    struct dem *dem = &loading->dem;
    struct servo *servo = &loading->servo;
    double amount = freedom == BOX_SHEAR ? strain : -strain * loading->size[freedom];
    double target = dem->box.size[freedom] + amount;
    long steps = steps_in(loading, fabs(strain) / loading->strain_rate);
    servo->hold[freedom] = HOLD_RATE;
    servo->rate[freedom] = amount / ((double)steps * loading->time_step);
    if (ramp(loading, steps, NULL, 0))
        return -1;
    if (loading->simulation->relax_at_stress) {
        double *const stress[BOX_FREEDOMS] = {&servo->stress_x, &servo->stress_y, &servo->stress_xy};
        servo->hold[freedom] = HOLD_STRESS;
        *stress[freedom] = box_stress(dem, freedom);
    } else {
        servo->hold[freedom] = HOLD_SIZE;
        dem->box.size[freedom] = target; /* exactly, also where a stiff contact has shortened the time steps */
    }
    return loading_relax(loading);
}

/* Long enough for the inertial number (a packing is about half as stiff as kappa p) and for sound to travel. */
static double stress_duration(const struct loading *loading, double change)
{
    double kappa = loading->stiffness / loading->pressure;
    return fabs(change) * fmax(2 / (kappa * loading->simulation->inertial), 10) * loading->time_unit;
}

/* Setters of ramp(): the stress by `amount` more, not below what keeps the packing together; */
static void set_isotropic(struct loading *loading, double amount, double share)
{
    struct servo *servo = &loading->servo;
    (void)share;
    servo->stress_x = fmax(servo->stress_x + amount, SIMULATION_STRESS_MIN * loading->pressure);
    servo->stress_y = fmax(servo->stress_y + amount, SIMULATION_STRESS_MIN * loading->pressure);
}

/* likewise, of the top wall alone; */
static void set_vertical(struct loading *loading, double amount, double share)
{
    double kept = loading->servo.stress_x;
    set_isotropic(loading, amount, share);
    loading->servo.stress_x = kept;
}

static int stress_step(struct loading *loading, double change, void (*set)(struct loading *, double, double))
{
    long steps = steps_in(loading, stress_duration(loading, change));
    if (ramp(loading, steps, set, change * loading->pressure / (double)steps))
        return -1;
    return loading_relax(loading);
}

/* and the sine p (1 + A sin 2 pi c) of the cycles c so far. */
static void set_swing(struct loading *loading, double cycles, double share)
{
    const double two_pi = 6.283185307179586;
    double phase = loading->turns + cycles * share;
    loading->servo.stress_y = loading->pressure * (1 + loading->simulation->amplitude * sin(two_pi * phase));
}

static int cyclic_step(struct loading *loading, double cycles)
{
    long steps = steps_in(loading, stress_duration(loading, 4 * loading->simulation->amplitude * cycles));
    if (ramp(loading, steps, set_swing, cycles))
        return -1;
    loading->turns += cycles;
    return loading_relax(loading);
}

int loading_step(struct loading *loading, double amount)
{
    struct servo *servo = &loading->servo;
    const struct simulation *simulation = loading->simulation;
    switch (simulation->test) {
    case TEST_BIAXIAL_VERTICAL:
        return strain_step(loading, BOX_HEIGHT, amount);
    case TEST_BIAXIAL_HORIZONTAL:
        return strain_step(loading, BOX_WIDTH, amount);
    case TEST_SIMPLE_SHEAR:
        servo->hold[BOX_WIDTH] = HOLD_SIZE;
        return strain_step(loading, BOX_SHEAR, amount);
    case TEST_OEDOMETER:
        servo->hold[BOX_WIDTH] = HOLD_SIZE;
        return simulation->by_stress ? stress_step(loading, amount, set_vertical)
                                     : strain_step(loading, BOX_HEIGHT, amount);
    case TEST_CYCLIC:
        servo->hold[BOX_WIDTH] = simulation->lateral_fixed ? HOLD_SIZE : HOLD_STRESS;
        return cyclic_step(loading, amount);
    default:
        return stress_step(loading, amount, set_isotropic);
    }
}
