#include "forces/evidence.h"

#include <stdlib.h>
#include <string.h>

#include "pipeline/error.h"

/* Overlaps are never better known than this share of <fn>: the contact law itself is not. */
#define LEAST_SLACK 0.01
/* A wide belief where overlaps speak: it only keeps forces that nothing else determines from growing. */
#define PRIOR_MEAN 1
#define PRIOR_NN 9

void evidence_free(struct evidence *evidence)
{
    free(evidence->prior), free(evidence->variance), free(evidence->measured), free(evidence->slack);
    free(evidence->place), free(evidence->share), free(evidence->open);
    memset(evidence, 0, sizeof *evidence);
}

static int evidence_alloc(size_t count, struct evidence *evidence)
{
    memset(evidence, 0, sizeof *evidence);
    evidence->count = count;
    evidence->prior = calloc(2 * count + 1, sizeof(double));
    evidence->variance = calloc(2 * count + 1, sizeof(double));
    evidence->measured = calloc(count + 1, sizeof(double));
    evidence->slack = calloc(count + 1, sizeof(double));
    evidence->place = calloc(count + 1, sizeof *evidence->place);
    evidence->share = calloc(count + 1, sizeof *evidence->share);
    evidence->open = calloc(count + 1, 1);
    if (evidence->prior && evidence->variance && evidence->measured && evidence->slack && evidence->place &&
        evidence->share && evidence->open)
        return 0;
    evidence_free(evidence);
    return error_memory("overlap errors");
}

int evidence_copy(const struct evidence *from, struct evidence *to)
{
    size_t n = from->count;
    if (evidence_alloc(n, to))
        return -1;
    to->errors = from->errors;
    memcpy(to->prior, from->prior, 2 * n * sizeof(double));
    memcpy(to->variance, from->variance, 2 * n * sizeof(double));
    memcpy(to->measured, from->measured, n * sizeof(double));
    memcpy(to->slack, from->slack, n * sizeof(double));
    memcpy(to->place, from->place, n * sizeof *to->place);
    memcpy(to->share, from->share, n * sizeof *to->share);
    memcpy(to->open, from->open, n);
    return 0;
}

static double error_of(const double *column, size_t row)
{
    double s = column_or_zero(column, row);
    return isfinite(s) && s > 0 ? s : 0;
}

/* First error unknown of each grain (x, y, radius), then of each wall (offset); only where there are errors. */
static int number_errors(const struct packing *packing, struct evidence *evidence, long *grain, long *wall)
{
    const struct grains *g = &packing->grains;
    int known = g->s_x || g->s_x_ref || g->s_radius || packing->walls.s_offset;
    long next = 0;
    for (size_t k = 0; k < g->count; k++, next += known ? 3 : 0)
        grain[k] = known ? next : -1;
    for (size_t w = 0; w < packing->walls.count; w++)
        wall[w] = error_of(packing->walls.s_offset, w) > 0 ? next++ : -1;
    evidence->errors = (size_t)next;
    return 0;
}

static void add_share(struct evidence *evidence, size_t c, int *at, long place, double share)
{
    evidence->place[c][*at] = (int)place;
    evidence->share[c][*at] = share;
    ++*at;
}

/* The overlap grows by n . e for grain i, by -n . e for j, and by the errors of both radii (sign 1: i, -1: j). */
static void add_grain(const struct packing *packing, size_t row, size_t k, double sign, double stiffness, long place,
                      struct evidence *evidence, size_t c, int *at)
{
    const struct grains *g = &packing->grains;
    double sx = hypot(error_of(g->s_x, k), error_of(g->s_x_ref, k));
    double sy = hypot(error_of(g->s_y, k), error_of(g->s_y_ref, k));
    if (place < 0)
        return;
    add_share(evidence, c, at, place, sign * stiffness * packing->contacts.nx[row] * sx);
    add_share(evidence, c, at, place + 1, sign * stiffness * packing->contacts.ny[row] * sy);
    add_share(evidence, c, at, place + 2, stiffness * error_of(g->s_radius, k));
}

