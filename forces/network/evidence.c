/* How the file's columns become the model of evidence.h. Every standard error of a place, a radius or a wall is one
 * unknown e of variance 1 that is shared by all contacts of that body:
 *
 *     B_ce = tangent stiffness x d overlap / d e x standard error,
 *
 * so that a grain that was measured too far left shows larger overlaps there and smaller ones on its right, by one
 * number.
 */
#include "forces/network/evidence.h"

#include <stdlib.h>
#include <string.h>

#include "forces/algebra/arena.h"
#include "forces/network/elastic.h"
#include "pipeline/speak/error.h"

/* A wide belief where overlaps speak: it only keeps forces that nothing else determines from growing. */
#define PRIOR_MEAN 1
#define PRIOR_NN 9
/* Error of a component that is held, in <fn>; smaller ones make the systems of the interior point too stiff. */
#define HELD 1e-4

void evidence_free(struct evidence *evidence)
{
    free(evidence->store), free(evidence->place);
    memset(evidence, 0, sizeof *evidence);
}

static size_t lay_out(struct evidence *evidence, double *block)
{
    struct arena arena = {.block = block};
    size_t n = evidence->count;
    evidence->prior = arena_take(&arena, 2 * n), evidence->variance = arena_take(&arena, 2 * n);
    evidence->measured = arena_take(&arena, n), evidence->slack = arena_take(&arena, n);
    evidence->probability = arena_take(&arena, n);
    evidence->share = arena_rows(&arena, n, EVIDENCE_WIDTH);
    evidence->soft = arena_take(&arena, evidence->dofs);
    return arena.used;
}

static int evidence_alloc(size_t count, size_t dofs, struct evidence *evidence)
{
    *evidence = (struct evidence){.count = count, .dofs = dofs};
    evidence->store = calloc(lay_out(evidence, NULL) + 1, sizeof(double));
    evidence->place = calloc(count + 1, sizeof *evidence->place);
    if (!evidence->store || !evidence->place) {
        evidence_free(evidence);
        return error_memory("overlap errors");
    }
    lay_out(evidence, evidence->store);
    return 0;
}

/* Certain contacts of variance 1 that say nothing: what every evidence begins with. */
int evidence_blank(const struct network *network, struct evidence *evidence)
{
    if (evidence_alloc(network->count, network->dofs, evidence))
        return -1;
    for (size_t c = 0; c < network->count; c++) {
        evidence->measured[c] = NAN;
        evidence->probability[c] = evidence->variance[2 * c] = evidence->variance[2 * c + 1] = 1;
        for (int k = 0; k < EVIDENCE_WIDTH; k++)
            evidence->place[c][k] = -1;
    }
    return 0;
}

/* Both were laid out for the same sizes: one block each. */
int evidence_copy(const struct evidence *from, struct evidence *to)
{
    size_t n = from->count;
    if (evidence_alloc(n, from->dofs, to))
        return -1;
    to->errors = from->errors;
    to->friction = from->friction;
    to->barrier = from->barrier;
    memcpy(to->store, from->store, lay_out(&(struct evidence){.count = n, .dofs = from->dofs}, NULL) * sizeof(double));
    memcpy(to->place, from->place, n * sizeof *to->place);
    return 0;
}

/* The standard errors of a packing. A column that is missing, or has no number at all, is exact; a number that is
 * missing among others counts as the largest of them. */
enum { S_X, S_X_REF, S_Y, S_Y_REF, S_RADIUS, S_OFFSET, S_OVERLAP, ERROR_COLUMNS };
struct known_errors {
    const double *column[ERROR_COLUMNS];
    double unknown[ERROR_COLUMNS];
};

/* Columns, and the largest error of each, which stands in for those that are missing. */
static void errors_begin(const struct packing *packing, struct known_errors *known)
{
    const struct grains *g = &packing->grains;
    const size_t grains = g->count, walls = packing->walls.count, contacts = packing->contacts.count;
    const size_t rows[ERROR_COLUMNS] = {grains, grains, grains, grains, grains, walls, contacts};
    *known = (struct known_errors){
        {g->s_x, g->s_x_ref, g->s_y, g->s_y_ref, g->s_radius, packing->walls.s_offset, packing->contacts.s_overlap},
        {0}};
    for (int k = 0; k < ERROR_COLUMNS; k++)
        for (size_t r = 0; known->column[k] && r < rows[k]; r++)
            if (isfinite(known->column[k][r]))
                known->unknown[k] = fmax(known->unknown[k], known->column[k][r]);
}

static double error_of(const struct known_errors *known, int which, size_t row)
{
    if (!known->column[which])
        return 0;
    double s = known->column[which][row];
    return isfinite(s) ? fmax(0, s) : known->unknown[which];
}

/* Error unknowns of one grain or wall: numbers, -1 where that quantity has no error. */
struct unknowns {
    int x, y, radius;
};

