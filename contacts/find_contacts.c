/* The steps of one state: grains in metres, the correction of all radii from the pile-up of overlaps, the pairs and
 * walls, who carries nothing, the contacts by probability, their motion, and what the loads could not leave standing.
 *
 * Two things need each other: the statistics of overlaps are sharp only without the grains that carry nothing, and who
 * carries nothing is told by the contacts. The network is built from all pairs first, then once more with what that
 * told. */
#include "contacts/find_contacts.h"

#include <stdlib.h>

#include "contacts/network/contact_network.h"
#include "contacts/network/near_gaps.h"
#include "contacts/radii/loaded_overlaps.h"
#include "contacts/radii/radius_offset.h"
#include "contacts/si_grains.h"
#include "contacts/network/standing.h"
#include "contacts/motion/state_motion.h"
#include "pipeline/speak/error.h"
#include "pipeline/numbers/quantiles.h"
#include "pipeline/packing/packing_check.h"
#include "pipeline/packing/structure.h"

/* Radii are corrected automatically by no more than this, px and share of the median radius. */
#define WIDEST_OFFSET_PX 2.0
#define WIDEST_OFFSET 0.05

/* What one run holds between its steps. */
struct search {
    const struct contact_input *input;
    struct contact_options options; /* with the radius correction that is used */
    struct radius_correction correction;
    size_t promoted;
    struct packing *packing;
    struct vec *reference; /* positions in the reference; NULL: this is it, or unknown */
    struct contact_network network;
};

static void search_free(struct search *search)
{
    free(search->reference);
    contact_network_free(&search->network);
}

static int check_input(const struct contact_input *input, const struct contact_options *options)
{
    for (size_t m = 0; m < input->more_count; m++)
        if (input->more_radii[m]->count != input->grains->count)
            return error_input("a file of --radii has %zu grains, this photo %zu: give files with the same rows",
                               input->more_radii[m]->count, input->grains->count);
    if (!(options->radius_scale > 0) || !(options->candidate_sigmas >= 0) || !(options->frame_error_px >= 0))
        return error_input("radius scale, candidate range and frame error must not be negative");
    if (options->radius_scale_auto && options->radius_offset_auto)
        return error_input("radius scale and offset cannot both be \"auto\", they change the overlaps alike: give one");
    return 0;
}

/* px; 0 without grains. */
static int median_radius(const struct photo_grains *grains, double *radius)
{
    double *radii = malloc((grains->count + 1) * sizeof *radii);
    size_t n = 0;
    if (!radii)
        return error_memory("radii");
    for (size_t k = 0; k < grains->count; k++)
        if (isfinite(grains->radius_px[k]))
            radii[n++] = grains->radius_px[k];
    *radius = n ? median_of(radii, n) : 0;
    free(radii);
    return 0;
}

static int is_automatic(const struct contact_options *options)
{
    return options->radius_scale_auto || options->radius_offset_auto;
}

/* Find the automatic correction of the radii from the pairs as they are, put it into the options, and start again.
 * Twice: roughly from all pairs, then, when the network is known, without the grains that only rest. */
static int correct_radii(struct search *search)
{
    struct contact_options *options = &search->options;
    double scale = search->input->scene->scale, window, loaded, radius;
    if (median_radius(search->input->grains, &radius))
        return -1;
    double reach = scale * fmin(WIDEST_OFFSET_PX, WIDEST_OFFSET * radius);
    struct overlap_choice choice = {.idle = search->network.idle,
                                    .kind = options->radius_scale_auto ? CORRECT_SCALE : CORRECT_OFFSET};
    struct grains *grains = &search->packing->grains;
    struct radius_correction correction;
    struct pairs pairs = {0};
    int status = candidates_between_grains(grains, options->candidate_sigmas, 2 * reach, &pairs, &window);
    choice.farthest = window + 2 * reach;
    if (status == 0)
        status = loaded_overlaps(search->input, grains, &loaded);
    if (status == 0)
        status = radius_correction_estimate(grains, &pairs, &choice, loaded, &correction);
    pairs_free(&pairs);
    if (status)
        return -1;
    if (search->network.idle && !correction.decided) /* the rough one stands */
        return 0;
    search->correction = correction;
    if (choice.kind == CORRECT_SCALE)
        options->radius_scale *= 1 + correction.value;
    else
        options->radius_offset_px += correction.value / scale;
    table_free(&GRAINS, grains);
    return si_grains(search->input, options, grains);
}

