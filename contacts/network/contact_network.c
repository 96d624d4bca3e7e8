/* From pairs to contacts. The overlaps of all near pairs are a mixture (pair_statistics.h): of grains that are
 * squeezed, of grains that rest, of gaps. Once the idle grains are known (standing.h), pairs with one of them are a
 * mixture with shares of its own, and among the rest nothing rests.
 *
 * A pair with an overlap x and its error s has a probability for each case. It is a contact where touching is more
 * likely than not; it stays as a candidate, flagged, while its overlap is within candidate_sigmas errors of zero:
 * forces may need it, and range questions ask what else could be. */
#include "contacts/network/contact_network.h"

#include <stdlib.h>

#include "contacts/network/standing.h"
#include "pipeline/speak/error.h"

enum { ENOUGH_PAIRS = 50000 }; /* for the statistics; more would only cost time */

void contact_network_free(struct contact_network *network)
{
    pairs_free(&network->pairs);
    frame_free(&network->frame);
    free(network->idle);
    *network = (struct contact_network){0};
}

static int is_idle(const struct contact_network *network, const struct grains *grains, const struct pair *pair)
{
    return network->idle && (network->idle[pair->i] || ((size_t)pair->j < grains->count && network->idle[pair->j]));
}

/* The statistics of both kinds of pairs between trusted grains. */
static int learn(const struct grains *grains, struct contact_network *network)
{
    size_t count = network->pairs.count, stride = count / ENOUGH_PAIRS + 1, n = 0, m = count;
    double *x = malloc((count + 1) * sizeof *x), *s = malloc((count + 1) * sizeof *s);
    for (size_t p = 0; x && s && p < count; p += stride) {
        const struct pair *pair = &network->pairs.pair[p];
        if ((grains->flags[pair->i] | grains->flags[pair->j]) & GRAIN_DISTRUST)
            continue;
        size_t to = is_idle(network, grains, pair) ? --m : n++; /* bearing from the front, idle from the back */
        x[to] = pair->overlap;
        s[to] = pair->s_overlap;
    }
    int status = x && s ? pairs_median_error(&network->pairs, &network->error) : error_memory("overlaps");
    if (status == 0) {
        /* between grains that are held, nothing rests: what is near zero is a weak contact or a narrow gap */
        int rests = !network->idle && !network->unbalanced;
        struct pair_premises premises = {.window = network->window, .rests = rests};
        pair_statistics_fit(x, s, n, &premises, NULL, &network->bearing);
        premises.window = fmin(network->window, fmax(pair_mean_overlap(&network->bearing), 6 * network->error));
        pair_statistics_fit(x, s, n, &premises, &network->bearing, &network->bearing);
        pair_statistics_shares(x + m, s + m, count - m, &network->bearing, &network->idle_pairs);
    }
    free(x);
    free(s);
    return status;
}

static void weigh(const struct grains *grains, struct contact_network *network)
{
    for (size_t p = 0; p < network->pairs.count; p++) {
        struct pair *pair = &network->pairs.pair[p];
        const struct pair_statistics *statistics =
            is_idle(network, grains, pair) ? &network->idle_pairs : &network->bearing;
        pair->odds = pair_odds(statistics, pair->overlap, pair->s_overlap);
    }
}

/* From four mean overlaps below zero (or six errors) to as many above, of pairs between grains; the fit for the median
 * error. */
static void count_overlaps(const struct grains *grains, double px, struct contact_network *network)
{
    struct overlap_histogram *histogram = &network->histogram;
    double error = network->error, reach = fmax(4 * pair_mean_overlap(&network->bearing), 6 * error);
    double width = 2 * reach / HISTOGRAM_BINS;
    *histogram = (struct overlap_histogram){.low_px = -reach / px, .width_px = width / px};
    for (size_t p = 0; p < network->pairs.count; p++) {
        const struct pair *pair = &network->pairs.pair[p];
        double bin = floor((pair->overlap + reach) / width);
        if ((size_t)pair->j >= grains->count || ((grains->flags[pair->i] | grains->flags[pair->j]) & GRAIN_DISTRUST))
            continue;
        if (bin >= 0 && bin < HISTOGRAM_BINS)
            (is_idle(network, grains, pair) ? histogram->idle : histogram->bearing)[(int)bin]++;
    }
    for (int b = 0; b < HISTOGRAM_BINS; b++) {
        double x = (b + 0.5) * width - reach;
        if (x < -network->window) /* the density is fitted inside the window only */
            continue;
        const struct pair_statistics *bearing = &network->bearing, *idle = &network->idle_pairs;
        histogram->fit_bearing[b] = (double)bearing->pairs * width * exp(pair_odds(bearing, x, error).log_density);
        histogram->fit_idle[b] = (double)idle->pairs * width * exp(pair_odds(idle, x, error).log_density);
    }
}

