/* Contact elasticity (thesis 2.1.1): the forces of the previous state, or of the overlaps where there is none, moved by
 * the measured relative motions along the contact law, then cut at Coulomb's cone. Equilibrium has no say in it. */
#include <stdlib.h>

#include "forces/methods/known_forces.h"
#include "forces/methods/method.h"
#include "forces/network/elastic.h"
#include "pipeline/speak/error.h"

/* A column that is missing is not known in any row. */
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
static int check_motions(const struct problem *problem, const long *match)
{
    const struct packing *packing = problem->packing;
    const struct network *network = problem->network;
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
static void advance(const struct problem *problem, size_t c, int old, double *f)
{
    const struct packing *packing = problem->packing;
    const struct network *network = problem->network;
    const struct force_options *options = problem->options;
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

static int advance_all(const struct problem *problem, double *f)
{
    const struct packing *packing = problem->packing, *previous = problem->options->previous;
    long *match = previous ? match_contacts(&packing->contacts, &previous->contacts) : NULL;
    int status = !previous ? 0 : match ? check_motions(problem, match) : -1;
    for (size_t c = 0; c < problem->network->count && !status; c++)
        advance(problem, c, is_old(packing, match, problem->network->contact[c].row), f);
    free(match);
    return status;
}

static int solve(const struct problem *problem, double *f, struct outcome *outcome)
{
    const struct packing *previous = problem->options->previous;
    (void)outcome; /* nothing is iterated */
    if (!contact_law_known(&problem->options->law))
        return error_input("no contact stiffness: give the scene contact.kn_N_per_m");
    if (previous ? forces_of_state(problem, previous, CEM_METHOD.name, f) : forces_of_overlaps(problem, f))
        return -1;
    return advance_all(problem, f);
}

const struct method CEM_METHOD = {.name = "cem",
                                  .says = "measured motions times stiffness, no equilibrium",
                                  .needs = NEEDS_STIFFNESS,
                                  .ranges = 1,
                                  .margin = METHOD_MARGIN,
                                  .doubt = INFINITY,
                                  .solve = solve};
