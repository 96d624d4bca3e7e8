/* When is a match good? The correlation of a subset with a wrong place is a sum over independent specks: its standard
 * deviation is 1 / sqrt(specks) about zero. One place that was expected is good from 2.5 of these on; the best of
 * thousands that a search has tried reaches 4 by chance and is good from 4.5 on. The limits are cut to what cameras and
 * light allow: even the right place may fall to 0.6, and 0.9 is never chance.
 *
 * Two places are compared on Fisher's scale, atanh(ZNCC), where the standard deviation does not depend on the
 * correlation itself (Fisher, Metron 1 (1921) 3). */
#include "tracker/search/target.h"

#include <math.h>

static const double few_specks = 12; /* below, a place is good only when a search has seen that it is the only one */
static const double same_fit = 1e-3; /* ZNCC: a search that comes back to the same place replaces what was there */

static double clamp(double x, double low, double high)
{
    return x < low ? low : x > high ? high : x;
}

/* Standard deviation of the ZNCC of a wrong place: 1 / sqrt(independent specks). */
static double chance(const struct target *target)
{
    double specks = target->subset.speckle_count;
    return specks > 1 ? 1 / sqrt(specks) : 1;
}

double target_good_zncc(const struct target *target, int searched)
{
    return searched ? clamp(4.5 * chance(target), 0.6, 0.9) : clamp(2.5 * chance(target), 0.5, 0.9);
}

double target_lost_zncc(const struct target *target, int searched)
{
    return searched ? target_good_zncc(target, 1) : clamp(2.0 * chance(target), 0.3, 0.7);
}

int target_keep(struct target *target, const struct photo *reference, uint16_t saturation)
{
    if (target->kept || !target->given)
        return 0;
    struct subset_mask mask = {
        .saturation = saturation, .neighbours = target->neighbours, .neighbour_count = target->neighbour_count};
    if (subset_build(reference, &target->shape, &mask, &target->subset))
        return -1;
    if (target->neighbour_count && target->subset.used < 0.5) { /* a circle on top of this one: which is wrong? */
        subset_free(&target->subset);
        target->neighbour_count = 0;
        return target_keep(target, reference, saturation);
    }
    target->kept = 1;
    return 0;
}

void target_drop(struct target *target)
{
    struct subset summary = target->subset;
    summary.runs = NULL;
    summary.planes = NULL;
    summary.blur = NULL;
    subset_free(&target->subset);
    target->subset = summary;
    target->kept = 0;
}

static int fit_from(const struct target *target, const struct target_photos *photos, struct motion start,
                    struct patch *patch, struct outcome *found)
{
    const struct icgn_options options = ICGN_DEFAULT;
    *found = (struct outcome){.used = target->subset.used};
    if (!subset_usable(&target->subset))
        return 0;
    if (icgn_inside(&target->shape, &start, photos->photo))
        return icgn_fit(&target->subset, photos->photo, start, &options, patch, &found->fit);

    struct subset_mask mask = {.neighbours = target->neighbours,
                               .neighbour_count = target->neighbour_count,
                               .saturation = photos->saturation,
                               .photo = photos->photo,
                               .u = start.u,
                               .v = start.v,
                               .angle = start.angle};
    struct subset part;
    int status = subset_build(photos->reference, &target->shape, &mask, &part);
    found->masked = 1;
    found->used = part.used;
    if (!status && subset_usable(&part))
        status = icgn_fit(&part, photos->photo, start, &options, patch, &found->fit);
    subset_free(&part);
    return status;
}

/* A wrong place leaves so much that its stated errors are large: a match with such errors is not good. */
static int is_credible(const struct fit *fit)
{
    const double shift = 0.2, turn = 1.5 * M_PI / 180;
    return fit->covariance[0][0] < shift * shift && fit->covariance[1][1] < shift * shift &&
           fit->covariance[2][2] < turn * turn;
}

static void keep_better(const struct target *target, const struct outcome *found, struct outcome *outcome)
{
    if (!found->fit.converged || found->fit.zncc < target_lost_zncc(target, found->searched))
        return;
    if (outcome->found && outcome->fit.zncc >= found->fit.zncc + (found->searched ? same_fit : 0))
        return;
    *outcome = *found;
    int sure = found->searched || target->subset.speckle_count >= few_specks;
    outcome->found =
        sure && is_credible(&found->fit) && found->fit.zncc >= target_good_zncc(target, found->searched) ? 2 : 1;
}

int target_attempt(const struct target *target, const struct target_photos *photos, struct motion start,
                   struct patch *patch, struct outcome *outcome)
{
    struct outcome found;
    if (fit_from(target, photos, start, patch, &found))
        return -1;
    keep_better(target, &found, outcome);
    return 0;
}

/* Are these two motions of the subset the same place, to a speck? */
static int same_place(const struct target *target, const struct motion *a, const struct motion *b)
{
    double away = hypot(a->u - b->u, a->v - b->v) + motion_turn(a, b) * target->shape.radius / 2;
    return away < fmax(1, target->subset.speckle);
}

/* Two places fit alike: their correlations, on Fisher's scale, differ by less than a wrong place reaches by chance. */
static int is_ambiguous(const struct target *target, const struct outcome *outcome)
{
    const double most = 1 - 1e-9;
    return outcome->rival > 0 &&
           atanh(fmin(outcome->fit.zncc, most)) - atanh(fmin(outcome->rival, most)) < fmax(0.25, 3 * chance(target));
}

int target_search(const struct target *target, const struct target_photos *photos, struct motion around,
                  const struct search_reach *reach, struct search_workspace *workspace, struct outcome *outcome)
{
    struct search_place places[SEARCH_CANDIDATES];
    struct outcome fits[SEARCH_CANDIDATES], best = {0};
    int count;
    if (!subset_usable(&target->subset))
        return 0;
    if (search_places(photos->reference_pyramid, photos->photo_pyramid, &target->shape, around, reach, workspace,
                      places, &count))
        return -1;
    for (int k = 0; k < count; k++) {
        if (fit_from(target, photos, places[k].motion, &workspace->patch, &fits[k]))
            return -1;
        fits[k].searched = 1;
        if (fits[k].fit.converged && fits[k].fit.zncc > best.fit.zncc)
            best = fits[k];
    }
    for (int k = 0; k < count; k++)
        if (fits[k].fit.converged && !same_place(target, &fits[k].fit.motion, &best.fit.motion))
            best.rival = fmax(best.rival, fits[k].fit.zncc);
    best.ambiguous = is_ambiguous(target, &best);
    keep_better(target, &best, outcome);
    return 0;
}
