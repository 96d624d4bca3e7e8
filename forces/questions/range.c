/* The least and the largest fn of a contact are linear programmes: minimise -+ fn_c over A f + b = 0 and the cones.
 * Each is solved with the machinery of map, as the quadratic programme
 *
 *     minimise  1/2 |f - p|^2   over the same set,   p = 1 on every fn, and +- pull on fn_c;
 *
 * beyond some finite pull its solution solves the linear programme exactly (Mangasarian and Meyer 1979), so the pull
 * grows until fn_c no longer does. A force that keeps growing with the pull has no limit. */
#include "forces/questions/range.h"

#include <stdlib.h>
#include <string.h>

#include "forces/methods/map.h"
#include "pipeline/speak/error.h"

#define RANGE_FIRST 30.0 /* <fn>: the first pull */
#define RANGE_GROW 8.0   /* from pull to pull */
#define RANGE_SAME 1e-6  /* relative: fn_c no longer grows; <fn>: it is 0 */
#define UNBOUNDED 1e-2   /* of the last pull: fn_c that large grows with it */
enum { RANGE_PULLS = 6 };

/* ---- which contacts ---- */

/* One row or a span of rows, up to the next comma; *text moves on to what follows. */
static int mark_span(const char **text, size_t count, unsigned char *wanted)
{
    char *end;
    unsigned long from = strtoul(*text, &end, 10), to = from;
    int number = end != *text && **text != '-';
    if (number && *end == '-') {
        const char *second = end + 1;
        to = strtoul(second, &end, 10);
        number = end != second && *second != '-';
    }
    if (!number || (*end && *end != ',') || !strcmp(end, ",") || from > to || to >= count)
        return error_input("range '%s': give contact rows below %zu and spans of them, 3,10-14, or all", *text, count);
    memset(wanted + from, 1, to - from + 1);
    *text = *end ? end + 1 : end;
    return 0;
}

/* 1 in `wanted` for each row named. */
static int parse(const char *text, size_t count, unsigned char *wanted)
{
    if (!strcmp(text, "all")) {
        memset(wanted, 1, count);
        return 0;
    }
    do
        if (mark_span(&text, count, wanted))
            return -1;
    while (*text);
    return 0;
}

/* ---- one linear programme ---- */

/* *value: fn_c of the forces nearest to a belief with that pull; NaN: no admissible forces. */
static int pulled(const struct network *network, const struct force_options *options, const struct evidence *belief,
                  size_t c, double pull, double *f, double *value)
{
    struct evidence evidence = {0};
    struct outcome outcome = {0};
    if (evidence_copy(belief, &evidence))
        return error_memory("ranges");
    evidence.prior[2 * c] = pull;
    for (size_t k = 0; k < network->count; k++)
        f[2 * k] = 1, f[2 * k + 1] = 0;
    int status = map_solve(network, options, &evidence, f, &outcome);
    evidence_free(&evidence);
    *value = outcome.converged ? f[2 * c] : NAN;
    return status;
}

/* side -1: least, 1: largest. */
static int extreme(const struct network *network, const struct force_options *options, const struct evidence *belief,
                   size_t c, int side, double *f, double *value)
{
    double before = NAN, pull = RANGE_FIRST;
    for (int k = 0; k < RANGE_PULLS; k++, pull *= RANGE_GROW) {
        if (pulled(network, options, belief, c, side * pull, f, value))
            return -1;
        if (isnan(*value)) {
            *value = before; /* too far for the solver: what was reached so far, if anything */
            return 0;
        }
        if (fabs(*value - before) <= RANGE_SAME * fmax(1, *value) || (side < 0 && *value <= RANGE_SAME))
            return 0;
        before = *value;
    }
    if (side > 0 && *value > UNBOUNDED * pull / RANGE_GROW)
        *value = INFINITY;
    return 0;
}

static int both(const struct network *network, const struct force_options *options, const struct evidence *belief,
                size_t c, double *low, double *high)
{
    double *f = malloc((2 * network->count + 1) * sizeof *f);
    if (!f)
        return error_memory("ranges");
    int status = extreme(network, options, belief, c, -1, f, low) || extreme(network, options, belief, c, 1, f, high);
    free(f);
    return status ? -1 : 0;
}

/* Contacts are shared among the threads; the results do not depend on how. */
static int solve_all(const struct network *network, const struct force_options *options, const struct evidence *belief,
                     const unsigned char *wanted, struct contact_forces *out)
{
    struct error_shared shared = ERROR_SHARED_NONE;
#pragma omp parallel for schedule(dynamic)
    for (size_t c = 0; c < network->count; c++) {
        size_t row = network->contact[c].row;
        double low = NAN, high = NAN;
        if (!wanted[row])
            continue;
        if (both(network, options, belief, c, &low, &high))
            error_share(&shared, (long)c);
        out->fn_low[row] = low * network->force;
        out->fn_high[row] = high * network->force;
    }
    return error_collect(&shared);
}

/* The belief of the head, for all contacts at once; the pull comes later. */
static int with_network(const struct packing *packing, const struct network *network, const struct force_options *given,
                        const unsigned char *wanted, struct forces *forces)
{
    struct force_options options = *given;
    struct evidence belief = {0};
    options.start = START_MEAN; /* no overlaps: only equilibrium and the cones speak */
    options.samples = options.iterations = 0;
    double *f = calloc(2 * network->count + 1, sizeof *f);
    for (size_t c = 0; f && c < network->count; c++)
        f[2 * c] = 1;
    int status = f ? evidence_build(packing, network, &options, f, &belief) : error_memory("ranges");
    for (size_t k = 0; !status && k < 2 * network->count; k++)
        belief.variance[k] = 1;
    for (size_t d = 0; !status && d < network->dofs; d++)
        belief.soft[d] = 0;               /* every grain in balance */
    belief.barrier = belief.friction = 0; /* the extreme itself, not a mean */
    if (!status)
        status = solve_all(network, &options, &belief, wanted, &forces->contact);
    evidence_free(&belief);
    free(f);
    return status;
}

int range_forces(const struct packing *packing, const struct force_options *options, enum force_method method,
                 struct forces *forces)
{
    struct network network;
    const struct method *row = method_row(method);
    size_t count = packing->contacts.count;
    if (!row)
        return -1;
    if (!row->ranges)
        return error_input("method %s has no ranges", row->name);
    unsigned char *wanted = calloc(count + 1, 1);
    if (!wanted)
        return error_memory("ranges");
    if (parse(options->range, count, wanted) || table_add(&CONTACT_FORCES, &forces->contact, "fn_low") ||
        table_add(&CONTACT_FORCES, &forces->contact, "fn_high") || method_network(packing, options, row, &network)) {
        free(wanted);
        return -1;
    }
    int status = with_network(packing, &network, options, wanted, forces);
    network_free(&network);
    free(wanted);
    return status;
}