static void fill_shares(const struct packing *packing, const struct network *network, double stiffness,
                        const long *grain, const long *wall, struct evidence *evidence)
{
    for (size_t c = 0; c < network->count; c++) {
        size_t row = network->contact[c].row, i = (size_t)packing->contacts.i[row], w;
        double variance = 0;
        int at = 0;
        for (int k = 0; k < EVIDENCE_WIDTH; k++)
            evidence->place[c][k] = -1;
        add_grain(packing, row, i, 1, stiffness, grain[i], evidence, c, &at);
        if (!packing_is_wall(packing, row, &w)) {
            size_t j = (size_t)packing->contacts.j[row];
            add_grain(packing, row, j, -1, stiffness, grain[j], evidence, c, &at);
        } else if (wall[w] >= 0) {
            add_share(evidence, c, &at, wall[w], stiffness * error_of(packing->walls.s_offset, w));
        }
        for (int k = 0; k < at; k++)
            variance += evidence->share[c][k] * evidence->share[c][k];
        double whole = stiffness * error_of(packing->contacts.s_overlap, row);
        evidence->slack[c] = fmax(LEAST_SLACK * LEAST_SLACK, whole * whole - variance);
    }
}

/* kn overlap, negative where there is a gap. */
static int fill_measured(const struct packing *packing, const struct network *network, double stiffness,
                         struct evidence *evidence)
{
    for (size_t c = 0; c < network->count; c++) {
        double overlap = packing->contacts.overlap[network->contact[c].row];
        if (!isfinite(overlap))
            return error_input("contact %zu has an overlap that is not finite: run contacts again, or flag the row",
                               network->contact[c].row);
        evidence->measured[c] = stiffness * overlap;
    }
    return 0;
}

/* kn / <fn> such that the virial of the overlaps is that of the loads, when asked. */
static double stiffness_in_units(const struct packing *packing, const struct network *network,
                                 const struct force_options *options)
{
    double stiffness = options->law.kn / network->force, virial = 0;
    if (!options->rescale || !isfinite(network->virial))
        return stiffness;
    for (size_t c = 0; c < network->count; c++) {
        size_t row = network->contact[c].row;
        int candidate = packing->contacts.flags && (packing->contacts.flags[row] & CONTACT_CANDIDATE);
        if (candidate || !isfinite(packing->contacts.overlap[row]))
            continue;
        virial += stiffness * packing->contacts.overlap[row] * network->contact[c].length;
    }
    return virial > 0 ? stiffness * network->virial / virial : stiffness;
}

static int fill_overlaps(const struct packing *packing, const struct network *network,
                         const struct force_options *options, struct evidence *evidence)
{
    double stiffness = stiffness_in_units(packing, network, options);
    long *grain = malloc((packing->grains.count + 1) * sizeof *grain);
    long *wall = malloc((packing->walls.count + 1) * sizeof *wall);
    int status = -1;
    if (!grain || !wall) {
        status = error_memory("overlap errors");
    } else if (!fill_measured(packing, network, stiffness, evidence)) {
        status = number_errors(packing, evidence, grain, wall);
        fill_shares(packing, network, stiffness, grain, wall, evidence);
    }
    free(grain), free(wall);
    return status;
}

int evidence_build(const struct packing *packing, const struct network *network, const struct force_options *options,
                   const double *f, struct evidence *evidence)
{
    enum force_start start = options->start;
    int overlaps = packing->contacts.overlap && (start == START_OVERLAP || start == START_DEFAULT);
    if (evidence_alloc(network->count, evidence))
        return -1;
    for (size_t c = 0; c < network->count; c++) {
        double mu = network->contact[c].mu;
        evidence->prior[2 * c] = overlaps || start == START_ZERO ? PRIOR_MEAN : f[2 * c];
        evidence->prior[2 * c + 1] = overlaps ? 0 : f[2 * c + 1];
        evidence->variance[2 * c] = overlaps ? PRIOR_NN : 1;
        /* exponentially spread fn: <fn^2> = 2 <fn>^2; ft on the edge of its cone, else evenly spread over it */
        evidence->variance[2 * c + 1] = fmax(1e-8, (overlaps ? 2 : 2.0 / 3) * fmin(1, mu * mu));
        evidence->measured[c] = NAN;
        for (int k = 0; k < EVIDENCE_WIDTH; k++)
            evidence->place[c][k] = -1;
    }
    if (!overlaps || !fill_overlaps(packing, network, options, evidence))
        return 0;
    evidence_free(evidence);
    return -1;
}
