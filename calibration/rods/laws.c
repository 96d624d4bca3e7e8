/* One packing per law, all of the same seed: the loose placement is the same, the consolidated packing differs as the
 * law makes it. Strains grow in a geometric series, so that the fall of the modulus is seen over decades; at the end
 * the strain turns back. A contact loads for the first time where it is at its largest force so far; below, it unloads
 * or reloads by the sign of its change. The main direction of a group is that of its fabric tensor: half the angle of
 * (sum nx^2 - ny^2, sum 2 nx ny). */
#include "calibration/rods/laws.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "pipeline/speak/error.h"
#include "simulation/dem/snapshot.h"

const char *const GROUP_NAMES[GROUPS] = {"loading", "unloading", "reloading"};

void law_curve_free(struct law_curve *curve)
{
    free(curve->steps);
    memset(curve, 0, sizeof *curve);
}

/* Sorted like the DEM's list: pairs of grains, then walls, each by (i, j). */
static int after(const struct dem_pair *a, const struct dem_pair *b, size_t grains)
{
    int wall_a = (size_t)a->j >= grains, wall_b = (size_t)b->j >= grains;
    if (wall_a != wall_b)
        return wall_a > wall_b;
    return a->i != b->i ? a->i > b->i : a->j > b->j;
}

static enum law_group group_of(const struct dem_pair *before, const struct dem_pair *now)
{
    if (!before || now->spring.fn >= before->spring.peak)
        return GROUP_LOADING;
    return now->spring.fn < before->spring.fn ? GROUP_UNLOADING : GROUP_RELOADING;
}

/* Contacts by what they did since `before`. */
static void count_groups(const struct snapshot *before, const struct dem *dem, struct law_step *step)
{
    double fabric[GROUPS][2] = {{0}}; /* sums of nx^2 - ny^2, 2 nx ny */
    size_t b = 0;
    for (size_t p = 0; p < dem->pair_count; p++) {
        const struct dem_pair *now = &dem->pairs[p];
        if (!now->touching)
            continue;
        while (b < before->pair_count && after(now, &before->pairs[b], dem->count))
            b++;
        int same = b < before->pair_count && before->pairs[b].i == now->i && before->pairs[b].j == now->j;
        enum law_group group = group_of(same ? &before->pairs[b] : NULL, now);
        step->count[group]++;
        fabric[group][0] += now->nx * now->nx - now->ny * now->ny;
        fabric[group][1] += 2 * now->nx * now->ny;
    }
    for (int g = 0; g < GROUPS; g++)
        step->angle[g] = step->count[g] ? fabs(0.5 * atan2(fabric[g][1], fabric[g][0])) : NAN;
}

/* Strains count from the consolidated height. */
static int take_step(struct probe_packing *packing, double to, double height, struct law_step *step)
{
    struct loading *loading = &packing->loading;
    struct dem *dem = &loading->dem;
    struct snapshot before;
    double stress_before = box_stress(dem, BOX_HEIGHT), strain_before = 1 - dem->box.size[BOX_HEIGHT] / height;
    if (snapshot_take(dem, &before))
        return -1;
    int rested = loading_step(loading, to - strain_before);
    if (rested >= 0) {
        step->rested = rested;
        step->strain = 1 - dem->box.size[BOX_HEIGHT] / height;
        step->young = (box_stress(dem, BOX_HEIGHT) - stress_before) / (step->strain - strain_before);
        step->deviator = box_stress(dem, BOX_HEIGHT) - box_stress(dem, BOX_WIDTH);
        count_groups(&before, dem, step);
    }
    snapshot_free(&before);
    return rested < 0 ? -1 : 0;
}

/* Of the contacts that carry, before the probe: mean stiffness and how much of their largest force they bear. */
static void describe(const struct dem *dem, struct law_curve *curve)
{
    double stiffness = 0, mobilised = 0;
    size_t count = 0;
    for (size_t p = 0; p < dem->pair_count; p++) {
        const struct dem_pair *pair = &dem->pairs[p];
        if (!pair->touching || !(pair->spring.peak > 0))
            continue;
        stiffness += pair->spring.stiffness;
        mobilised += pair->spring.fn / pair->spring.peak;
        count++;
    }
    curve->mean_stiffness = stiffness / (double)count;
    curve->mobilised = mobilised / (double)count;
}

static int run_steps(struct probe_packing *packing, const struct law_probe *probe, struct law_curve *curve)
{
    struct loading *loading = &packing->loading;
    double height = loading->dem.box.size[BOX_HEIGHT];
    packing->simulation.test = TEST_BIAXIAL_VERTICAL;
    packing->simulation.relax_at_stress = 0;
    memcpy(loading->size, loading->dem.box.size, sizeof loading->size);
    for (size_t k = 0; k < curve->count; k++) {
        double to = probe->first * pow(10, (double)k / probe->per_decade);
        if (k + 1 >= curve->loading)
            to = probe->last;
        if (k >= curve->loading)
            to = probe->last * (1 - 0.5 * (double)(k + 1 - curve->loading) / probe->back);
        if (take_step(packing, to, height, &curve->steps[k]))
            return -1;
    }
    return 0;
}

int law_compare(const struct simulation *simulation, const struct contact_law *law, const struct law_probe *probe,
                struct law_curve *curve)
{
    struct simulation with = *simulation;
    struct probe_packing packing;
    memset(curve, 0, sizeof *curve);
    if (!(probe->first > 0 && probe->last > probe->first) || probe->per_decade < 1)
        return error_input("strains from %g to %g: the first is positive and below the last", probe->first,
                           probe->last);
    curve->law = *law;
    curve->loading = (size_t)ceil(probe->per_decade * log10(probe->last / probe->first) - 1e-9) + 1;
    curve->count = curve->loading + (size_t)probe->back;
    curve->steps = calloc(curve->count, sizeof *curve->steps);
    if (!curve->steps)
        return error_memory("comparison of laws");
    with.law = *law;
    if (probe_consolidate(&with, &packing)) {
        law_curve_free(curve);
        return -1;
    }
    probe_fabric(&packing, &curve->fabric);
    describe(&packing.loading.dem, curve);
    packing.simulation.law.mu = packing.loading.dem.mu = simulation->law.mu;
    int status = run_steps(&packing, probe, curve);
    probe_packing_free(&packing);
    if (status)
        law_curve_free(curve);
    return status;
}
