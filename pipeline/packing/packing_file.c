#include "pipeline/packing/packing_file.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "pipeline/packing/packing_check.h"
#include "pipeline/packing/stress.h"
#include "pipeline/packing/structure.h"
#include "pipeline/packing/vtk.h"
#include "pipeline/speak/error.h"

/* ---- reading ---- */

static int check_grains(const char *path, const struct grains *grains)
{
    for (size_t k = 0; k < grains->count; k++)
        if (!(grains->flags[k] & GRAIN_DISTRUST) &&
            !(isfinite(grains->x[k]) && isfinite(grains->y[k]) && isfinite(grains->radius[k]) && grains->radius[k] > 0))
            return error_input("%s: grain %zu has no finite centre and positive radius, and no flag says so: make the "
                               "file again",
                               path, k);
    for (size_t k = 0; k < grains->count; k++) /* NaN: not known */
        if (grains->mass[k] < 0 || isinf(grains->mass[k]) || grains->inertia[k] < 0 || isinf(grains->inertia[k]))
            return error_input("%s: grain %zu has a mass of %g kg and a moment of inertia of %g kg m2: make the file "
                               "again",
                               path, k, grains->mass[k], grains->inertia[k]);
    return 0;
}

static int check_contacts(const char *path, const struct packing *packing)
{
    const struct contacts *contacts = &packing->contacts;
    int64_t grains = (int64_t)packing->grains.count, bodies = grains + (int64_t)packing->walls.count;
    for (size_t c = 0; c < contacts->count; c++) {
        int64_t i = contacts->i[c], j = contacts->j[c];
        if (i < 0 || i >= grains || j <= i || j >= bodies)
            return error_input("%s: contact %zu joins %lld and %lld, but 0 <= i < j < %lld and i < %lld must hold: "
                               "make the file again",
                               path, c, (long long)i, (long long)j, (long long)bodies, (long long)grains);
        if (contacts->flags[c] & GRAIN_DISTRUST)
            continue;
        double norm = hypot(contacts->nx[c], contacts->ny[c]);
        if (!(fabs(norm - 1) < 1e-6) || !isfinite(contacts->x[c]) || !isfinite(contacts->y[c]))
            return error_input("%s: contact %zu has no unit normal and finite point, and no flag says so: make the "
                               "file again",
                               path, c);
    }
    return 0;
}

/* NaN is not known; a wall a million km away, or of that radius, is none: who draws it would not come to an end. */
static int check_walls(const char *path, const struct walls *walls)
{
    const double *const columns[] = {walls->x0, walls->y0, walls->x1, walls->y1, walls->radius};
    for (size_t w = 0; w < walls->count; w++)
        for (size_t c = 0; c < sizeof columns / sizeof *columns; c++)
            if (fabs(columns[c][w]) >= 1e9)
                return error_input("%s: wall %zu lies at or has a radius of %g m: make the file again", path, w,
                                   columns[c][w]);
    return 0;
}

static int read_walls(const struct state *state, const char *path, struct walls *walls)
{
    static const char *const required[] = {"name", "x0", "y0", "x1", "y1", "radius", NULL};
    if (state_has(state, "walls") == 0)
        return 0;
    return state_read(state, "walls", &WALLS, required, walls) || check_walls(path, walls) ||
                   table_add(&WALLS, walls, "fx") || table_add(&WALLS, walls, "fy") || table_add(&WALLS, walls, "flags")
               ? -1
               : 0;
}

/* A file that does not say leaves it unknown. */
static int read_indeterminacy(const struct state *state, struct indeterminacy *out)
{
    out->h = out->mechanisms = NAN;
    if (state_read_numbers(state, "contacts", "h", &out->h, 1) < 0 ||
        state_read_numbers(state, "contacts", "mechanisms", &out->mechanisms, 1) < 0)
        return -1;
    out->known = isfinite(out->h) && isfinite(out->mechanisms);
    return 0;
}

static int read_tables(const struct state *state, const char *path, struct packing *packing)
{
    static const char *const of_grains[] = {"x", "y", "radius", "mass", "inertia", "flags", NULL};
    static const char *const of_contacts[] = {"i", "j", "nx", "ny", "x", "y", "overlap", "flags", NULL};
    return state_read_info(state, &packing->info) ||
                   state_read(state, "grains", &GRAINS, of_grains, &packing->grains) ||
                   read_walls(state, path, &packing->walls) ||
                   state_read(state, "contacts", &CONTACTS, of_contacts, &packing->contacts) ||
                   check_grains(path, &packing->grains) || check_contacts(path, packing) ||
                   read_indeterminacy(state, &packing->indeterminacy)
               ? -1
               : 0;
}

