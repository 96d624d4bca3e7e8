/* The columns of the file are in SI units and in the rows of the packing; NaN says that nobody knows. */
#include "forces/network/network_result.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "forces/network/network_loads.h"
#include "pipeline/packing/stress.h"
#include "pipeline/packing/verdict.h"
#include "pipeline/speak/error.h"

#define NORMAL_90 1.645 /* standard deviations on each side that hold 90 % */

/* Open comes first: in the corner of its cone a contact is on both edges. */
static uint32_t status_of(double mu, double fn, double ft, double margin)
{
    if (isnan(fn) || isnan(ft))
        return STATUS_NOT_USED;
    if (fn <= margin)
        return STATUS_OPEN;
    return mu > 0 && fabs(ft) >= mu * fn * (1 - margin) ? STATUS_SLIP : STATUS_STICK;
}

static void store_contacts(const struct network *network, double margin, const double *f, struct contact_forces *out)
{
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

static void store_residuals(const struct packing *packing, const struct network *network, const double *unbalance,
                            struct residuals *out)
{
    const struct grains *g = &packing->grains;
    const double *const loads[3] = {g->load_x, g->load_y, g->load_m};
    const double arms[3] = {1, 1, network->radius};
    double *const residuals[3] = {out->residual_x, out->residual_y, out->residual_m};
    for (size_t k = 0; k < out->count; k++) {
        long dof = network->grain_dof[k];
        int rests = dof < 0 && !network->peeled[k];
        for (int d = 0; d < 3; d++)
            residuals[d][k] = dof >= 0 ? unbalance[dof + d] * network->force * arms[d]
                              : rests  ? 0
                                       : column_or_zero(loads[d], k);
    }
}

int result_store(const struct packing *packing, const struct network *network, double margin, const double *f,
                 const double *unbalance, struct forces *forces)
{
    static const char *const names[] = {"fn", "ft", "status", NULL};
    double area;
    if (packing_area(packing, &area) ||
        table_alloc(&CONTACT_FORCES, &forces->contact, packing->contacts.count, names) ||
        table_alloc(&RESIDUALS, &forces->residual, packing->grains.count, NULL))
        return -1;
    store_contacts(network, margin, f, &forces->contact);
    store_residuals(packing, network, unbalance, &forces->residual);
    memcpy(forces->misfit, network->misfit, sizeof forces->misfit);
    stress_weber(packing, forces->contact.fn, forces->contact.ft, area, forces->stress);
    return 0;
}

/* ---- how far they are determined ---- */

int spread_alloc(size_t contacts, struct spread *spread)
{
    *spread = (struct spread){calloc(contacts + 1, sizeof(double)), calloc(contacts + 1, sizeof(double)),
                              calloc(contacts + 1, sizeof(double)), calloc(contacts + 1, sizeof(double))};
    return spread->s_fn && spread->s_ft && spread->fn_min && spread->fn_max ? 0 : error_memory("samples");
}

void spread_free(struct spread *spread)
{
    free(spread->s_fn), free(spread->s_ft), free(spread->fn_min), free(spread->fn_max);
    memset(spread, 0, sizeof *spread);
}

void spread_set(struct spread *spread, size_t c, double fn, double s_fn, double s_ft)
{
    spread->s_fn[c] = s_fn;
    spread->s_ft[c] = s_ft;
    spread->fn_min[c] = fmax(0, fn - NORMAL_90 * s_fn);
    spread->fn_max[c] = fn + NORMAL_90 * s_fn;
}

int result_add_spread(struct contact_forces *out)
{
    static const char *const names[] = {"s_fn", "s_ft", "fn_min", "fn_max"};
    for (size_t k = 0; k < 4; k++)
        if (table_add(&CONTACT_FORCES, out, names[k]))
            return -1;
    return 0;
}

int result_store_spread(const struct network *network, const struct spread *spread, struct contact_forces *out)
{
    if (result_add_spread(out))
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

double result_unbalance(const struct residuals *residual, size_t k, double radius)
{
    double force = hypot(residual->residual_x[k], residual->residual_y[k]);
    double moment = fabs(residual->residual_m[k]) / radius;
    return isnan(force) || isnan(moment) ? NAN : fmax(force, moment); /* hypot(inf, NaN) is inf */
}

/* In the mean over the grains whose balance is known; how far the forces are outside their cones. */
int result_sum_up(const struct packing *packing, const struct contact_law *law, double tolerance, struct forces *forces)
{
    double mean = forces_mean(forces->contact.fn, forces->contact.count, 1, NULL),
           radius = network_radius(&packing->grains), sum = 0, out = 0;
    size_t known = 0;
    for (size_t k = 0; k < forces->residual.count; k++) {
        double unbalance = result_unbalance(&forces->residual, k, radius);
        known += !isnan(unbalance);
        sum += isnan(unbalance) ? 0 : unbalance;
    }
    for (size_t c = 0; c < forces->contact.count; c++) {
        size_t wall;
        double mu = packing_is_wall(packing, c, &wall) ? law->mu_wall : law->mu, fn = forces->contact.fn[c];
        out = fmax(out, fmax(-fn, fabs(forces->contact.ft[c]) - mu * fn));
    }
    mean = isnan(mean) ? 1 : mean;
    forces->imbalance_mean = known ? sum / (double)known / mean : 0;
    forces->violation = out / mean;
    forces->tolerance = tolerance;
    forces->converged = forces->imbalance <= tolerance;
    return verdict_find(packing, forces);
}