/* The standard error of a grain's place along an axis (S_X or S_Y): of its reference and of its motion. */
static double error_along(const struct known_errors *known, int axis, size_t k)
{
    return hypot(error_of(known, axis, k), error_of(known, axis + 1, k));
}

/* Numbers for each grain (place, radius), then for each wall (its offset, as radius); only where there are errors, as
 * each costs a row of the system. */
static void number_errors(const struct packing *packing, const struct known_errors *known, struct evidence *evidence,
                          struct unknowns *body)
{
    const struct grains *g = &packing->grains;
    int next = 0;
    for (size_t k = 0; k < g->count; k++) {
        body[k].x = error_along(known, S_X, k) > 0 ? next++ : -1;
        body[k].y = error_along(known, S_Y, k) > 0 ? next++ : -1;
        body[k].radius = error_of(known, S_RADIUS, k) > 0 ? next++ : -1;
    }
    for (size_t w = 0; w < packing->walls.count; w++)
        body[g->count + w] = (struct unknowns){-1, -1, error_of(known, S_OFFSET, w) > 0 ? next++ : -1};
    evidence->errors = (size_t)next;
}

/* The next of a contact's unknowns; -1: that quantity has no error. */
static void add_share(struct evidence *evidence, size_t c, int *at, int place, double share)
{
    if (place < 0)
        return;
    evidence->place[c][*at] = place;
    evidence->share[c][*at] = share;
    ++*at;
}

/* The overlap grows by n . e for grain i, by -n . e for j, and by the errors of both radii (sign 1: i, -1: j). */
static void add_grain(const struct packing *packing, const struct known_errors *known, size_t row, size_t k,
                      double sign, double stiffness, const struct unknowns *body, struct evidence *evidence, size_t c,
                      int *at)
{
    const struct contacts *contacts = &packing->contacts;
    add_share(evidence, c, at, body[k].x, sign * stiffness * contacts->nx[row] * error_along(known, S_X, k));
    add_share(evidence, c, at, body[k].y, sign * stiffness * contacts->ny[row] * error_along(known, S_Y, k));
    add_share(evidence, c, at, body[k].radius, stiffness * error_of(known, S_RADIUS, k));
}

/* B of one contact whose law has that stiffness (in units, per m). */
static void fill_share(const struct packing *packing, const struct known_errors *known, const struct network *network,
                       size_t c, double stiffness, const struct unknowns *body, struct evidence *evidence)
{
    size_t row = network->contact[c].row, w;
    double variance = 0;
    int at = 0;
    add_grain(packing, known, row, (size_t)packing->contacts.i[row], 1, stiffness, body, evidence, c, &at);
    if (packing_is_wall(packing, row, &w))
        add_share(evidence, c, &at, body[packing->grains.count + w].radius, stiffness * error_of(known, S_OFFSET, w));
    else
        add_grain(packing, known, row, (size_t)packing->contacts.j[row], -1, stiffness, body, evidence, c, &at);
    for (int k = 0; k < at; k++)
        variance += evidence->share[c][k] * evidence->share[c][k];
    double whole = stiffness * error_of(known, S_OVERLAP, row);
    evidence->slack[c] = fmax(LEAST_FORCE_ERROR * LEAST_FORCE_ERROR, whole * whole - variance);
}

/* The force of each overlap, negative where there is a gap, along the law's tangent there; a law whose stiffness grows
 * from zero is taken along its tangent at the overlap's standard error where the overlap is smaller than that. */
static struct elastic_tangent tangent_at(const struct packing *packing, const struct known_errors *known,
                                         const struct contact_law *law, size_t row)
{
    double overlap = packing->contacts.overlap[row];
    struct contact_pair pair = elastic_pair(packing, law, row);
    double at = contact_law_row(law)->linear ? overlap : fmax(overlap, error_of(known, S_OVERLAP, row));
    struct elastic_tangent tangent = elastic_tangent(law, &pair, at);
    tangent.force += tangent.stiffness * (overlap - fmax(0, at));
    return tangent;
}

/* What the forces of overlaps must be multiplied by so that their virial is that of the loads, when asked. */
static double scale_to_loads(const struct packing *packing, const struct known_errors *known,
                             const struct network *network, const struct force_options *options)
{
    double virial = 0;
    if (!options->rescale || !isfinite(network->virial))
        return 1;
    for (size_t c = 0; c < network->count; c++) {
        size_t row = network->contact[c].row;
        int candidate = packing->contacts.flags && (packing->contacts.flags[row] & CONTACT_CANDIDATE);
        if (!candidate && isfinite(packing->contacts.overlap[row]))
            virial +=
                tangent_at(packing, known, &options->law, row).force / network->force * network->contact[c].length;
    }
    return virial > 0 ? network->virial / virial : 1;
}