static int read_attributes(const struct state *state, const char *group, struct forces *forces)
{
    double iterations = 0, converged = 0, infeasible = 0, solved = NAN, stress[4] = {NAN, NAN, NAN, NAN};
    char verdict[NAME_LENGTH] = "";
    forces->tolerance = NAN;
    forces->imbalance = forces->kn = forces->kt = forces->mu = forces->misfit[0] = forces->misfit[1] = NAN;
    if (state_read_text(state, group, "start", forces->start, sizeof forces->start) < 0 ||
        state_read_text(state, group, "verdict", verdict, sizeof verdict) < 0 ||
        state_read_text(state, group, "reasons", forces->reasons, sizeof forces->reasons) < 0 ||
        state_read_numbers(state, group, "iterations", &iterations, 1) < 0 ||
        state_read_numbers(state, group, "tolerance", &forces->tolerance, 1) < 0 ||
        state_read_numbers(state, group, "solved", &solved, 1) < 0 ||
        state_read_numbers(state, group, "converged", &converged, 1) < 0 ||
        state_read_numbers(state, group, "infeasible", &infeasible, 1) < 0 ||
        state_read_numbers(state, group, "residual", &forces->imbalance, 1) < 0 ||
        state_read_numbers(state, group, "residual_mean", &forces->imbalance_mean, 1) < 0 ||
        state_read_numbers(state, group, "cone_violation", &forces->violation, 1) < 0 ||
        state_read_numbers(state, group, "stress", stress, 4) < 0 ||
        state_read_numbers(state, group, "kn", &forces->kn, 1) < 0 ||
        state_read_numbers(state, group, "kt", &forces->kt, 1) < 0 ||
        state_read_numbers(state, group, "mu", &forces->mu, 1) < 0 ||
        state_read_numbers(state, group, "misfit_x", &forces->misfit[0], 1) < 0 ||
        state_read_numbers(state, group, "misfit_y", &forces->misfit[1], 1) < 0 ||
        state_read_numbers(state, group, "data_misfit", &forces->data_misfit, 1) < 0 ||
        state_read_numbers(state, group, "walk_states", &forces->walk.states, 1) < 0 ||
        state_read_numbers(state, group, "walk_variance", forces->walk.variance, 2) < 0 ||
        state_read_numbers(state, group, "walk_range", forces->walk.range, 2) < 0 ||
        state_read_numbers(state, group, "stability", forces->stability, 2) < 0)
        return -1;
    forces->iterations = isfinite(iterations) && fabs(iterations) < 1e9 ? (int)iterations : 0;
    forces->converged = converged == 1;
    forces->solved = isnan(solved) ? 0 : solved == 1 ? 1 : -1;
    for (int k = 0; VERDICT_NAMES[k]; k++)
        if (!strcmp(verdict, VERDICT_NAMES[k]))
            forces->verdict = (enum verdict)k;
    forces->infeasible = infeasible == 1;
    memcpy(forces->stress, stress, sizeof stress);
    return 0;
}

/* What a method says of grains has a row for each, or none. */
static int check_rows_of_grains(const char *path, const char *group, const struct packing *packing,
                                const struct forces *forces)
{
    const struct {
        const char *what;
        size_t count;
    } tables[] = {
        {"residuals", forces->residual.count}, {"rays", forces->ray.count}, {"motions", forces->softest.count}};
    for (size_t k = 0; k < sizeof tables / sizeof *tables; k++)
        if (tables[k].count && tables[k].count != packing->grains.count)
            return error_input("%s: /%s has %zu %s for %zu grains: make the file again", path, group, tables[k].count,
                               tables[k].what, packing->grains.count);
    return 0;
}

