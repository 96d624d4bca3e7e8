#include "forces/infer_forces.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "forces/questions/certificate.h"
#include "forces/network/elastic.h"
#include "forces/questions/force_samples.h"
#include "pipeline/speak/error.h"
#include "pipeline/packing/stress.h"

#define DOUBTFUL 0.01 /* <fn>: more left than that may be the network's fault and not the method's */

const char *const FORCE_METHODS[] = {"cem", "cdm", "qsm", "map", NULL};
const char *const FORCE_STARTS[] = {"default", "zero", "mean", "overlap", "cem", "previous", "file", NULL};
const char *const FORCE_FIXES[] = {"none", "normal", "tangential", NULL};

static int stiffness_given(const struct force_options *options)
{
    return elastic_known(&options->law);
}

static int check_options(const struct force_options *options, enum force_method method)
{
    if (method != METHOD_CDM && !stiffness_given(options))
        return error_input("no contact stiffness: method %s needs the scene's contact.kn_N_per_m or young_Pa",
                           FORCE_METHODS[method]);
    if (!(options->law.kt_over_kn >= 0) || !isfinite(options->law.kt_over_kn))
        return error_input("contact.kt_over_kn must be a number of 0 or more");
    return 0;
}

static int solve_map(const struct packing *packing, const struct network *network, const struct force_options *options,
                     double *f, struct outcome *outcome, struct spread *spread)
{
    struct evidence evidence;
    if (evidence_build(packing, network, options, f, &evidence))
        return -1;
    int status = map_solve(network, options, &evidence, f, outcome);
    if (!status && options->samples > 1)
        status = sample_forces(network, options, &evidence, spread);
    evidence_free(&evidence);
    return status;
}

