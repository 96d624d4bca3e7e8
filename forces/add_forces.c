/* Forces of one packing by one method after the other; everything that was asked about them is answered before their
 * file is written, so that a failure leaves no half of it. */
#include "forces/add_forces.h"

#include <stdlib.h>
#include <string.h>

#include "forces/forces_file.h"
#include "forces/questions/fclib.h"
#include "forces/network/network_loads.h"
#include "forces/questions/range.h"
#include "forces/questions/buckling.h"
#include "forces/questions/walk.h"
#include "pipeline/command/cli.h"
#include "pipeline/speak/error.h"
#include "pipeline/packing/stress.h"
#include "pipeline/packing/packing_check.h"
#include "pipeline/packing/packing_file.h"

#define UNBALANCED 0.01 /* <fn>: a grain whose unbalanced force is larger counts */

/* For the log: what a run is judged by. */
static void tell(const struct forces *forces)
{
    log_event(forces->method, "iterations", (double)forces->iterations, "converged", (double)forces->converged,
              "residual", forces->imbalance, "residual_mean", forces->imbalance_mean, "infeasible",
              (double)forces->infeasible, "stress_xx", forces->stress[0][0], "stress_yy", forces->stress[1][1], NULL);
}

/* Another state is read for its forces. */
static int read_state_with_forces(const char *path, struct packing *packing)
{
    if (!path)
        return 0;
    if (packing_read(path, packing))
        return -1;
    return packing->force_count ? 0 : error_input("%s: has no forces: give a file written by forces or simulate", path);
}

/* What else the forces could be: a random walk, exact ranges; and whether the state is stable. */
static int look_around(const struct packing *packing, const struct force_options *options, enum force_method method,
                       struct forces *forces)
{
    if (options->walk > 0 && walk_forces(packing, options, method, forces))
        return -1;
    if (options->walk > 0)
        log_event("walk", "states", forces->walk.states, "variance_fn", forces->walk.variance[0], "variance_ft",
                  forces->walk.variance[1], "range_fn", forces->walk.range[0], "range_ft", forces->walk.range[1], NULL);
    if (options->stability && stability_of_forces(packing, options, forces))
        return -1;
    if (options->stability)
        log_event("stability", "stick", forces->stability[0], "slip", forces->stability[1], NULL);
    return options->range ? range_forces(packing, options, method, forces) : 0;
}

/* outcome->unbalanced: of the worst method that seeks equilibrium. */
static int infer_all(const struct force_request *request, const struct force_options *options, struct packing *packing,
                     struct force_outcome *outcome)
{
    double misfit[2], share = network_load_misfit(packing, misfit);
    if (isfinite(share)) /* all four walls are loaded: left and bottom react */
        log_event("loads", "misfit", share, "misfit_x", misfit[0], "misfit_y", misfit[1], NULL);
    for (int k = 0; k < request->methods.count; k++) {
        enum force_method method = request->methods.method[k];
        struct forces inferred;
        if (infer_forces(packing, options, method, &inferred))
            return error_context("%s", request->input);
        int status = look_around(packing, options, method, &inferred) ? error_context("%s", request->input) : 0;
        size_t out = forces_unbalanced_grains(packing, &inferred, UNBALANCED);
        if (!status)
            tell(&inferred), verdict_note(&outcome->verdict, request->input, packing, &inferred);
        if (status || forces_take_in(packing, &inferred)) {
            forces_free(&inferred);
            return -1;
        }
        if (method_row(method)->balances && out > outcome->unbalanced)
            outcome->unbalanced = out;
    }
    return 0;
}

/* The files that had a say stand in the provenance. */
static int write_forces(const struct force_request *request, const struct force_options *options,
                        const struct packing *packing)
{
    const char *inputs[3] = {request->input};
    size_t count = 1;
    if (request->previous)
        inputs[count++] = request->previous;
    if (request->from)
        inputs[count++] = request->from;
    char *parameters = force_options_text(&request->methods, options);
    if (!parameters)
        return -1;
    int status = forces_write(request->output, packing, request->scene, parameters, inputs, count);
    free(parameters);
    return status;
}

int add_forces(const struct force_request *request, struct force_outcome *outcome)
{
    struct packing packing = {0}, previous = {0}, from = {0};
    struct force_options options = request->options;
    options.previous = request->previous ? &previous : NULL;
    options.from = request->from ? &from : NULL;
    *outcome = (struct force_outcome){.overlaps_over_loads = NAN};
    int status = packing_read(request->input, &packing) || check_fresh(request->input, &packing, request->scene) ||
                 read_state_with_forces(request->previous, &previous) ||
                 (request->previous && (state_check_order(request->previous, &previous.info, &packing.info) ||
                                        packing_check_previous(request->previous, &previous, &packing))) ||
                 read_state_with_forces(request->from, &from) || infer_all(request, &options, &packing, outcome) ||
                 (request->fclib && fclib_write(request->fclib, &packing, &options)) ||
                 write_forces(request, &options, &packing);
    outcome->grains = packing.grains.count;
    if (!status && contact_law_row(&options.law)->linear)
        outcome->overlaps_over_loads = stress_overlaps_over_loads(&packing, options.law.kn);
    packing_free(&packing);
    packing_free(&previous);
    packing_free(&from);
    return status ? -1 : 0;
}