static int build_network(struct search *search)
{
    return contact_network_build(search->input, &search->options, search->reference, &search->network, search->packing);
}

static void forget_shapes(struct grains *grains)
{
    free(grains->shape_c);
    free(grains->shape_s);
    grains->shape_c = grains->shape_s = NULL;
}

/* Shapes that are not in equilibrium: mechanics speaks of the circles, and says nothing of the contacts of the shapes.
 */
static int back_to_shapes(struct search *search)
{
    free(search->network.idle);
    search->network.idle = NULL;
    search->network.unbalanced = 1;
    table_free(&GRAINS, &search->packing->grains);
    return si_grains(search->input, &search->options, &search->packing->grains);
}

/* The network from the radii as they are, then again with what it tells about itself. */
static int find_network(struct search *search)
{
    int automatic = is_automatic(&search->options);
    if ((automatic && correct_radii(search)) || si_reference(search->input, &search->reference))
        return -1;
    int unbalanced = search->correction.unbalanced;
    if (unbalanced)
        forget_shapes(&search->packing->grains);
    if (build_network(search) || contact_network_find_idle(search->input, &search->network, search->packing))
        return -1;
    if (automatic && search->correction.decided && search->network.idle && correct_radii(search))
        return -1;
    return (unbalanced && back_to_shapes(search)) || build_network(search) ? -1 : 0;
}

static int find_motion(struct search *search)
{
    struct packing *packing = search->packing;
    const struct packing *previous = search->input->previous;
    struct moved_state state = {.pairs = &search->network.pairs,
                                .frame = &search->network.frame,
                                .reference = search->reference,
                                .is_reference = search->input->is_reference,
                                .previous = previous,
                                .candidate_sigmas = search->options.candidate_sigmas};
    move_since_reference(&state, packing);
    frame_strain(&packing->walls, &search->network.frame.reference, packing->info.strain);
    if (!previous)
        return 0;
    if (previous->walls.count != packing->walls.count)
        return error_input("the previous state has %zu walls, this one %zu: give the state of the same series",
                           previous->walls.count, packing->walls.count);
    frame_motion(&packing->walls, &previous->walls);
    return move_since_previous(&state, packing);
}

static size_t count_rattlers(const struct grains *grains)
{
    size_t count = 0;
    for (size_t k = 0; k < grains->count; k++)
        count += (grains->flags[k] & GRAIN_RATTLER) != 0;
    return count;
}

/* Where most grains would fall, the network is not one in equilibrium (too much was lost, or nothing presses): then
 * friction is left out and any two contacts hold, as in the thesis. */
static int check_stability(struct search *search)
{
    const struct scene *scene = search->input->scene;
    struct packing *packing = search->packing;
    struct stability_rules rules = {.mu = scene->contact_given ? scene->contact.mu : NAN,
                                    .mu_wall = scene->contact_given ? scene->contact.mu_wall : NAN};
    if (stability_flag(packing, &rules))
        return -1;
    if (2 * count_rattlers(&packing->grains) > packing->grains.count)
        rules.mu = rules.mu_wall = NAN;
    return search->options.repair ? stability_repair(packing, &rules, &search->promoted)
                                  : stability_flag(packing, &rules);
}

static int build(struct search *search)
{
    const struct contact_input *input = search->input;
    search->packing->length_m = input->scene->grains.length;
    return si_grains(input, &search->options, &search->packing->grains) ||
                   (input->previous &&
                    packing_check_previous("the file of --previous", input->previous, search->packing)) ||
                   find_network(search) || find_motion(search) || check_stability(search)
               ? -1
               : 0;
}