static int read_method(const struct state *state, const char *path, const char *method, const struct packing *packing,
                       struct forces *forces)
{
    static const char *const required[] = {"fn", "ft", NULL};
    char group[64];
    if (strlen(method) >= sizeof forces->method)
        return error_input("%s: method name '%s' is longer than %d bytes: shorten it", path, method, NAME_LENGTH - 1);
    strcpy(forces->method, method);
    snprintf(group, sizeof group, "forces/%s", method);
    if (state_read(state, group, &CONTACT_FORCES, required, &forces->contact) ||
        state_read(state, group, &RESIDUALS, NULL, &forces->residual) ||
        state_read(state, group, &RAYS, NULL, &forces->ray) ||
        state_read(state, group, &SOFTEST, NULL, &forces->softest) || read_attributes(state, group, forces))
        return -1;
    if (forces->contact.count != packing->contacts.count)
        return error_input("%s: /%s has %zu forces for %zu contacts: make the file again", path, group,
                           forces->contact.count, packing->contacts.count);
    return check_rows_of_grains(path, group, packing, forces);
}

static int read_forces(const struct state *state, const char *path, struct packing *packing)
{
    char **methods;
    size_t count;
    int result = 0;
    if (state_list(state, "forces", &methods, &count))
        return -1;
    packing->forces = calloc(count + 1, sizeof *packing->forces);
    if (!packing->forces)
        result = error_memory("forces");
    for (size_t f = 0; f < count && result == 0; f++, packing->force_count += result == 0) {
        result = read_method(state, path, methods[f], packing, &packing->forces[f]);
        if (result)
            forces_free(&packing->forces[f]);
    }
    free(methods);
    return result;
}

int packing_read(const char *path, struct packing *packing)
{
    memset(packing, 0, sizeof *packing);
    struct state *state = state_open(path);
    if (!state)
        return -1;
    int result = read_tables(state, path, packing) || read_forces(state, path, packing) ? -1 : 0;
    state_close(state);
    packing->length_m = packing->info.length_m;
    if (!result)
        result = packing_check(path, packing);
    if (result)
        packing_free(packing);
    return result;
}

/* ---- writing ---- */

static int write_misfit(struct state_writer *writer, const char *group, const struct forces *forces)
{
    if (!isfinite(forces->misfit[0]) || !isfinite(forces->misfit[1]))
        return 0;
    return state_write_numbers(writer, group, "misfit_x", &forces->misfit[0], 1) ||
           state_write_numbers(writer, group, "misfit_y", &forces->misfit[1], 1);
}

static int write_walk(struct state_writer *writer, const char *group, const struct walk_summary *walk)
{
    if (!(walk->states > 0))
        return 0;
    return state_write_numbers(writer, group, "walk_states", &walk->states, 1) ||
           state_write_numbers(writer, group, "walk_variance", walk->variance, 2) ||
           state_write_numbers(writer, group, "walk_range", walk->range, 2);
}

static int write_balance(struct state_writer *writer, const char *group, const struct forces *forces)
{
    if (!(forces->imbalance_mean > 0))
        return 0;
    return state_write_numbers(writer, group, "residual_mean", &forces->imbalance_mean, 1) ||
           state_write_numbers(writer, group, "cone_violation", &forces->violation, 1);
}

static int write_stability(struct state_writer *writer, const char *group, const struct forces *forces)
{
    if (!(forces->softest.count > 0))
        return 0;
    return state_write(writer, group, &SOFTEST, &forces->softest) ||
           state_write_numbers(writer, group, "stability", forces->stability, 2);
}

static int write_verdict(struct state_writer *writer, const char *group, const struct forces *forces)
{
    const double solved = forces->solved > 0;
    if (forces->solved && state_write_numbers(writer, group, "solved", &solved, 1))
        return -1;
    if (forces->verdict == VERDICT_UNKNOWN)
        return 0;
    return state_write_numbers(writer, group, "tolerance", &forces->tolerance, 1) ||
           state_write_text(writer, group, "verdict", VERDICT_NAMES[forces->verdict]) ||
           (*forces->reasons && state_write_text(writer, group, "reasons", forces->reasons));
}

