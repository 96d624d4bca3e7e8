/* Stresses here are N/m; the tables of a packing hold Pa where the rods have a length, hence the factor. kappa is the
 * mean normal stiffness of the contacts over the mean stress: a packing at kappa gives way by about 1 / kappa of a
 * diameter at its contacts. */
#include "simulation/dem/summary.h"

#include "pipeline/packing/stress.h"
#include "pipeline/packing/structure.h"

static void contacts_fill(const struct dem *dem, struct simulation_state *state)
{
    size_t touching = 0, between = 0, sliding = 0;
    double stiffness = 0;
    for (size_t p = 0; p < dem->pair_count; p++) {
        const struct dem_pair *pair = &dem->pairs[p];
        if (!pair->touching)
            continue;
        touching++;
        stiffness += pair->spring.stiffness;
        if ((size_t)pair->j < dem->count) {
            between++;
            sliding += (size_t)pair->slips;
        }
    }
    double mean = 0.5 * (state->stress[0][0] + state->stress[1][1]);
    state->kappa = touching && mean > 0 ? stiffness / (double)touching / mean : NAN;
    state->sliding = between ? (double)sliding / (double)between : 0;
}

int summary_fill(const struct dem *dem, struct packing *packing, struct simulation_state *state)
{
    struct fabric fabric;
    double length = isnan(packing->length_m) ? 1 : packing->length_m, area;
    if (packing_area(packing, &area) || packing_indeterminacy(packing, dem->mu, dem->mu_wall, &packing->indeterminacy))
        return -1;
    if (dem->box.given)
        stress_applied(packing, area, state->applied);
    for (int a = 0; a < 2; a++)
        for (int b = 0; b < 2; b++) {
            state->stress[a][b] = length * packing->forces->stress[a][b];
            state->applied[a][b] = dem->box.given ? length * state->applied[a][b] : NAN;
        }
    packing_fabric(packing, area, &fabric);
    state->solid = fabric.solid;
    state->z = fabric.z;
    state->rattlers = (double)fabric.rattlers / (double)packing->grains.count;
    state->indeterminacy = packing->indeterminacy.h;
    contacts_fill(dem, state);
    struct dem_energy energy = dem_energy(dem);
    state->stored = energy.stored;
    state->lost = energy.lost;
    state->work = dem->box.work;
    state->unbalanced = packing->forces->imbalance;
    return 0;
}
