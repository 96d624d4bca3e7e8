/* How the targets of one photo are found, from the cheap to the dear:
 *
 *     1. each from where it is expected (the photo before, or the reference): most are there;
 *     2. what is left, outwards from the good ones: a grain goes where the median of its neighbours goes,
 *        and is searched nearby for its own angle; those that are found carry the next round;
 *     3. every eighth grain that is left by a blind search, then outwards from these again;
 *     4. the rest by blind search, one by one.
 *
 * A round reads only what the rounds before have found and each target writes its own row: results do not depend on the
 * number of threads. After each step, matches with unusual noise are doubted (consistency.h) and looked for again. */
#include <math.h>
#include <omp.h>
#include <stdlib.h>

#include "pipeline/speak/error.h"
#include "pipeline/speak/progress.h"
#include "tracker/search/consistency.h"
#include "tracker/follow/follow.h"
#include "tracker/search/neighbours.h"

static const double degree = M_PI / 180;
enum { SEED_STEP = 8, SPREAD_ROUNDS = 12 };

typedef int step(struct follow *follow, size_t k, struct search_workspace *workspace);

/* The step for every target from `first` to `last` that is still not good, in parallel; each touches its own row. */
static int for_each(struct follow *follow, size_t first, size_t last, step *step)
{
    struct tracker *tracker = follow->tracker;
    struct error_shared error = ERROR_SHARED_NONE;
    struct progress progress;
    progress_begin(&progress, "tracking", last - first);
#pragma omp parallel for schedule(dynamic, 4) num_threads(tracker->threads)
    for (size_t k = first; k < last; k++) {
        struct target *target = &tracker->targets[k];
        if (follow->outcomes[k].found < 2 && target->given) {
            if (target_keep(target, tracker->reference, tracker->saturation) ||
                step(follow, k, &tracker->workspaces[omp_get_thread_num()]))
                error_share(&error, (long)k);
            if (!tracker->options.keep)
                target_drop(target);
        }
        progress_step(&progress);
    }
    progress_end(&progress);
    return error_collect(&error);
}

static int from_expected(struct follow *follow, size_t k, struct search_workspace *workspace)
{
    if (!follow->has_expected[k])
        return 0;
    return target_attempt(&follow->tracker->targets[k], &follow->photos, follow->expected[k], &workspace->patch,
                          &follow->outcomes[k]);
}

/* Around what the neighbours say: first their motion, then a small search for the grain's own angle. */
static int from_neighbours(struct follow *follow, size_t k, struct search_workspace *workspace)
{
    const struct search_reach reach = {8, follow->tracker->options.search_deg * degree};
    if (from_expected(follow, k, workspace))
        return -1;
    if (!follow->has_expected[k] || follow->outcomes[k].found == 2)
        return 0;
    return target_search(&follow->tracker->targets[k], &follow->photos, follow->expected[k], &reach, workspace,
                         &follow->outcomes[k]);
}

static int from_nothing(struct follow *follow, size_t k, struct search_workspace *workspace)
{
    const struct tracker_options *options = &follow->tracker->options;
    const struct search_reach reach = {options->search_px, options->search_deg * degree};
    return target_search(&follow->tracker->targets[k], &follow->photos, follow->expected[k], &reach, workspace,
                         &follow->outcomes[k]);
}

static int seeds_from_nothing(struct follow *follow, size_t k, struct search_workspace *workspace)
{
    return k % SEED_STEP ? 0 : from_nothing(follow, k, workspace);
}

/* Rounds outwards from the good grains: each round uses what the rounds before found, so the order of threads does not
 * matter. */
static int spread(struct follow *follow)
{
    const struct tracker *tracker = follow->tracker;
    const size_t base = tracker->patch_count;
    char *asked = calloc(tracker->count + 1, 1);
    if (!asked)
        return error_memory("tracker");
    int status = 0;
    for (int round = 0; round < SPREAD_ROUNDS && !status; round++) {
        size_t open = 0;
        for (size_t k = base; k < tracker->count; k++) {
            follow->has_expected[k] = 0;
            if (follow->outcomes[k].found == 2 || asked[k])
                continue;
            int voices = neighbours_motion(tracker->nearest + (k - base) * NEIGHBOURS, follow->outcomes + base,
                                           &follow->expected[k]);
            follow->has_expected[k] = voices > 0;
            asked[k] = voices > 0;
            open += voices > 0;
        }
        if (!open)
            break;
        status = for_each(follow, base, tracker->count, from_neighbours);
    }
    free(asked);
    return status;
}

static size_t open_targets(const struct follow *follow, size_t first, size_t last)
{
    size_t open = 0;
    for (size_t k = first; k < last; k++)
        open += follow->outcomes[k].found < 2 && follow->tracker->targets[k].given;
    return open;
}

static int need_pyramids(struct follow *follow)
{
    struct tracker *tracker = follow->tracker;
    if (!tracker->reference_pyramid.count && pyramid_build(tracker->reference, &tracker->reference_pyramid))
        return -1;
    if (!follow->pyramid.count && pyramid_build(follow->photos.photo, &follow->pyramid))
        return -1;
    follow->photos.reference_pyramid = &tracker->reference_pyramid;
    follow->photos.photo_pyramid = &follow->pyramid;
    return 0;
}

static int demote(struct follow *follow)
{
    const struct tracker *tracker = follow->tracker;
    return consistency_demote(follow->outcomes + tracker->patch_count, tracker->grains->count);
}

/* Seeds, what grows from them, then every grain on its own. */
static int search_all(struct follow *follow)
{
    const struct tracker *tracker = follow->tracker;
    if (for_each(follow, tracker->patch_count, tracker->count, seeds_from_nothing) || spread(follow))
        return -1;
    return for_each(follow, tracker->patch_count, tracker->count, from_nothing) || spread(follow) || demote(follow) ? -1
                                                                                                                    : 0;
}

int rounds_find(struct follow *follow)
{
    const struct tracker *tracker = follow->tracker;
    if (for_each(follow, 0, tracker->count, from_expected) || demote(follow))
        return -1;
    if (!open_targets(follow, 0, tracker->count))
        return 0;
    if (need_pyramids(follow) || for_each(follow, 0, tracker->patch_count, from_nothing) || spread(follow) ||
        demote(follow))
        return -1;
    size_t open = open_targets(follow, tracker->patch_count, tracker->count);
    if (open && search_all(follow))
        return -1;
    /* What was taken for good before the photo's usual noise was known is looked for again. */
    size_t left = open_targets(follow, tracker->patch_count, tracker->count);
    return open && left && left != open ? search_all(follow) : 0;
}

/* The reference photo in itself: no motion, exactly. */
static int stay(struct follow *follow, size_t k, struct search_workspace *workspace)
{
    (void)workspace;
    if (subset_usable(&follow->tracker->targets[k].subset))
        follow->outcomes[k] = (struct outcome){
            .found = 2, .used = follow->tracker->targets[k].subset.used, .fit = {.zncc = 1, .gain = 1, .converged = 1}};
    return 0;
}

int rounds_stay(struct follow *follow)
{
    return for_each(follow, 0, follow->tracker->count, stay);
}
