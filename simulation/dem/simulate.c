/* The states of a test in order: state 0 after the compression, from which motions and strains count, then one after
 * each step. A state that does not come to rest is saved too, and says so. */
#include "simulation/dem/simulate.h"

#include <math.h>

#include "pipeline/speak/error.h"
#include "simulation/dem/loading.h"
#include "simulation/dem/placement.h"
#include "simulation/dem/snapshot.h"
#include "simulation/dem/summary.h"

struct run {
    struct loading loading;
    struct snapshot reference, previous;
    simulation_save *save;
    void *user;
    int64_t index;
    long unrelaxed; /* states that did not come to rest */
};

/* Nominal strains, compression positive, and the change of the shear. */
static void strain_since(const struct dem_box *then, const struct dem_box *now, double strain[3])
{
    strain[0] = 1 - now->size[BOX_WIDTH] / then->size[BOX_WIDTH];
    strain[1] = 1 - now->size[BOX_HEIGHT] / then->size[BOX_HEIGHT];
    strain[2] = now->size[BOX_SHEAR] - then->size[BOX_SHEAR];
}

static int save_state(struct run *run, int relaxed)
{
    struct dem *dem = &run->loading.dem;
    struct packing packing = {0};
    struct simulation_state state = {.index = run->index,
                                     .pressure = run->loading.pressure,
                                     .inertial = run->loading.fastest * run->loading.time_unit,
                                     .relaxed = relaxed,
                                     .steps = run->loading.steps};
    if (dem->box.given && run->reference.given)
        strain_since(&run->reference.box, &dem->box, state.strain);
    int status =
        snapshot_packing(dem, &run->loading.servo, run->reference.given ? &run->reference : NULL,
                         run->previous.given ? &run->previous : NULL, run->loading.simulation->length, &packing);
    if (!status) {
        packing.forces->iterations = (int)fmin((double)run->loading.steps, 2e9);
        packing.forces->converged = relaxed;
        status = summary_fill(dem, &packing, &state) || run->save(&packing, &state, run->user) ? -1 : 0;
    }
    packing_free(&packing);
    snapshot_free(&run->previous);
    if (status || snapshot_take(dem, &run->previous))
        return -1;
    if (!run->reference.given && snapshot_take(dem, &run->reference))
        return -1;
    run->unrelaxed += !relaxed;
    run->index++;
    return 0;
}

static int run_test(struct run *run)
{
    const struct simulation *simulation = run->loading.simulation;
    for (size_t s = 0; s < simulation->step_count; s++)
        for (long k = 0; k < simulation->steps[s].count; k++) {
            int relaxed = loading_step(&run->loading, simulation->steps[s].amount);
            if (relaxed < 0 || save_state(run, relaxed))
                return -1;
        }
    return 0;
}

static int run_all(struct run *run)
{
    struct dem *dem = &run->loading.dem;
    int relaxed = loading_begin(&run->loading);
    if (relaxed < 0)
        return -1;
    for (size_t k = 0; k < dem->count; k++)
        dem->grains[k].angle = 0; /* rotations count from the reference */
    return save_state(run, relaxed) || run_test(run) ? -1 : 0;
}

long simulation_states(const struct simulation *simulation)
{
    long states = 1;
    for (size_t s = 0; s < simulation->step_count; s++)
        states += simulation->steps[s].count;
    return states;
}

int simulate(const struct simulation *simulation, simulation_save *save, void *user)
{
    struct run run = {.save = save, .user = user, .loading.simulation = simulation};
    int status = placement(simulation, &run.loading.dem);
    if (!status)
        status = run_all(&run);
    if (!status && run.unrelaxed) {
        error_set(EXIT_FLAGGED,
                  "simulation: %ld of %ld states did not come to rest in %ld steps: raise max_steps or tolerance",
                  run.unrelaxed, (long)run.index, simulation->max_steps);
        status = 1;
    }
    snapshot_free(&run.reference);
    snapshot_free(&run.previous);
    dem_free(&run.loading.dem);
    return status;
}
