#include "contacts/find_contacts.h"

#include <stdlib.h>

#include "contacts/candidates.h"
#include "contacts/frame.h"
#include "contacts/motion.h"
#include "contacts/radius_offset.h"
#include "contacts/si_grains.h"
#include "contacts/stability.h"
#include "pipeline/error.h"

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
    struct pairs pairs;
    struct pair_statistics statistics;
    struct frame frame;
};

static void search_free(struct search *search)
{
    free(search->reference);
    pairs_free(&search->pairs);
    frame_free(&search->frame);
}

static int check_input(const struct contact_input *input, const struct contact_options *options)
{
    const struct packing *previous = input->previous;
    for (size_t m = 0; m < input->more_count; m++)
        if (input->more_radii[m]->count != input->grains->count)
            return error_input("a file of --radii has %zu grains, this photo %zu: give files with the same rows",
                               input->more_radii[m]->count, input->grains->count);
    if (previous && previous->grains.count != input->grains->count)
        return error_input("the previous state has %zu grains, this one %zu: give the state of the same series",
                           previous->grains.count, input->grains->count);
    if (!(options->radius_scale > 0) || !(options->candidate_sigmas >= 0) || !(options->frame_error_px >= 0))
        return error_input("radius scale, candidate range and frame error must not be negative");
    if (options->radius_scale_auto && options->radius_offset_auto)
        return error_input("radius scale and offset cannot both be \"auto\", they change the overlaps alike: give one");
    return 0;
}

/* Of the pairs that seem to rest at zero, the share that is squeezed very lightly; from simulated packings
 * (bench_contacts --only reliability), where weak contacts are a little more frequent than the density says. */
#define LIGHTLY_SQUEEZED 0.2

/* That the true overlap is positive. Under its weight, a grain that rests touches. */
static double probability_of(const struct search *search, const struct pair *pair)
{
    struct vec gravity = search->input->scene->gravity;
    struct pair_odds odds = pair_odds(&search->statistics, pair->overlap, pair->s_overlap);
    double squeezed = gravity.x != 0 || gravity.y != 0 ? 1 : LIGHTLY_SQUEEZED;
    return odds.touching + squeezed * odds.resting;
}

/* The largest gap that the user calls a contact, m; 0 without a tolerance. */
static double tolerance_of(const struct search *search)
{
    double tolerance = search->options.tolerance_px * search->input->scene->scale;
    return tolerance > 0 ? tolerance : 0;
}

/* A contact touches or rests rather than being apart: what only rests carries nothing and costs nothing, a lost
 * contact costs much (thesis 3.4.2). */
static int is_contact(const struct search *search, const struct pair *pair)
{
    double tolerance = search->options.tolerance_px;
    if (isfinite(tolerance))
        return pair->overlap > -tolerance * search->input->scene->scale;
    return pair_odds(&search->statistics, pair->overlap, pair->s_overlap).apart < 0.5;
}

static size_t keep_likely(struct search *search)
{
    size_t kept = 0;
    for (size_t p = 0; p < search->pairs.count; p++) {
        struct pair pair = search->pairs.pair[p];
        if (is_contact(search, &pair) || pair.overlap > -search->options.candidate_sigmas * pair.s_overlap)
            search->pairs.pair[kept++] = pair;
    }
    return search->pairs.count = kept;
}

static int fill_contacts(struct search *search)
{
    struct contacts *contacts = &search->packing->contacts;
    size_t grains = search->packing->grains.count;
    if (table_alloc(&CONTACTS, contacts, keep_likely(search), NULL))
        return -1;
    for (size_t c = 0; c < contacts->count; c++) {
        const struct pair *pair = &search->pairs.pair[c];
        contacts->i[c] = pair->i;
        contacts->j[c] = pair->j;
        contacts->nx[c] = pair->n.x;
        contacts->ny[c] = pair->n.y;
        contacts->x[c] = pair->at.x;
        contacts->y[c] = pair->at.y;
        contacts->overlap[c] = pair->overlap;
        contacts->s_overlap[c] = pair->s_overlap;
        contacts->probability[c] = probability_of(search, pair);
        contacts->flags[c] = (size_t)pair->j >= grains ? CONTACT_WALL : 0;
        if (!is_contact(search, pair))
            contacts->flags[c] |= CONTACT_CANDIDATE;
    }
    return 0;
}

