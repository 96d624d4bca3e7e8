/* What a method starts from (thesis 3.2, 3.5.2): nothing, the mean force, the overlaps, the measured motions, or
 * another state's forces. */
#include "forces/methods/method.h"

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

static int from_overlap(const struct packing *packing, const struct network *network,
                        const struct force_options *options, double *f)
{
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
static const struct forces *previous_forces(const struct packing *previous, enum force_method method)
{
    const struct forces *forces = packing_forces(previous, FORCE_METHODS[method]);
    return forces || previous->force_count == 0 ? forces : &previous->forces[0];
}

static int from_previous(const struct packing *packing, const struct network *network, const struct packing *previous,
                         enum force_method method, double *f)
{
    if (!previous)
        return error_input("no previous state: give --previous FILE.forces.hdf");
    const struct forces *forces = previous_forces(previous, method);
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

/* An iteration may begin anywhere: a force that is not known begins at 0; but it cannot be held. */
static int fill_unknown(const struct network *network, const struct force_options *options, double *f)
{
    for (size_t c = 0; c < network->count; c++) {
        if (isfinite(f[2 * c]) && isfinite(f[2 * c + 1]))
            continue;
        if (options->fix != FIX_NONE)
            return error_input("contact %zu has no finite force in the start that could be held: leave --fix out, or "
                               "start from other forces",
                               network->contact[c].row);
        for (size_t part = 2 * c; part < 2 * c + 2; part++)
            f[part] = isfinite(f[part]) ? f[part] : 0;
    }
    return 0;
}

static double motion(const double *column, size_t row)
{
    return column ? column[row] : NAN;
}

/* Was this row a contact in the previous state? A new one, whose partner was near at most, has no increment. */
static int is_old(const struct packing *packing, const long *match, size_t row)
{
    const uint32_t *flags = packing->contacts.flags;
    return match && match[row] >= 0 && !(flags && (flags[row] & CONTACT_NEW));
}

/* Where no contact of the previous state has a motion, the forces would be those of that state. */
static int check_motions(const struct packing *packing, const struct network *network, const long *match)
{
    size_t old = 0;
    for (size_t c = 0; c < network->count; c++) {
        size_t row = network->contact[c].row;
        if (isfinite(motion(packing->contacts.dun, row)))
            return 0;
        old += (size_t)is_old(packing, match, row);
    }
    return old ? error_input("no contact has a motion since the previous state: run contacts with --previous") : 0;
}

/* Add what contact c has moved, in working units. A contact that was not there before begins with what is known of
 * its motion; one that was has no force that could be told when its motion is not known (NaN). */
static void advance(const struct packing *packing, const struct network *network, const struct force_options *options,
                    size_t c, int old, double *f)
{
    size_t row = network->contact[c].row;
    double fn = f[2 * c] * network->force, ft = f[2 * c + 1] * network->force;
    double dun = options->previous ? motion(packing->contacts.dun, row) : 0;
    double dut = motion(options->previous ? packing->contacts.dut : packing->contacts.ut, row);
    int known_n = isfinite(dun) && isfinite(fn), known_t = isfinite(dut) && isfinite(ft);
    fn = old || isfinite(fn) ? fn : 0;
    ft = isfinite(ft) ? ft : 0;
    struct contact_pair pair = elastic_pair(packing, &options->law, row);
    contact_pair_advance(&options->law, &pair, network->contact[c].mu, known_n && (known_t || old) ? dun : 0,
                         known_n && known_t ? dut : 0, &fn, &ft);
    if (old && !known_n)
        fn = ft = NAN;
    else if (old && !known_t && fn > 0)
        ft = NAN;
    f[2 * c] = fn / network->force;
    f[2 * c + 1] = ft / network->force;
}

static int advance_all(const struct packing *packing, const struct network *network,
                       const struct force_options *options, double *f)
{
    long *match = options->previous ? match_contacts(&packing->contacts, &options->previous->contacts) : NULL;
    int status = !options->previous ? 0 : match ? check_motions(packing, network, match) : -1;
    for (size_t c = 0; c < network->count && !status; c++)
        advance(packing, network, options, c, is_old(packing, match, network->contact[c].row), f);
    free(match);
    return status;
}

int cem_forces(const struct packing *packing, const struct network *network, const struct force_options *options,
               double *f)
{
    if (!contact_law_known(&options->law))
        return error_input("no contact stiffness: give the scene contact.kn_N_per_m");
    if (options->previous ? from_previous(packing, network, options->previous, METHOD_CEM, f)
                          : from_overlap(packing, network, options, f))
        return -1;
    return advance_all(packing, network, options, f);
}

static int start_from_cem(const struct packing *packing, const struct network *network,
                          const struct force_options *options, double *f)
{
    return cem_forces(packing, network, options, f) || fill_unknown(network, options, f) ? -1 : 0;
}

static int start_from_state(const struct packing *packing, const struct network *network,
                            const struct packing *previous, const struct force_options *options,
                            enum force_method method, double *f)
{
    return from_previous(packing, network, previous, method, f) || fill_unknown(network, options, f) ? -1 : 0;
}

int start_forces(const struct packing *packing, const struct network *network, const struct force_options *options,
                 enum force_method method, double *f)
{
    memset(f, 0, 2 * network->count * sizeof *f);
    switch (options->start) {
    case START_DEFAULT:
        return contact_law_known(&options->law) && packing->contacts.overlap
                   ? from_overlap(packing, network, options, f)
                   : 0;
    case START_ZERO:
        return 0;
    case START_MEAN:
        for (size_t c = 0; c < network->count; c++)
            f[2 * c] = 1;
        return 0;
    case START_OVERLAP:
        return from_overlap(packing, network, options, f);
    case START_CEM:
        return start_from_cem(packing, network, options, f);
    case START_PREVIOUS:
        return start_from_state(packing, network, options->previous, options, method, f);
    case START_FILE:
        return start_from_state(packing, network, options->from, options, method, f);
    }
    return error_input("unknown start");
}
