/* One packing, one method: the network is built, the method begins and works, and whatever it leaves is judged in the
 * same way: by the largest component that is out of balance, over <fn>. A method that stops early has not failed; where
 * it leaves more than it should, the loads themselves may be at fault, and a proof of that is sought (Farkas). */
#include "forces/infer_forces.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "forces/methods/start.h"
#include "forces/network/elastic.h"
#include "forces/network/network_loads.h"
#include "forces/questions/certificate.h"
#include "pipeline/speak/error.h"

const char *const FORCE_STARTS[] = {"default", "zero", "mean", "overlap", "cem", "previous", "file", NULL};
const char *const FORCE_FIXES[] = {"none", "normal", "tangential", NULL};

/* Before anything is built: what the row says it needs. */
static int check_needs(const struct packing *packing, const struct force_options *options, const struct method *method)
{
    if ((method->needs & NEEDS_STIFFNESS) && !contact_law_known(&options->law))
        return error_input("no contact stiffness: method %s needs the scene's contact.kn_N_per_m or young_Pa",
                           method->name);
    if ((method->needs & NEEDS_OVERLAPS) && !packing->contacts.overlap)
        return error_input("the contacts have no overlaps, which method %s needs: run contacts again", method->name);
    if ((method->needs & NEEDS_PREVIOUS) && !options->previous)
        return error_input("no previous state, which method %s needs: give --previous FILE.forces.hdf", method->name);
    if (!(options->law.kt_over_kn >= 0) || !isfinite(options->law.kt_over_kn))
        return error_input("contact.kt_over_kn must be a number of 0 or more");
    return 0;
}

/* Largest load on a grain that nothing can hold, in working units: it stays unbalanced. Grains that were not measured
 * are left out: nobody knows what holds them. */
static double falling(const struct packing *packing, const struct network *network)
{
    const struct grains *g = &packing->grains;
    double largest = 0;
    for (size_t k = 0; k < network->grains; k++) {
        if (!network->peeled[k] || (g->flags && (g->flags[k] & GRAIN_DISTRUST)))
            continue;
        largest = fmax(largest, g->load_x ? fabs(g->load_x[k]) / network->force : 0);
        largest = fmax(largest, g->load_y ? fabs(g->load_y[k]) / network->force : 0);
        largest = fmax(largest, g->load_m ? fabs(g->load_m[k]) / network->force / network->radius : 0);
    }
    return largest;
}

/* A method that does not seek equilibrium is judged like the others. Where a force is not known (only such a method may
 * leave NaN), the balance is not either, and does not count as reached. */
static int judge(const struct problem *problem, const struct method *method, const double *f, struct outcome *outcome,
                 double *unbalance)
{
    const struct network *network = problem->network;
    double held = network_judge(network, f, unbalance);
    double free = falling(problem->packing, network) / network_mean_force(network, f);
    outcome->imbalance = isnan(held) || isnan(free) ? NAN : fmax(held, free);
    outcome->converged = outcome->imbalance <= problem->options->tolerance;
    for (size_t k = 0; k < 2 * network->count; k++)
        if (!isfinite(f[k]) && (method->balances || !isnan(f[k])))
            return error_input("the forces are not finite: look for absurd numbers in the file");
    return 0;
}

static int store(const struct problem *problem, const struct method *method, const double *f,
                 const struct outcome *outcome, const double *unbalance, struct forces *forces)
{
    const struct contact_law *law = &problem->options->law;
    snprintf(forces->method, sizeof forces->method, "%s", method->name);
    snprintf(forces->start, sizeof forces->start, "%s", FORCE_STARTS[start_meant(problem, method)]);
    forces->iterations = outcome->iterations;
    forces->converged = outcome->converged;
    forces->imbalance = outcome->imbalance;
    forces->kn = law->kn;
    forces->kt = law->kn * law->kt_over_kn;
    forces->mu = law->mu;
    return result_store(problem->packing, problem->network, method->margin, f, unbalance, forces);
}

/* Are the loads infeasible for these contacts? Then the ray that proves it stands in the result. */
static int prove(const struct network *network, const struct force_options *options, struct forces *forces)
{
    double *y = calloc(network->dofs + 1, sizeof *y), least_sum = 0;
    int status = y ? certificate_find(network, options, y, &least_sum) : error_memory("certificate");
    forces->infeasible = !status && certificate_holds(network, least_sum);
    if (forces->infeasible && !(status = table_alloc(&RAYS, &forces->ray, network->grains, NULL)))
        for (size_t k = 0; k < network->grains; k++)
            if (network->grain_dof[k] >= 0) {
                const double *of_grain = y + network->grain_dof[k];
                forces->ray.ray_x[k] = of_grain[0], forces->ray.ray_y[k] = of_grain[1];
                forces->ray.ray_m[k] = of_grain[2];
            }
    free(y);
    return status;
}

/* Draws of what the data leave open, from the same start as the forces. */
static int sample(const struct problem *problem, const struct method *method, struct contact_forces *out)
{
    struct spread spread = {0};
    double *start = calloc(2 * problem->network->count + 1, sizeof *start);
    int status = !start                                                   ? error_memory("samples")
                 : method->starts && start_forces(problem, method, start) ? -1
                                                                          : method->sample(problem, start, &spread);
    if (!status)
        status = result_store_spread(problem->network, &spread, out);
    spread_free(&spread);
    free(start);
    return status;
}

/* Forces, judgement, proof, spread. */
static int infer(const struct problem *problem, const struct method *method, struct forces *forces)
{
    const struct network *network = problem->network;
    double *f = calloc(2 * network->count + 1, sizeof *f), *unbalance = calloc(network->dofs + 1, sizeof *unbalance);
    struct outcome outcome = {0};
    int status = f && unbalance ? 0 : error_memory("forces");
    if (!status)
        status = (method->starts && start_forces(problem, method, f)) || method->solve(problem, f, &outcome) ||
                         judge(problem, method, f, &outcome, unbalance) ||
                         store(problem, method, f, &outcome, unbalance, forces)
                     ? -1
                     : 0;
    if (!status && !outcome.converged && isfinite(method->doubt) && !(outcome.imbalance <= method->doubt))
        status = prove(network, problem->options, forces);
    if (!status && method->sample && problem->options->samples > 1)
        status = sample(problem, method, &forces->contact);
    free(f), free(unbalance);
    return status;
}

int infer_forces(const struct packing *packing, const struct force_options *options, enum force_method method,
                 struct forces *forces)
{
    struct network network;
    const struct method *row = method_row(method);
    memset(forces, 0, sizeof *forces);
    if (!row || check_needs(packing, options, row) || method_network(packing, options, row, &network))
        return -1;
    int status = infer(&(struct problem){packing, &network, options}, row, forces);
    if (!status)
        status = result_sum_up(packing, &options->law, options->tolerance, forces);
    network_free(&network);
    if (status)
        forces_free(forces);
    return status;
}

size_t forces_unbalanced_grains(const struct packing *packing, const struct forces *forces, double share)
{
    double mean = forces_mean(forces->contact.fn, forces->contact.count, 1, NULL),
           radius = network_radius(&packing->grains);
    double limit = isnan(mean) ? 0 : share * mean;
    size_t found = 0;
    const uint32_t *flags = packing->grains.flags;
    for (size_t k = 0; k < forces->residual.count; k++) {
        double unbalance = result_unbalance(&forces->residual, k, radius);
        if (isnan(unbalance)) /* nobody knows that it is balanced; of a grain that was not measured its flag says so */
            found += !flags || !(flags[k] & GRAIN_DISTRUST);
        else
            found += unbalance > limit;
    }
    return found;
}