/* That the true overlap is positive. Under its weight, a grain that rests touches. */
static double probability_of(const struct contact_input *input, const struct pair *pair)
{
    struct vec gravity = input->scene->gravity;
    return pair->odds.touching + (gravity.x != 0 || gravity.y != 0 ? pair->odds.resting : 0);
}

/* Once it is known which grains carry nothing, by the probability. Before, and where most grains carry nothing, what
 * rests is a contact too: it costs nothing, a lost contact costs much (thesis 3.4.2). */
static int is_contact(const struct contact_input *input, const struct contact_options *options, int idle_known,
                      const struct pair *pair)
{
    if (isfinite(options->tolerance_px))
        return pair->overlap > -options->tolerance_px * input->scene->scale;
    return (idle_known ? probability_of(input, pair) : 1 - pair->odds.apart) > 0.5;
}

static size_t keep_likely(const struct contact_input *input, const struct contact_options *options, int idle_known,
                          struct pairs *pairs)
{
    size_t kept = 0;
    for (size_t p = 0; p < pairs->count; p++) {
        struct pair pair = pairs->pair[p];
        if (is_contact(input, options, idle_known, &pair) || pair.overlap > -options->candidate_sigmas * pair.s_overlap)
            pairs->pair[kept++] = pair;
    }
    return pairs->count = kept;
}

static int fill_contacts(const struct contact_input *input, const struct contact_options *options,
                         struct contact_network *network, struct packing *packing)
{
    struct contacts *contacts = &packing->contacts;
    table_free(&CONTACTS, contacts);
    if (table_alloc(&CONTACTS, contacts, keep_likely(input, options, network->idle != NULL, &network->pairs), NULL))
        return -1;
    for (size_t c = 0; c < contacts->count; c++) {
        const struct pair *pair = &network->pairs.pair[c];
        contacts->i[c] = pair->i;
        contacts->j[c] = pair->j;
        contacts->nx[c] = pair->n.x;
        contacts->ny[c] = pair->n.y;
        contacts->x[c] = pair->at.x;
        contacts->y[c] = pair->at.y;
        contacts->overlap[c] = pair->overlap;
        contacts->s_overlap[c] = pair->s_overlap;
        contacts->probability[c] = probability_of(input, pair);
        contacts->flags[c] = (size_t)pair->j >= packing->grains.count ? CONTACT_WALL : 0;
        if (!is_contact(input, options, network->idle != NULL, pair))
            contacts->flags[c] |= CONTACT_CANDIDATE;
    }
    return 0;
}

int contact_network_build(const struct contact_input *input, const struct contact_options *options,
                          const struct vec *reference, struct contact_network *network, struct packing *packing)
{
    double tolerance = fmax(0, isfinite(options->tolerance_px) ? options->tolerance_px * input->scene->scale : 0);
    struct frame_request request = {.scene = input->scene,
                                    .lens = input->lens,
                                    .grains = &packing->grains,
                                    .reference = reference,
                                    .patches = input->patches,
                                    .statistics = {&network->bearing, &network->idle_pairs, network->idle},
                                    .frame_error_px = options->frame_error_px};
    pairs_free(&network->pairs);
    frame_free(&network->frame);
    table_free(&WALLS, &packing->walls);
    if (candidates_between_grains(&packing->grains, options->candidate_sigmas, tolerance, &network->pairs,
                                  &network->window) ||
        learn(&packing->grains, network) || frame_walls(&request, &network->frame) ||
        table_copy(&WALLS, &packing->walls, &network->frame.now) ||
        candidates_with_walls(&packing->grains, &packing->walls, fmax(network->window, tolerance), &network->pairs))
        return -1;
    weigh(&packing->grains, network);
    count_overlaps(&packing->grains, input->scene->scale, network);
    return fill_contacts(input, options, network, packing);
}

int contact_network_find_idle(const struct contact_input *input, struct contact_network *network,
                              struct packing *packing)
{
    const struct contact_law *law = &input->scene->contact;
    struct stability_rules rules = {.mu = NAN, .mu_wall = NAN, .weightless = 1};
    if (input->scene->contact_given) {
        rules.mu = law->mu;
        rules.mu_wall = law->mu_wall;
    }
    if (!(network->idle = malloc(packing->grains.count + 1)))
        return error_memory("idle grains");
    if (stability_flag(packing, &rules))
        return -1;
    size_t idle = 0;
    for (size_t k = 0; k < packing->grains.count; k++)
        idle += network->idle[k] = (packing->grains.flags[k] & GRAIN_RATTLER) != 0;
    if (2 * idle > packing->grains.count) { /* nothing is squeezed here: there is no telling two kinds apart */
        free(network->idle);
        network->idle = NULL;
    }
    return 0;
}
