/* E and nu are secants over one small strain from rest to rest. The strain is small enough for the contacts to stay
 * (docs/calibration_hertz.md), and friction is raised for it, so that nothing slides: the moduli are those of the
 * springs. When the grains' modulus changes by a ratio r at the same pressure, stiffnesses go as r^2/3 and time steps
 * as r^-1/3 (Hertz: k ~ E*^2/3 F^1/3). */
#include "calibration/hertz/probe.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "pipeline/numbers/quantiles.h"
#include "pipeline/speak/error.h"
#include "simulation/dem/placement.h"

void probe_packing_free(struct probe_packing *packing)
{
    dem_free(&packing->loading.dem);
    memset(packing, 0, sizeof *packing);
}

int probe_consolidate(const struct simulation *simulation, struct probe_packing *packing)
{
    memset(packing, 0, sizeof *packing);
    packing->simulation = *simulation;
    packing->loading.simulation = &packing->simulation;
    /* The friction of the compression stays: loading_begin() would raise it to the law's and relax again. */
    if (!isnan(simulation->preparation_mu))
        packing->simulation.law.mu = simulation->preparation_mu;
    int rested = placement(simulation, &packing->loading.dem) ? -1 : loading_begin(&packing->loading);
    if (rested < 0) {
        probe_packing_free(packing);
        return -1;
    }
    return 0;
}

/* A copy whose loading points at its own simulation. */
static int copy(const struct probe_packing *from, struct probe_packing *to)
{
    *to = *from;
    memset(&to->loading.dem, 0, sizeof to->loading.dem);
    to->loading.simulation = &to->simulation;
    return dem_copy(&from->loading.dem, &to->loading.dem);
}

/* Springs keep their overlaps; tangential forces grow with the stiffness, so that no friction is spent by the change.
 */
static void scale_tangential(struct dem *dem, double ratio)
{
    for (size_t p = 0; p < dem->pair_count; p++) {
        dem->pairs[p].spring.ft *= ratio;
        dem->pairs[p].spring.stiffness *= ratio;
        dem->pairs[p].spring.peak *= ratio;
    }
}

static double modulus(const struct contact_law *law)
{
    return law->young / (1 - law->poisson * law->poisson);
}

int probe_adapt(const struct probe_packing *packing, const struct contact_law *law, struct probe_packing *adapted)
{
    if (copy(packing, adapted))
        return -1;
    struct loading *loading = &adapted->loading;
    double ratio = modulus(law) / modulus(&packing->simulation.law);
    adapted->simulation.law = *law;
    adapted->simulation.law.mu = packing->simulation.law.mu; /* that of the compression */
    adapted->simulation.law.mu_wall = packing->simulation.law.mu_wall;
    int status = dem_change_law(&loading->dem, &adapted->simulation.law);
    scale_tangential(&loading->dem, ratio);
    loading->stiffness *= pow(ratio, 2.0 / 3);
    loading->time_step *= pow(ratio, -1.0 / 3);
    loading->steps = 0;
    loading->servo.hold[BOX_WIDTH] = loading->servo.hold[BOX_HEIGHT] = HOLD_STRESS;
    if (status || loading_relax(loading) < 0) {
        probe_packing_free(adapted);
        return -1;
    }
    memcpy(loading->size, loading->dem.box.size, sizeof loading->size);
    return 0;
}

void probe_fabric(const struct probe_packing *packing, struct probe_fabric *fabric)
{
    const struct dem *dem = &packing->loading.dem;
    double area = 0, box = dem->box.size[BOX_WIDTH] * dem->box.size[BOX_HEIGHT];
    double *radius = malloc((dem->count + 1) * sizeof *radius);
    size_t between = 0, wall = 0;
    for (size_t k = 0; k < dem->count; k++) {
        area += M_PI * dem->grains[k].radius * dem->grains[k].radius;
        if (radius)
            radius[k] = dem->grains[k].radius;
    }
    for (size_t p = 0; p < dem->pair_count; p++)
        if (dem->pairs[p].touching)
            p < dem->first[dem->count] ? between++ : wall++;
    fabric->porosity = 1 - area / box;
    fabric->z = (2 * (double)between + (double)wall) / (double)dem->count;
    fabric->volume_per_contact = box / ((double)between + 0.5 * (double)wall); /* a wall's branch is half as long */
    fabric->d50 = radius ? 2 * median_of(radius, dem->count) : NAN;
    free(radius);
}

/* One step of the biaxial test, at the strain. */
static int strain(struct probe_packing *packing, double by, struct probe_result *result)
{
    struct loading *loading = &packing->loading;
    const struct dem *dem = &loading->dem;
    double width = dem->box.size[BOX_WIDTH], height = dem->box.size[BOX_HEIGHT], before = box_stress(dem, BOX_HEIGHT);
    packing->simulation.test = TEST_BIAXIAL_VERTICAL;
    packing->simulation.relax_at_stress = 0;
    memcpy(loading->size, dem->box.size, sizeof loading->size);
    int rested = loading_step(loading, by);
    if (rested < 0)
        return -1;
    double eps_x = 1 - dem->box.size[BOX_WIDTH] / width, eps_y = 1 - dem->box.size[BOX_HEIGHT] / height;
    result->young = (box_stress(dem, BOX_HEIGHT) - before) / eps_y;
    result->poisson = -eps_x / eps_y;
    return rested;
}

int probe_run(const struct probe_packing *packing, const struct probe_options *options, struct probe_result *result)
{
    struct probe_packing probe;
    memset(result, 0, sizeof *result);
    probe_fabric(packing, &result->fabric);
    if (copy(packing, &probe))
        return -1;
    probe.simulation.law.mu = probe.loading.dem.mu = options->mu;
    probe.loading.dem.law.mu = options->mu;
    int first = loading_relax(&probe.loading), second = first < 0 ? -1 : strain(&probe, options->strain, result);
    result->rested = first == 1 && second == 1;
    result->steps = probe.loading.steps;
    probe_packing_free(&probe);
    if (second < 0)
        return -1;
    if (!isfinite(result->young) || !(result->young > 0))
        return error_input("the probe found E = %g: the packing carries nothing: raise the pressure", result->young);
    return 0;
}
