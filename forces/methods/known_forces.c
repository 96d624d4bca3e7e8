/* Forces that another source gives: no equilibrium is asked for. Pairs are matched by sorting both lists by (i, j). */
#include "forces/methods/known_forces.h"

#include <stdlib.h>
#include <string.h>

#include "forces/network/elastic.h"
#include "pipeline/speak/error.h"

/* Scale the forces of overlaps so that their virial is that of the loads, where that is known. */
static void rescale_to_loads(const struct network *network, double *f)
{
    double virial = 0;
    for (size_t c = 0; c < network->count; c++)
        virial += f[2 * c] * network->contact[c].length;
    for (size_t c = 0; c < network->count && virial > 0 && isfinite(network->virial); c++)
        f[2 * c] *= network->virial / virial;
}

int forces_of_overlaps(const struct problem *problem, double *f)
{
    const struct packing *packing = problem->packing;
    const struct network *network = problem->network;
    const struct force_options *options = problem->options;
    if (!contact_law_known(&options->law))
        return error_input("no contact stiffness: give the scene contact.kn_N_per_m, or start from zero or mean");
    if (!packing->contacts.overlap)
        return error_input("the contacts have no overlaps: run contacts again, or start from zero or mean");
    for (size_t c = 0; c < network->count; c++) {
        double overlap = packing->contacts.overlap[network->contact[c].row];
        if (!isfinite(overlap))
            return error_input("contact %zu has an overlap that is not finite: run contacts again, or flag the row",
                               network->contact[c].row);
        struct contact_pair pair = elastic_pair(packing, &options->law, network->contact[c].row);
        f[2 * c] = contact_pair_force(&options->law, &pair, overlap) / network->force;
        f[2 * c + 1] = 0;
    }
    if (options->rescale)
        rescale_to_loads(network, f);
    return 0;
}

/* (i, j, row) sorted, so that duplicates keep their order. */
struct pair {
    int64_t i, j;
    long row;
};

static int compare_pairs(const void *a, const void *b)
{
    const struct pair *p = a, *q = b;
    if (p->i != q->i)
        return p->i < q->i ? -1 : 1;
    if (p->j != q->j)
        return p->j < q->j ? -1 : 1;
    return p->row < q->row ? -1 : p->row > q->row;
}

/* To be freed; NULL: memory is gone. */
static struct pair *sorted_pairs(const struct contacts *contacts)
{
    struct pair *pairs = malloc((contacts->count + 1) * sizeof *pairs);
    for (size_t c = 0; pairs && c < contacts->count; c++)
        pairs[c] = (struct pair){contacts->i[c], contacts->j[c], (long)c};
    if (pairs)
        qsort(pairs, contacts->count, sizeof *pairs, compare_pairs);
    return pairs;
}

long *match_contacts(const struct contacts *contacts, const struct contacts *previous)
{
    struct pair *here = sorted_pairs(contacts), *there = sorted_pairs(previous);
    long *match = malloc((contacts->count + 1) * sizeof *match);
    if (here && there && match) {
        size_t p = 0;
        for (size_t c = 0; c < contacts->count; c++) {
            match[here[c].row] = -1;
            while (p < previous->count &&
                   (there[p].i < here[c].i || (there[p].i == here[c].i && there[p].j < here[c].j)))
                p++;
            if (p < previous->count && there[p].i == here[c].i && there[p].j == here[c].j)
                match[here[c].row] = there[p++].row;
        }
    } else {
        error_set(EXIT_FAILED, "out of memory: contacts of the previous state");
        free(match);
        match = NULL;
    }
    free(here), free(there);
    return match;
}

/* The previous file's forces of this method, else its only or first ones. */
static const struct forces *forces_in(const struct packing *previous, const char *method)
{
    const struct forces *forces = packing_forces(previous, method);
    return forces || previous->force_count == 0 ? forces : &previous->forces[0];
}

int forces_of_state(const struct problem *problem, const struct packing *previous, const char *method, double *f)
{
    const struct packing *packing = problem->packing;
    const struct network *network = problem->network;
    if (!previous)
        return error_input("no previous state: give --previous FILE.forces.hdf");
    const struct forces *forces = forces_in(previous, method);
    if (!forces)
        return error_input("the previous state has no forces: give a file written by forces or simulate");
    if (previous->grains.count != packing->grains.count)
        return error_input("the previous state has %zu grains, this one %zu: give a state of the same series",
                           previous->grains.count, packing->grains.count);
    long *match = match_contacts(&packing->contacts, &previous->contacts);
    if (!match)
        return -1;
    for (size_t c = 0; c < network->count; c++) {
        long row = match[network->contact[c].row];
        f[2 * c] = row >= 0 ? forces->contact.fn[row] / network->force : 0;
        f[2 * c + 1] = row >= 0 ? forces->contact.ft[row] / network->force : 0;
    }
    free(match);
    return 0;
}
