#include "simulation/dem/summary.h"

#include "pipeline/packing/stress.h"

/* Unknown forces less equations: 2 per contact (1 without friction), 3 per grain that carries, 1 per loaded wall. */
static double indeterminacy(const struct dem *dem, const struct servo *servo, const struct packing *packing)
{
    const struct contacts *contacts = &packing->contacts;
    const struct grains *grains = &packing->grains;
    double h = 0;
    for (size_t c = 0; c < contacts->count; c++) {
        size_t i = (size_t)contacts->i[c], j = (size_t)contacts->j[c];
        int wall = j >= grains->count;
        if (!(grains->flags[i] & GRAIN_RATTLER) && (wall || !(grains->flags[j] & GRAIN_RATTLER)))
            h += (wall ? dem->mu_wall : dem->mu) > 0 ? 2 : 1;
    }
    for (size_t k = 0; k < grains->count; k++)
        h -= grains->flags[k] & (GRAIN_RATTLER | GRAIN_FIXED) ? 0 : 3;
    for (int f = 0; f < BOX_FREEDOMS && dem->box.given; f++)
        h -= servo->hold[f] == HOLD_STRESS;
    return h;
}

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

void summary_fill(const struct dem *dem, const struct servo *servo, const struct packing *packing,
                  struct simulation_state *state)
{
    struct fabric fabric;
    double length = isnan(packing->length_m) ? 1 : packing->length_m, area = packing_area(packing);
    if (dem->box.given)
        stress_applied(packing, area, state->applied);
    for (int a = 0; a < 2; a++)
        for (int b = 0; b < 2; b++) {
            state->stress[a][b] = length * packing->forces->stress[a][b];
            state->applied[a][b] = dem->box.given ? length * state->applied[a][b] : NAN;
        }
    packing_fabric(packing, &fabric);
    state->solid = fabric.solid;
    state->z = fabric.z;
    state->rattlers = (double)fabric.rattlers / (double)packing->grains.count;
    state->indeterminacy = indeterminacy(dem, servo, packing);
    contacts_fill(dem, state);
    struct dem_energy energy = dem_energy(dem);
    state->stored = energy.stored;
    state->lost = energy.lost;
    state->work = dem->box.work;
    state->unbalanced = packing->forces->imbalance;
}
