/* Every state counts the same; the first is that of the forces that were given, when they are in balance. Jump k draws
 * its random numbers from k alone, whatever the jumps before it did. */
#include "forces/questions/walk.h"

#include <stdlib.h>
#include <string.h>

#include "pipeline/speak/error.h"
#include "pipeline/numbers/quantiles.h"
#include "pipeline/numbers/random.h"

struct walk {
    const struct packing *packing;
    const struct network *network;
    struct force_options options;
    const struct method *method;
    double *f, *trial; /* the present state and the next one, (fn, ft) per contact */
    double *states;    /* one after the other: fn of all contacts, then ft of all contacts */
    size_t count;      /* of states */
};

/* The present state, fn and ft apart. */
static void keep(struct walk *walk)
{
    size_t n = walk->network->count;
    double *state = walk->states + walk->count++ * 2 * n;
    for (size_t c = 0; c < n; c++)
        state[c] = walk->f[2 * c], state[n + c] = walk->f[2 * c + 1];
}

/* From the present state; where the method does not lead back to balance the walk stays. */
static int jump(struct walk *walk, int k)
{
    size_t unknowns = 2 * walk->network->count;
    double size = WALK_JUMP * network_mean_force(walk->network, walk->f);
    struct outcome outcome = {0};
    for (size_t u = 0; u < unknowns; u++)
        walk->trial[u] = walk->f[u] + size * (2 * random_uniform(random_bits(0x3A1Cu, (uint64_t)k), u) - 1);
    if (walk->method->solve(&(struct problem){walk->packing, walk->network, &walk->options}, walk->trial, &outcome))
        return -1;
    if (!outcome.converged)
        return 0;
    memcpy(walk->f, walk->trial, unknowns * sizeof *walk->f);
    keep(walk);
    return 0;
}

/* ---- what the states say ---- */

/* Component `part` (0: fn, 1: ft) of contact c over the states, sorted; its variance. */
static double gather(const struct walk *walk, size_t c, size_t part, double *values)
{
    size_t n = walk->network->count;
    double mean = 0, sum = 0;
    for (size_t k = 0; k < walk->count; k++) {
        values[k] = walk->states[k * 2 * n + part * n + c];
        mean += values[k] / (double)walk->count;
    }
    for (size_t k = 0; k < walk->count; k++)
        sum += (values[k] - mean) * (values[k] - mean);
    sort_values(values, walk->count);
    return sum / (double)(walk->count - 1);
}

/* V = <Var> / <fn>^2 and R = <max - min> / <fn> over the contacts (thesis 3.8 and 3.9; the thesis prints <fn> for
 * <fn>^2, with which V would be a force). */
static void summarise(const struct walk *walk, double mean, double *values, struct forces *forces)
{
    const struct network *network = walk->network;
    struct contact_forces *out = &forces->contact;
    struct walk_summary *summary = &forces->walk;
    *summary = (struct walk_summary){.states = (double)walk->count};
    for (size_t c = 0; c < network->count; c++)
        for (size_t part = 0; part < 2; part++) {
            double variance = gather(walk, c, part, values), range = values[walk->count - 1] - values[0];
            size_t row = network->contact[c].row;
            summary->variance[part] += variance / (mean * mean) / (double)network->count;
            summary->range[part] += range / mean / (double)network->count;
            (part ? out->s_ft : out->s_fn)[row] = sqrt(variance) * network->force;
            if (!part) {
                out->fn_min[row] = quantile(values, walk->count, 0.05) * network->force;
                out->fn_max[row] = quantile(values, walk->count, 0.95) * network->force;
            }
        }
}

/* The columns are added in any case: NaN where there were too few states. */
static int run(struct walk *walk, struct forces *forces)
{
    const struct network *network = walk->network;
    double *values = calloc((size_t)walk->options.walk + 2, sizeof *values);
    int status = 0;
    for (size_t c = 0; c < network->count; c++) {
        walk->f[2 * c] = forces->contact.fn[network->contact[c].row] / network->force;
        walk->f[2 * c + 1] = forces->contact.ft[network->contact[c].row] / network->force;
    }
    double mean = network_mean_force(network, walk->f);
    if (!values)
        status = error_memory("random walk");
    if (!status && forces->converged)
        keep(walk);
    for (int k = 0; !status && k < walk->options.walk; k++)
        status = jump(walk, k);
    if (!status)
        status = result_add_spread(&forces->contact);
    if (!status && walk->count >= 2)
        summarise(walk, mean, values, forces);
    free(values);
    return status;
}

int walk_forces(const struct packing *packing, const struct force_options *options, enum force_method method,
                struct forces *forces)
{
    struct network network;
    const struct method *row = method_row(method);
    if (!row)
        return -1;
    if (!row->walks)
        return error_input("method %s cannot walk: a walk needs one that leads back to equilibrium, such as map",
                           row->name);
    if (method_network(packing, options, row, &network))
        return -1;
    struct walk walk = {.packing = packing, .network = &network, .options = *options, .method = row};
    walk.options.start = START_PREVIOUS; /* the jump is all that map knows */
    walk.options.samples = 0;
    walk.f = calloc(2 * network.count + 1, sizeof *walk.f);
    walk.trial = calloc(2 * network.count + 1, sizeof *walk.trial);
    walk.states = calloc(((size_t)options->walk + 1) * 2 * network.count + 1, sizeof *walk.states);
    int status = walk.f && walk.trial && walk.states ? run(&walk, forces) : error_memory("random walk");
    free(walk.f), free(walk.trial), free(walk.states);
    network_free(&network);
    return status;
}