static int solve(const struct packing *packing, const struct network *network, const struct force_options *options,
                 enum force_method method, double *f, struct outcome *outcome, struct spread *spread)
{
    if (method == METHOD_CEM)
        return cem_forces(packing, network, options, f);
    if (start_forces(packing, network, options, method, f))
        return -1;
    if (method == METHOD_CDM)
        return cdm_solve(network, options, f, outcome);
    if (method == METHOD_QSM)
        return qsm_solve(network, options, f, outcome);
    return solve_map(packing, network, options, f, outcome, spread);
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

/* cem has no say in equilibrium: it is judged like the others. Where a force is not known (only cem leaves NaN), the
 * balance is not either, and does not count as reached. */
static int judge(const struct packing *packing, const struct network *network, const struct force_options *options,
                 enum force_method method, const double *f, struct outcome *outcome, double *unbalance)
{
    double held = network_judge(network, f, unbalance);
    double free = falling(packing, network) / network_mean_force(network, f);
    outcome->imbalance = isnan(held) || isnan(free) ? NAN : fmax(held, free);
    outcome->converged = outcome->imbalance <= options->tolerance;
    for (size_t k = 0; k < 2 * network->count; k++)
        if (!isfinite(f[k]) && !(method == METHOD_CEM && isnan(f[k])))
            return error_input("the forces are not finite: look for absurd numbers in the file");
    return 0;
}

#define STATUS_MARGIN 1e-9 /* far above rounding, which depends on the compiler */

/* `margin`: how near to the corner (in <fn>) and to the edges (as a share) of its cone a contact counts as open or
 * slipping: map's forces are means over what is possible, which lie inside. */
static uint32_t status_of(double mu, double fn, double ft, double margin)
{
    if (isnan(fn) || isnan(ft))
        return STATUS_NOT_USED;
    if (fn <= margin)
        return STATUS_OPEN;
    return mu > 0 && fabs(ft) >= mu * fn * (1 - margin) ? STATUS_SLIP : STATUS_STICK;
}

static void store_contacts(const struct network *network, enum force_method method, const double *f,
                           struct contact_forces *out)
{
    double margin = method == METHOD_MAP ? LEAST_FORCE_ERROR : STATUS_MARGIN;
    for (size_t c = 0; c < out->count; c++) {
        out->fn[c] = out->ft[c] = 0;
        out->status[c] = STATUS_NOT_USED;
    }
    for (size_t c = 0; c < network->count; c++) {
        size_t row = network->contact[c].row;
        out->fn[row] = f[2 * c] * network->force;
        out->ft[row] = f[2 * c + 1] * network->force;
        out->status[row] = status_of(network->contact[c].mu, f[2 * c], f[2 * c + 1], margin);
    }
}

/* Contacts that are not used keep NaN: nothing was sampled there. */
static int store_spread(const struct network *network, const struct spread *spread, struct contact_forces *out)
{
    static const char *const names[] = {"s_fn", "s_ft", "fn_min", "fn_max"};
    for (size_t k = 0; k < 4; k++)
        if (table_add(&CONTACT_FORCES, out, names[k]))
            return -1;
    for (size_t c = 0; c < network->count; c++) {
        size_t row = network->contact[c].row;
        out->s_fn[row] = spread->s_fn[c] * network->force;
        out->s_ft[row] = spread->s_ft[c] * network->force;
        out->fn_min[row] = spread->fn_min[c] * network->force;
        out->fn_max[row] = spread->fn_max[c] * network->force;
    }
    return 0;
}

/* A grain that is held or carries nothing: its residual is its load, or 0 when it is fixed. */
static void store_residuals(const struct packing *packing, const struct network *network, const double *unbalance,
                            struct residuals *out)
{
    const struct grains *g = &packing->grains;
    for (size_t k = 0; k < out->count; k++) {
        long dof = network->grain_dof[k];
        int rests = dof < 0 && !network->peeled[k];
        out->residual_x[k] = dof >= 0 ? unbalance[dof] * network->force : rests || !g->load_x ? 0 : g->load_x[k];
        out->residual_y[k] = dof >= 0 ? unbalance[dof + 1] * network->force : rests || !g->load_y ? 0 : g->load_y[k];
        out->residual_m[k] = dof >= 0              ? unbalance[dof + 2] * network->force * network->radius
                             : rests || !g->load_m ? 0
                                                   : g->load_m[k];
    }
}

static int store(const struct packing *packing, const struct network *network, const struct force_options *options,
                 enum force_method method, const double *f, const struct outcome *outcome, const double *unbalance,
                 struct forces *forces)
{
    static const char *const contact_names[] = {"fn", "ft", "status", NULL};
    enum force_start start = options->start;
    if (start == START_DEFAULT)
        start = stiffness_given(options) && packing->contacts.overlap ? START_OVERLAP : START_ZERO;
    if (method == METHOD_CEM)
        start = options->previous ? START_PREVIOUS : START_OVERLAP;
    snprintf(forces->method, sizeof forces->method, "%s", FORCE_METHODS[method]);
    snprintf(forces->start, sizeof forces->start, "%s", FORCE_STARTS[start]);
    if (table_alloc(&CONTACT_FORCES, &forces->contact, packing->contacts.count, contact_names) ||
        table_alloc(&RESIDUALS, &forces->residual, packing->grains.count, NULL))
        return -1;
    store_contacts(network, method, f, &forces->contact);
    store_residuals(packing, network, unbalance, &forces->residual);
    forces->iterations = outcome->iterations;
    forces->converged = outcome->converged;
    forces->imbalance = outcome->imbalance;
    forces->kn = options->law.kn;
    forces->kt = options->law.kn * options->law.kt_over_kn;
    forces->mu = options->law.mu;
    memcpy(forces->misfit, network->misfit, sizeof forces->misfit);
    double area;
    if (packing_area(packing, &area))
        return -1;
    stress_weber(packing, forces->contact.fn, forces->contact.ft, area, forces->stress);
    return 0;
}

/* Iterations that stopped near equilibrium need no proof; map, which does not stop there, is asked whenever it failed.
 */
static int is_doubtful(enum force_method method, const struct outcome *outcome)
{
    return method != METHOD_CEM && !outcome->converged && (method == METHOD_MAP || outcome->imbalance > DOUBTFUL);
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

static int infer(const struct packing *packing, const struct network *network, const struct force_options *options,
                 enum force_method method, struct forces *forces)
{
    double *f = calloc(2 * network->count + 1, sizeof *f), *unbalance = calloc(network->dofs + 1, sizeof *unbalance);
    struct outcome outcome = {0};
    struct spread spread = {0};
    int status = -1;
    if (!f || !unbalance)
        status = error_memory("forces");
    else if (!solve(packing, network, options, method, f, &outcome, &spread) &&
             !judge(packing, network, options, method, f, &outcome, unbalance))
        status = store(packing, network, options, method, f, &outcome, unbalance, forces);
    if (!status && is_doubtful(method, &outcome))
        status = prove(network, options, forces);
    if (!status && spread.s_fn)
        status = store_spread(network, &spread, &forces->contact);
    spread_free(&spread);
    free(f), free(unbalance);
    return status;
}

static double unbalance_of(const struct residuals *residual, size_t k, double radius)
{
    double force = hypot(residual->residual_x[k], residual->residual_y[k]);
    double moment = fabs(residual->residual_m[k]) / radius;
    return isnan(force) || isnan(moment) ? NAN : fmax(force, moment); /* hypot(inf, NaN) is inf */
}

static double mean_pushing(const struct contact_forces *contact)
{
    double sum = 0, pushing = 0;
    for (size_t c = 0; c < contact->count; c++)
        if (contact->fn[c] > 0)
            sum += contact->fn[c], pushing++;
    return pushing > 0 ? sum / pushing : 0;
}

static double mean_radius_of(const struct grains *grains)
{
    double sum = 0, count = 0;
    for (size_t k = 0; k < grains->count; k++)
        if (isfinite(grains->radius[k]))
            sum += grains->radius[k], count++;
    return sum > 0 ? sum / count : 1;
}

/* In the mean over the grains whose balance is known; how far the forces are outside their cones. */
static void sum_up(const struct packing *packing, const struct contact_law *law, struct forces *forces)
{
    double mean = mean_pushing(&forces->contact), radius = mean_radius_of(&packing->grains), sum = 0, out = 0;
    size_t known = 0;
    for (size_t k = 0; k < forces->residual.count; k++) {
        double unbalance = unbalance_of(&forces->residual, k, radius);
        known += !isnan(unbalance);
        sum += isnan(unbalance) ? 0 : unbalance;
    }
    for (size_t c = 0; c < forces->contact.count; c++) {
        size_t wall;
        double mu = packing_is_wall(packing, c, &wall) ? law->mu_wall : law->mu, fn = forces->contact.fn[c];
        out = fmax(out, fmax(-fn, fabs(forces->contact.ft[c]) - mu * fn));
    }
    mean = mean > 0 ? mean : 1;
    forces->imbalance_mean = known ? sum / (double)known / mean : 0;
    forces->violation = out / mean;
}

/* A contact that was lost costs qsm much, one too many next to nothing (it starts without force); but without being
 * asked it keeps to the decided contacts, as the thesis does. */
struct network_options method_network(const struct force_options *options, enum force_method method)
{
    int candidates = method == METHOD_MAP || (method == METHOD_QSM && options->candidates);
    return (struct network_options){.candidates = candidates, .wall_mass = options->wall_mass};
}

int infer_forces(const struct packing *packing, const struct force_options *options, enum force_method method,
                 struct forces *forces)
{
    struct network network;
    struct network_options network_options = method_network(options, method);
    memset(forces, 0, sizeof *forces);
    if (check_options(options, method) || network_build(packing, &options->law, &network_options, &network))
        return -1;
    int status = infer(packing, &network, options, method, forces);
    if (!status)
        sum_up(packing, &options->law, forces);
    network_free(&network);
    if (status)
        forces_free(forces);
    return status;
}

size_t forces_unbalanced_grains(const struct packing *packing, const struct forces *forces, double share)
{
    double limit = share * mean_pushing(&forces->contact), radius = mean_radius_of(&packing->grains);
    size_t found = 0;
    const uint32_t *flags = packing->grains.flags;
    for (size_t k = 0; k < forces->residual.count; k++) {
        double unbalance = unbalance_of(&forces->residual, k, radius);
        if (isnan(unbalance)) /* nobody knows that it is balanced; of a grain that was not measured its flag says so */
            found += !flags || !(flags[k] & GRAIN_DISTRUST);
        else
            found += unbalance > limit;
    }
    return found;
}