static int write_method(struct state_writer *writer, const struct forces *forces)
{
    char group[64];
    const double iterations = forces->iterations, converged = forces->converged, infeasible = forces->infeasible;
    snprintf(group, sizeof group, "forces/%.*s", NAME_LENGTH, forces->method);
    return state_write(writer, group, &CONTACT_FORCES, &forces->contact) ||
                   state_write(writer, group, &RESIDUALS, &forces->residual) ||
                   (forces->ray.count > 0 && state_write(writer, group, &RAYS, &forces->ray)) ||
                   state_write_text(writer, group, "start", forces->start) ||
                   state_write_numbers(writer, group, "iterations", &iterations, 1) ||
                   state_write_numbers(writer, group, "converged", &converged, 1) ||
                   (forces->infeasible && state_write_numbers(writer, group, "infeasible", &infeasible, 1)) ||
                   state_write_numbers(writer, group, "residual", &forces->imbalance, 1) ||
                   state_write_numbers(writer, group, "stress", &forces->stress[0][0], 4) ||
                   state_write_numbers(writer, group, "kn", &forces->kn, 1) ||
                   state_write_numbers(writer, group, "kt", &forces->kt, 1) ||
                   state_write_numbers(writer, group, "mu", &forces->mu, 1) || write_misfit(writer, group, forces) ||
                   (forces->data_misfit > 0 &&
                    state_write_numbers(writer, group, "data_misfit", &forces->data_misfit, 1)) ||
                   write_verdict(writer, group, forces) || write_walk(writer, group, &forces->walk) ||
                   write_stability(writer, group, forces) || write_balance(writer, group, forces)
               ? -1
               : 0;
}

enum { DIRECTIONS = 36 }; /* bins of 5 degrees: a normal and its opposite are one direction */

/* Contacts by the direction of their normal; only those that come closer (dun < 0) when `approaching`. */
static void count_directions(const struct packing *packing, int approaching, double histogram[DIRECTIONS])
{
    const struct contacts *contacts = &packing->contacts;
    memset(histogram, 0, DIRECTIONS * sizeof *histogram);
    for (size_t c = 0; c < contacts->count; c++) {
        double angle = atan2(contacts->ny[c], contacts->nx[c]) / M_PI * DIRECTIONS;
        if ((contacts->flags[c] & CONTACT_CANDIDATE) || !isfinite(angle))
            continue;
        if (approaching && !(contacts->dun && contacts->dun[c] < 0))
            continue;
        int bin = (int)floor(angle) % DIRECTIONS;
        histogram[bin < 0 ? bin + DIRECTIONS : bin]++;
    }
}

static int write_indeterminacy(struct state_writer *writer, const struct indeterminacy *indeterminacy)
{
    return indeterminacy->known &&
           (state_write_numbers(writer, "contacts", "h", &indeterminacy->h, 1) ||
            state_write_numbers(writer, "contacts", "mechanisms", &indeterminacy->mechanisms, 1));
}

/* The fabric as attributes of /contacts. */
static int write_fabric(struct state_writer *writer, const struct packing *packing)
{
    struct fabric fabric;
    double all[DIRECTIONS], approaching[DIRECTIONS], area;
    if (packing->grains.count == 0)
        return 0;
    if (packing_area(packing, &area))
        return -1;
    packing_fabric(packing, area, &fabric);
    count_directions(packing, 0, all);
    count_directions(packing, 1, approaching);
    double counts[2] = {(double)fabric.wall_contacts, (double)fabric.rattlers};
    return state_write_numbers(writer, "contacts", "z", &fabric.z, 1) ||
           state_write_numbers(writer, "contacts", "wall_contacts", &counts[0], 1) ||
           state_write_numbers(writer, "contacts", "rattlers", &counts[1], 1) ||
           state_write_numbers(writer, "contacts", "solid_fraction", &fabric.solid, 1) ||
           state_write_numbers(writer, "contacts", "void_ratio", &fabric.void_ratio, 1) ||
           state_write_numbers(writer, "contacts", "fabric_tensor", &fabric.tensor[0][0], 4) ||
           state_write_numbers(writer, "contacts", "directions", all, DIRECTIONS) ||
           state_write_numbers(writer, "contacts", "directions_approaching", approaching, DIRECTIONS);
}

int packing_write(const char *path, const struct packing *packing, const struct provenance *provenance)
{
    struct provenance complete = *provenance;
    if (isnan(complete.length_m))
        complete.length_m = packing->length_m;
    if (!complete.coordinates)
        complete.coordinates = "si";
    struct state_writer *writer = state_create(path, &complete);
    if (!writer)
        return -1;
    int result = state_write(writer, "grains", &GRAINS, &packing->grains) ||
                 (packing->walls.name && state_write(writer, "walls", &WALLS, &packing->walls)) ||
                 state_write(writer, "contacts", &CONTACTS, &packing->contacts) || write_fabric(writer, packing) ||
                 write_indeterminacy(writer, &packing->indeterminacy);
    for (size_t f = 0; f < packing->force_count && !result; f++)
        result = write_method(writer, &packing->forces[f]);
    if (!result)
        result = vtk_write(writer, packing);
    if (result) {
        state_discard(writer);
        return -1;
    }
    return state_commit(writer);
}