/* un, ut: motion since the reference, for pairs that may have touched there. */
static void move_since_reference(struct search *search)
{
    struct contacts *contacts = &search->packing->contacts;
    struct state_before before = {.at = search->reference, .walls = &search->frame.reference};
    for (size_t w = 0; w < 8; w++)
        before.s_wall[w] = search->frame.s_motion[w];
    for (size_t c = 0; c < contacts->count; c++) {
        const struct pair *pair = &search->pairs.pair[c];
        if (search->input->is_reference) {
            contacts->un[c] = contacts->ut[c] = contacts->s_un[c] = contacts->s_ut[c] = 0;
        } else if (search->reference) {
            struct contact_motion motion =
                contact_motion(&search->packing->grains, &search->packing->walls, pair, &before);
            if (!(motion.overlap_before > -search->options.candidate_sigmas * pair->s_overlap))
                continue;
            contacts->un[c] = motion.un;
            contacts->ut[c] = motion.ut;
            contacts->s_un[c] = motion.s_un;
            contacts->s_ut[c] = motion.s_ut;
        }
    }
}

/* Row of pair (i, j) in the previous contacts, whose rows of grain i begin at start[i]; -1: none. */
static long find_before(const struct contacts *before, const size_t *order, const size_t *start, int64_t i, int64_t j)
{
    for (size_t e = start[i]; e < start[i + 1]; e++)
        if (before->j[order[e]] == j)
            return (long)order[e];
    return -1;
}

/* dun, dut of one contact; a pair that was not in contact before is new. */
static void move_since_previous(struct search *search, size_t c, long row, const struct state_before *before)
{
    struct contacts *contacts = &search->packing->contacts;
    const struct contacts *old = &search->input->previous->contacts;
    int candidate = (contacts->flags[c] & CONTACT_CANDIDATE) != 0;
    if (row < 0 || (!candidate && (old->flags[row] & CONTACT_CANDIDATE))) {
        contacts->flags[c] |= CONTACT_NEW;
        return;
    }
    if (candidate && !(old->flags[row] & CONTACT_CANDIDATE))
        contacts->flags[c] |= CONTACT_OPENED;
    struct contact_motion motion =
        contact_motion(&search->packing->grains, &search->packing->walls, &search->pairs.pair[c], before);
    contacts->dun[c] = motion.un;
    contacts->dut[c] = motion.ut;
    contacts->s_dun[c] = motion.s_un;
    contacts->s_dut[c] = motion.s_ut;
}

static int compare_with_previous(struct search *search)
{
    const struct packing *previous = search->input->previous;
    const struct contacts *old = &previous->contacts;
    size_t grains = previous->grains.count;
    size_t *start = calloc(grains + 2, sizeof *start), *order = malloc((old->count + 1) * sizeof *order);
    struct vec *at = malloc((grains + 1) * sizeof *at);
    if (!start || !order || !at) {
        free(start);
        free(order);
        free(at);
        return error_memory("previous state");
    }
    for (size_t c = 0; c < old->count; c++)
        start[old->i[c] + 2]++;
    for (size_t k = 2; k < grains + 2; k++)
        start[k] += start[k - 1];
    for (size_t c = 0; c < old->count; c++)
        order[start[old->i[c] + 1]++] = c;
    for (size_t k = 0; k < grains; k++)
        at[k] = vec(previous->grains.x[k], previous->grains.y[k]);
    struct state_before before = {.at = at,
                                  .angle = previous->grains.angle,
                                  .walls = &previous->walls,
                                  .s_x = previous->grains.s_x,
                                  .s_y = previous->grains.s_y,
                                  .s_angle = previous->grains.s_angle};
    for (size_t w = 0; w < 8; w++)
        before.s_wall[w] = M_SQRT2 * search->frame.s_motion[w];
    for (size_t c = 0; c < search->packing->contacts.count; c++) {
        const struct pair *pair = &search->pairs.pair[c];
        move_since_previous(search, c, find_before(old, order, start, pair->i, pair->j), &before);
    }
    free(start);
    free(order);
    free(at);
    return 0;
}