/* m, B and slack of every contact, from its overlap; refuses one that is not finite. */
static int fill_overlaps(const struct packing *packing, const struct known_errors *known, const struct network *network,
                         const struct force_options *options, struct evidence *evidence)
{
    struct unknowns *body = malloc((packing->grains.count + packing->walls.count + 1) * sizeof *body);
    if (!body)
        return error_memory("overlap errors");
    double scale = scale_to_loads(packing, known, network, options) / network->force;
    int status = 0;
    number_errors(packing, known, evidence, body);
    for (size_t c = 0; c < network->count && !status; c++) {
        size_t row = network->contact[c].row;
        struct elastic_tangent tangent = tangent_at(packing, known, &options->law, row);
        if (!isfinite(tangent.force))
            status =
                error_input("contact %zu has an overlap that is not finite: run contacts again, or flag the row", row);
        evidence->measured[c] = scale * tangent.force;
        fill_share(packing, known, network, c, scale * tangent.stiffness, body, evidence);
    }
    free(body);
    return status;
}

/* The probability that a contact is closed: as in the file; without that column from the overlap and its error for
 * candidates, and 1 for contacts. */
static double closed(const struct packing *packing, const struct known_errors *known, size_t row)
{
    const struct contacts *c = &packing->contacts;
    if (c->probability && c->probability[row] >= 0 && c->probability[row] <= 1)
        return c->probability[row];
    if (!c->flags || !(c->flags[row] & CONTACT_CANDIDATE) || !c->overlap || !(error_of(known, S_OVERLAP, row) > 0))
        return 1;
    return 0.5 * erfc(-c->overlap[row] / (error_of(known, S_OVERLAP, row) * sqrt(2)));
}

/* A contact of the file that cannot be used (its numbers are missing) may carry a force all the same: its grains get an
 * unknown load. An exponentially spread force of mean <fn> has <fn^2> = 2 <fn>^2, half of it along each axis; its
 * moment is at most mu times that. */
static void doubt_neighbours(const struct packing *packing, const struct network *network, struct evidence *evidence)
{
    const struct contacts *contacts = &packing->contacts;
    for (size_t c = 0; c < contacts->count && contacts->flags; c++) {
        size_t ends[2] = {(size_t)contacts->i[c], (size_t)contacts->j[c]};
        if (!(contacts->flags[c] & CONTACT_NOT_FINITE) || contacts->i[c] < 0 || contacts->j[c] < 0)
            continue;
        for (int e = 0; e < 2; e++)
            for (int d = 0; d < 3 && ends[e] < network->grains && network->grain_dof[ends[e]] >= 0; d++)
                evidence->soft[network->grain_dof[ends[e]] + d] = 1;
    }
}

/* Held components of the start: known all but exactly, and no overlap says otherwise. */
static void hold(const struct network *network, const struct force_options *options, const double *f,
                 struct evidence *evidence)
{
    int part = options->fix == FIX_TANGENTIAL;
    for (size_t c = 0; c < network->count && options->fix != FIX_NONE; c++) {
        evidence->prior[2 * c + part] = f[2 * c + part];
        evidence->variance[2 * c + part] = HELD * HELD;
        if (options->fix == FIX_NORMAL)
            evidence->measured[c] = NAN;
    }
    evidence->friction &= options->fix != FIX_TANGENTIAL;
}

int evidence_build(const struct packing *packing, const struct network *network, const struct force_options *options,
                   const double *f, struct evidence *evidence)
{
    enum force_start start = options->start;
    int overlaps = packing->contacts.overlap && (start == START_OVERLAP || start == START_DEFAULT);
    struct known_errors known;
    if (evidence_blank(network, evidence))
        return -1;
    errors_begin(packing, &known);
    evidence->friction = overlaps;
    evidence->barrier = overlaps || start == START_ZERO || start == START_DEFAULT;
    for (size_t c = 0; c < network->count; c++) {
        double mu = network->contact[c].mu;
        evidence->prior[2 * c] = overlaps || start == START_ZERO ? PRIOR_MEAN : f[2 * c];
        evidence->prior[2 * c + 1] = overlaps ? 0 : f[2 * c + 1];
        evidence->variance[2 * c] = overlaps ? PRIOR_NN : 1;
        /* exponentially spread fn: <fn^2> = 2 <fn>^2; ft on the edge of its cone, else evenly spread over it */
        evidence->variance[2 * c + 1] = fmax(1e-8, (overlaps ? 2 : 2.0 / 3) * fmin(1, mu * mu));
        evidence->probability[c] = closed(packing, &known, network->contact[c].row);
    }
    doubt_neighbours(packing, network, evidence);
    if (overlaps && fill_overlaps(packing, &known, network, options, evidence)) {
        evidence_free(evidence);
        return -1;
    }
    hold(network, options, f, evidence);
    return 0;
}
