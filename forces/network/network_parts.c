/* What of a packing takes part. Rows whose numbers are missing are flagged by the stages before, and left out; rows
 * that are not flagged must have numbers, or they are refused by name: a NaN in one place would spread over the whole
 * network. */
#include "forces/network/network_parts.h"

#include <stdlib.h>
#include <string.h>

#include "pipeline/speak/error.h"

#define FARTHEST 1e9 /* m: no packing is larger, and squares of squares stay numbers */

int network_offers(const struct packing *packing, const struct network_options *options, size_t c)
{
    uint32_t flags = packing->contacts.flags ? packing->contacts.flags[c] : 0;
    return !(flags & CONTACT_NOT_FINITE) && (options->candidates || !(flags & CONTACT_CANDIDATE));
}

int network_fixes(const struct packing *packing, size_t k)
{
    return packing->grains.flags && (packing->grains.flags[k] & GRAIN_FIXED);
}

/* A grain that pushes has numbers, whatever its flags say. */
static int grain_counts(const struct grains *g, size_t k)
{
    return fabs(g->x[k]) < FARTHEST && fabs(g->y[k]) < FARTHEST && g->radius[k] > 0 && g->radius[k] < FARTHEST &&
           isfinite(column_or_zero(g->load_x, k)) && isfinite(column_or_zero(g->load_y, k)) &&
           isfinite(column_or_zero(g->load_m, k));
}

/* ... and so have the grains at a contact. */
static int check_ends(const struct packing *packing, size_t c)
{
    const struct contacts *contacts = &packing->contacts;
    const int64_t ends[2] = {contacts->i[c], contacts->j[c]};
    for (int e = 0; e < 2; e++)
        if (ends[e] < (int64_t)packing->grains.count && !grain_counts(&packing->grains, (size_t)ends[e]))
            return error_input("contact %zu is one of grain %lld, whose place, radius or load is no number that can "
                               "be: run contacts again, or flag the contact",
                               c, (long long)ends[e]);
    return 0;
}

/* Only those that are offered: the others may hold anything. */
static int check_contacts(const struct packing *packing, const struct network_options *options)
{
    const struct contacts *c = &packing->contacts;
    int64_t bodies = (int64_t)(packing->grains.count + packing->walls.count);
    for (size_t k = 0; k < c->count; k++) {
        if (!network_offers(packing, options, k))
            continue;
        if (c->i[k] < 0 || c->i[k] >= (int64_t)packing->grains.count || c->j[k] <= c->i[k] || c->j[k] >= bodies)
            return error_input("contact %zu joins %lld and %lld: give 0 <= i < j below the number of grains and walls",
                               k, (long long)c->i[k], (long long)c->j[k]);
        if (!isfinite(c->nx[k]) || !isfinite(c->ny[k]) || fabs(hypot(c->nx[k], c->ny[k]) - 1) > 1e-6)
            return error_input("contact %zu has no unit normal: run contacts again, or flag the row", k);
        if (!(fabs(c->x[k]) < FARTHEST && fabs(c->y[k]) < FARTHEST))
            return error_input(
                "contact %zu has a contact point that is not finite: run contacts again, or flag the row", k);
        if (check_ends(packing, k))
            return -1;
    }
    return 0;
}

static int check_grains(const struct packing *packing)
{
    const struct grains *g = &packing->grains;
    for (size_t k = 0; k < g->count; k++) {
        if (g->flags && (g->flags[k] & GRAIN_DISTRUST))
            continue; /* its contacts are flagged, or were made of numbers that are finite */
        if (!isfinite(column_or_zero(g->load_x, k)) || !isfinite(column_or_zero(g->load_y, k)) ||
            !isfinite(column_or_zero(g->load_m, k)))
            return error_input("grain %zu has a load that is not finite: give its density, or leave gravity out", k);
        if (!grain_counts(g, k))
            return error_input("grain %zu has no finite place or radius: run contacts again, or flag the row", k);
    }
    return 0;
}

/* A disc has a centre and a radius, a segment two ends. */
static int check_walls(const struct walls *walls)
{
    for (size_t w = 0; w < walls->count; w++)
        if (!(fabs(walls->x0[w]) < FARTHEST && fabs(walls->y0[w]) < FARTHEST && fabs(walls->radius[w]) < FARTHEST) ||
            (!wall_is_disc(walls, w) && !(fabs(walls->x1[w]) < FARTHEST && fabs(walls->y1[w]) < FARTHEST)))
            return error_input("wall %zu has no finite place or radius: run contacts again", w);
    return 0;
}

/* Without a wall or a fixed grain every force could be anything: there is nothing to react. */
static int check_held(const struct packing *packing)
{
    if (packing->walls.count > 0)
        return 0;
    for (size_t k = 0; k < packing->grains.count; k++)
        if (network_fixes(packing, k))
            return 0;
    size_t touching = 0;
    for (size_t c = 0; c < packing->contacts.count; c++)
        touching += !(packing->contacts.flags[c] & CONTACT_CANDIDATE);
    if (touching || packing->grains.count < 2)
        return error_input("nothing holds the packing: give the scene a frame, or flag a grain as fixed");
    return error_input("no two of %zu grains touch, so there are no forces: run contacts again with other radii "
                       "(contacts.radius_offset_px or radius_scale)",
                       packing->grains.count);
}

int network_check(const struct packing *packing, const struct network_options *options)
{
    return check_held(packing) || check_grains(packing) || check_walls(&packing->walls) ||
                   check_contacts(packing, options)
               ? -1
               : 0;
}

/* Can one contact alone hold this grain? Its force must be opposite to the load and push. */
static int load_along(const struct packing *packing, size_t k, size_t c, double mu)
{
    const struct grains *g = &packing->grains;
    struct vec load = vec(column_or_zero(g->load_x, k), column_or_zero(g->load_y, k));
    struct vec n = vec(packing->contacts.nx[c], packing->contacts.ny[c]);
    double push = vec_dot(load, n) * (packing->contacts.i[c] == (int64_t)k ? 1 : -1);
    return push > 0 && fabs(vec_cross(n, load)) <= fmax(mu, 1e-6) * push;
}

/* Counts and marks until nothing changes; each turn costs a walk over all contacts, and the turns are as many as the
 * longest chain of rattlers that lean on each other. */
int network_peel(const struct packing *packing, const struct contact_law *law, unsigned char *live,
                 unsigned char *peeled)
{
    const struct contacts *contacts = &packing->contacts;
    size_t grains = packing->grains.count;
    size_t *degree = calloc(grains + 1, sizeof *degree), *last = calloc(grains + 1, sizeof *last);
    if (!degree || !last) {
        free(degree), free(last);
        return error_memory("rattlers");
    }
    for (int again = 1; again;) {
        again = 0;
        memset(degree, 0, grains * sizeof *degree);
        for (size_t c = 0; c < contacts->count; c++) {
            if (!live[c])
                continue;
            size_t ends[2] = {(size_t)contacts->i[c], (size_t)contacts->j[c]};
            for (int e = 0; e < 2; e++)
                if (ends[e] < grains)
                    degree[ends[e]]++, last[ends[e]] = c;
        }
        for (size_t k = 0; k < grains; k++) {
            if (peeled[k] || network_fixes(packing, k) || degree[k] > 1)
                continue;
            if (degree[k] == 1 && load_along(packing, k, last[k], law->mu))
                continue;
            peeled[k] = 1;
            again |= degree[k] == 1;
            if (degree[k] == 1)
                live[last[k]] = 0;
        }
    }
    free(degree), free(last);
    return 0;
}