static int by_value(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static double median_radius(const struct photo_grains *grains)
{
    double *radii = malloc((grains->count + 1) * sizeof *radii), value = 0;
    size_t n = 0;
    for (size_t k = 0; radii && k < grains->count; k++)
        if (isfinite(grains->radius_px[k]))
            radii[n++] = grains->radius_px[k];
    if (n) {
        qsort(radii, n, sizeof *radii, by_value);
        value = radii[n / 2];
    }
    free(radii);
    return value;
}

/* Find the automatic correction of the radii from the pairs as they are, put it into the options, and start again. */
static int correct_radii(struct search *search)
{
    struct contact_options *options = &search->options;
    double scale = search->input->scene->scale;
    double reach = scale * fmin(WIDEST_OFFSET_PX, WIDEST_OFFSET * median_radius(search->input->grains));
    enum correction_kind kind = options->radius_scale_auto ? CORRECT_SCALE : CORRECT_OFFSET;
    struct grains *grains = &search->packing->grains;
    if (!options->radius_scale_auto && !options->radius_offset_auto)
        return 0;
    int status =
        candidates_between_grains(grains, options->candidate_sigmas, 2 * reach, &search->pairs, &search->statistics);
    if (status == 0)
        status = radius_correction_estimate(grains, &search->pairs, kind, &search->correction);
    pairs_free(&search->pairs);
    if (status)
        return -1;
    if (kind == CORRECT_SCALE)
        options->radius_scale *= 1 + search->correction.value;
    else
        options->radius_offset_px += search->correction.value / scale;
    table_free(&GRAINS, grains);
    return si_grains(search->input, options, grains);
}

static int build(struct search *search)
{
    struct packing *packing = search->packing;
    struct frame_request request = {.scene = search->input->scene,
                                    .lens = search->input->lens,
                                    .grains = &packing->grains,
                                    .patches = search->input->patches,
                                    .statistics = &search->statistics,
                                    .frame_error_px = search->options.frame_error_px};
    if (si_grains(search->input, &search->options, &packing->grains) || correct_radii(search) ||
        si_reference(search->input, &search->reference) ||
        candidates_between_grains(&packing->grains, search->options.candidate_sigmas, tolerance_of(search),
                                  &search->pairs, &search->statistics))
        return -1;
    request.reference = search->reference;
    if (frame_walls(&request, &search->frame) || table_copy(&WALLS, &packing->walls, &search->frame.now) ||
        candidates_with_walls(&packing->grains, &packing->walls, fmax(search->statistics.window, tolerance_of(search)),
                              &search->pairs) ||
        fill_contacts(search))
        return -1;
    move_since_reference(search);
    if (search->input->previous) {
        if (search->input->previous->walls.count != packing->walls.count)
            return error_input("the previous state has %zu walls, this one %zu: give the state of the same series",
                               search->input->previous->walls.count, packing->walls.count);
        frame_motion(&packing->walls, &search->input->previous->walls);
        if (compare_with_previous(search))
            return -1;
    }
    frame_strain(&packing->walls, &search->frame.reference, packing->info.strain);
    packing->length_m = search->input->scene->grains.length;
    return search->options.repair ? stability_repair(packing, &search->promoted) : stability_flag(packing);
}

static double median_error(const struct pairs *pairs)
{
    double *s = malloc((pairs->count + 1) * sizeof *s), value = 0;
    for (size_t p = 0; s && p < pairs->count; p++)
        s[p] = pairs->pair[p].s_overlap;
    if (s && pairs->count) {
        qsort(s, pairs->count, sizeof *s, by_value);
        value = s[pairs->count / 2];
    }
    free(s);
    return value;
}

static void summarise(const struct search *search, struct contact_summary *summary)
{
    const struct packing *packing = search->packing;
    double scale = search->input->scene->scale;
    *summary = (struct contact_summary){
        .grains = packing->grains.count,
        .promoted = search->promoted,
        .mean_overlap_px = pair_mean_overlap(&search->statistics) / scale,
        .radius_scale = search->options.radius_scale,
        .radius_offset_px = search->options.radius_offset_px,
        .s_radius_scale = search->options.radius_scale_auto ? search->correction.error : 0,
        .s_radius_offset_px = search->options.radius_offset_auto ? search->correction.error / scale : 0,
        .undecided = search->correction.why,
        .resting_share = search->statistics.resting,
        .s_overlap_px = median_error(&search->pairs) / scale};
    for (size_t k = 0; k < packing->grains.count; k++) {
        summary->unusable += (packing->grains.flags[k] & GRAIN_NOT_FINITE) != 0;
        summary->rattlers += (packing->grains.flags[k] & GRAIN_RATTLER) != 0;
        summary->floating += (packing->grains.flags[k] & GRAIN_FLOATING) != 0;
    }
    for (size_t c = 0; c < packing->contacts.count; c++) {
        uint32_t flags = packing->contacts.flags[c];
        summary->candidates += (flags & CONTACT_CANDIDATE) != 0;
        summary->contacts += !(flags & CONTACT_CANDIDATE);
        summary->wall_contacts += (flags & CONTACT_WALL) && !(flags & CONTACT_CANDIDATE);
    }
}

int find_contacts(const struct contact_input *input, const struct contact_options *options, struct packing *packing,
                  struct contact_summary *summary)
{
    struct search search = {.input = input, .options = *options, .packing = packing};
    int status = check_input(input, options);
    if (status == 0)
        status = build(&search);
    if (status == 0 && summary)
        summarise(&search, summary);
    search_free(&search);
    if (status)
        packing_free(packing);
    return status;
}