static double resting_share(const struct contact_network *network)
{
    double bearing = (double)network->bearing.pairs, idle = (double)network->idle_pairs.pairs;
    return (bearing * network->bearing.resting + idle * network->idle_pairs.resting) / fmax(bearing + idle, 1);
}

static void summarise(const struct search *search, struct contact_summary *summary)
{
    const struct packing *packing = search->packing;
    double scale = search->input->scene->scale;
    *summary = (struct contact_summary){
        .grains = packing->grains.count,
        .promoted = search->promoted,
        .rattlers = count_rattlers(&packing->grains),
        .mean_overlap_px = pair_mean_overlap(&search->network.bearing) / scale,
        .radius_scale = search->options.radius_scale,
        .radius_offset_px = search->options.radius_offset_px,
        .s_radius_scale = search->options.radius_scale_auto ? search->correction.error : 0,
        .s_radius_offset_px = search->options.radius_offset_auto ? search->correction.error / scale : 0,
        .undecided = search->correction.why,
        .doubt = search->correction.doubt,
        .loaded_overlap_px = search->correction.loaded / scale,
        .resting_share = resting_share(&search->network),
        .histogram = search->network.histogram,
        .mechanisms = NAN,
        .indeterminacy = NAN,
        .s_overlap_px = search->network.error / scale};
    for (size_t k = 0; k < packing->grains.count; k++) {
        summary->unusable += (packing->grains.flags[k] & GRAIN_NOT_FINITE) != 0;
        summary->floating += (packing->grains.flags[k] & GRAIN_FLOATING) != 0;
    }
    for (size_t c = 0; c < packing->contacts.count; c++) {
        uint32_t flags = packing->contacts.flags[c];
        summary->candidates += (flags & CONTACT_CANDIDATE) != 0;
        summary->contacts += !(flags & CONTACT_CANDIDATE);
        summary->wall_contacts += (flags & CONTACT_WALL) && !(flags & CONTACT_CANDIDATE);
    }
}

/* Fewer grains may have been laid apart. */
#define LEAST_GRAINS 10

static int is_thin(const struct contact_summary *summary)
{
    size_t usable = summary->grains - summary->unusable;
    return usable >= LEAST_GRAINS && 2 * summary->contacts < usable;
}

/* A packing that stands has 1.5 contacts per grain and more; one that is dense has as many near pairs as grains. */
int contacts_are_few(const struct contact_summary *summary)
{
    return is_thin(summary) &&
           (summary->contacts == 0 || summary->contacts + summary->near >= summary->grains - summary->unusable);
}

/* Only where somebody will ask: a further search of neighbours. */
static int measure_gaps(const struct search *search, struct contact_summary *summary)
{
    struct near_gaps gaps;
    double scale = search->input->scene->scale;
    summary->gap_px = NAN;
    if (!is_thin(summary) && !summary->undecided)
        return 0;
    if (near_gaps_find(&search->packing->grains, &gaps))
        return -1;
    summary->near = gaps.pairs;
    summary->near_px = gaps.reach / scale;
    summary->gap_px = gaps.median / scale;
    return 0;
}

int contact_indeterminacy(const struct scene *scene, struct packing *packing, struct contact_summary *summary)
{
    double mu = scene->contact_given ? scene->contact.mu : NAN,
           mu_wall = scene->contact_given ? scene->contact.mu_wall : NAN;
    if (packing_indeterminacy(packing, mu, mu_wall, &packing->indeterminacy))
        return -1;
    summary->indeterminacy = packing->indeterminacy.h;
    summary->mechanisms = packing->indeterminacy.mechanisms;
    return 0;
}

int find_contacts(const struct contact_input *input, const struct contact_options *options, struct packing *packing,
                  struct contact_summary *summary)
{
    struct search search = {.input = input, .options = *options, .packing = packing};
    int status = check_input(input, options);
    if (status == 0)
        status = build(&search);
    if (status == 0 && summary) {
        summarise(&search, summary);
        status = measure_gaps(&search, summary);
    }
    search_free(&search);
    if (status)
        packing_free(packing);
    return status;
}
