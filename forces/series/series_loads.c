#include "forces/series/series_loads.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "pipeline/numbers/golden.h"
#include "forces/network/network.h"
#include "pipeline/speak/error.h"

#define RANGE 1.6        /* kn is sought between given / RANGE and given * RANGE */
#define PRECISE 6.8e-7   /* of that range, in log kn: 30 sections */
#define LEAST_RANGE 1.03 /* of the loads: else kn is not sought */
#define SCATTER 0.01 /* of a state's virial from overlaps: contacts that open and close, errors that do not repeat */

/* One state: its overlaps with their branches, and the virial of its loads. */
struct balance {
    size_t count;
    struct line {
        double overlap, length; /* m */
        double radii;           /* how many radii the overlap has: 2, or 1 at a wall */
    } * line;
    double virial; /* N m; NaN: reactions unknown */
    double force;  /* N: the network's unit */
};

/* NULL is accepted. */
static void balances_free(struct balance *balance, size_t count)
{
    for (size_t s = 0; balance && s < count; s++)
        free(balance[s].line);
    free(balance);
}

/* From the network of that state, with its candidates. */
static int balance_read(const struct packing *packing, const struct force_options *options, struct balance *balance)
{
    struct network network;
    struct network_options network_options = {.candidates = 1, .wall_mass = options->wall_mass};
    if (network_build(packing, &options->law, &network_options, &network))
        return -1;
    balance->count = network.count;
    balance->line = calloc(network.count + 1, sizeof *balance->line);
    balance->virial = network.virial * network.force * network.radius;
    balance->force = network.force;
    int status = balance->line ? 0 : error_memory("loads of the series");
    for (size_t c = 0; c < network.count && !status; c++) {
        size_t row = network.contact[c].row, w;
        balance->line[c] = (struct line){.overlap = packing->contacts.overlap[row],
                                         .length = network.contact[c].length * network.radius,
                                         .radii = packing_is_wall(packing, row, &w) ? 1 : 2};
    }
    network_free(&network);
    return status;
}

/* Sum of positive overlaps times branch length, all radii made smaller by `offset`. */
static double overlap_virial(const struct balance *balance, double offset)
{
    double sum = 0;
    for (size_t c = 0; c < balance->count; c++)
        sum += fmax(0, balance->line[c].overlap - balance->line[c].radii * offset) * balance->line[c].length;
    return sum;
}

/* The offset at which overlaps times kn carry the loads, by halving: the sum of their virials over all states whose
 * loads are known falls with the offset. 0: no loads are known. */
static double find_offset(const struct balance *balance, size_t count, double kn)
{
    double low = 0, high = 0, aim = 0;
    for (size_t s = 0; s < count; s++)
        for (size_t c = 0; c < balance[s].count; c++) {
            low = fmin(low, balance[s].line[c].overlap);
            high = fmax(high, balance[s].line[c].overlap);
        }
    for (size_t s = 0; s < count; s++)
        aim += isfinite(balance[s].virial) ? balance[s].virial / kn : 0;
    for (int k = 0; k < 60 && aim > 0; k++) {
        double middle = 0.5 * (low + high), sum = 0;
        for (size_t s = 0; s < count; s++)
            sum += isfinite(balance[s].virial) ? overlap_virial(&balance[s], middle) : 0;
        *(sum > aim ? &low : &high) = middle;
    }
    return aim > 0 ? 0.5 * (low + high) : 0;
}

/* The mean normal force of the most loaded state, over the contacts that the offset leaves. */
static double largest_force(const struct balance *balance, size_t count, double offset)
{
    double largest = 0;
    for (size_t s = 0; s < count; s++) {
        double length = 0;
        for (size_t c = 0; c < balance[s].count; c++)
            length += balance[s].line[c].overlap > balance[s].line[c].radii * offset ? balance[s].line[c].length : 0;
        double force = isfinite(balance[s].virial) && length > 0 ? balance[s].virial / length : balance[s].force;
        largest = fmax(largest, force);
    }
    return largest;
}

/* How badly (kn, the offset that goes with it) meets the loads of the single states: rms of virial over virial, each
 * state weighted by its load. */
static double disagreement(const struct balance *balance, size_t count, double kn, double *offset)
{
    double sum = 0, whole = 0;
    *offset = find_offset(balance, count, kn);
    for (size_t s = 0; s < count; s++)
        if (isfinite(balance[s].virial)) {
            sum += pow(kn * overlap_virial(&balance[s], *offset) - balance[s].virial, 2);
            whole += balance[s].virial * balance[s].virial;
        }
    return whole > 0 ? sqrt(sum / whole) : 0;
}

struct balances {
    const struct balance *balance;
    size_t count;
};

/* golden_section() in log kn: the range is a ratio. */
static double disagreement_at(double log_stiffness, void *user)
{
    const struct balances *balances = user;
    double offset;
    return disagreement(balances->balance, balances->count, exp(log_stiffness), &offset);
}

/* N/m: the one at which the states' balances disagree least, sought in ln kn within RANGE of the given one. */
static double best_stiffness(const struct balance *balance, size_t count, double given)
{
    struct balances balances = {balance, count};
    double low = log(given / RANGE), high = log(given * RANGE);
    return exp(golden_section(disagreement_at, &balances, low, high, PRECISE * (high - low)));
}

/* Largest over smallest virial; 1 with fewer than two known ones. */
static double load_range(const struct balance *balance, size_t count)
{
    double low = INFINITY, high = 0;
    for (size_t s = 0; s < count; s++)
        if (isfinite(balance[s].virial)) {
            low = fmin(low, balance[s].virial);
            high = fmax(high, balance[s].virial);
        }
    return low > 0 && high > low ? high / low : 1;
}

/* kn, and how wrong it may be: where the disagreement has grown by the part that single states scatter anyway. */
static void fit_stiffness(const struct balance *balance, size_t count, struct series_loads *loads)
{
    double offset, range = load_range(balance, count);
    if (range < LEAST_RANGE) {
        loads->refused = "the loads hardly change from photo to photo: k_n and the offset of the radii cannot be told "
                         "apart";
        return;
    }
    double best = best_stiffness(balance, count, loads->kn), step = 0.02;
    double floor = hypot(disagreement(balance, count, best, &offset), SCATTER);
    double beside = 0.5 * (disagreement(balance, count, best * (1 + step), &offset) +
                           disagreement(balance, count, best * (1 - step), &offset));
    double slope = sqrt(fmax(1e-12, beside * beside - pow(disagreement(balance, count, best, &offset), 2))) / step;
    loads->kn = best;
    loads->s_kn = fmin(0.3, fmax(0.01, floor / slope)) * best;
}

int series_loads_fit(const struct packing *const *packings, size_t count, const struct force_options *options,
                     int offset, int stiffness, struct series_loads *loads)
{
    struct balance *balance = calloc(count + 1, sizeof *balance);
    int status = balance ? 0 : error_memory("loads of the series");
    *loads = (struct series_loads){.kn = options->law.kn};
    for (size_t s = 0; s < count && !status; s++)
        status = balance_read(packings[s], options, &balance[s]);
    if (!status) {
        if (stiffness)
            fit_stiffness(balance, count, loads);
        if (offset)
            loads->offset = find_offset(balance, count, loads->kn);
        loads->force = largest_force(balance, count, loads->offset);
        loads->s_offset = (loads->s_kn > 0 ? 0.5 : 0.1) * loads->force / loads->kn;
    }
    balances_free(balance, count);
    return status;
}
