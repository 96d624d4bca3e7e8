#include "tracker/track_grains.h"

#include <math.h>
#include <omp.h>
#include <stdlib.h>
#include <string.h>

#include "pipeline/error.h"
#include "pipeline/progress.h"
#include "tracker/consistency.h"
#include "tracker/drift.h"
#include "tracker/neighbours.h"
#include "tracker/tracks.h"

static const double degree = 3.141592653589793 / 180;
enum { SEED_STEP = 8, SPREAD_ROUNDS = 12 };

struct tracker {
    const struct photo *reference;
    const struct photo_grains *grains;
    struct tracker_options options;
    struct target *targets; /* patches first, then grains */
    size_t patch_count, count;
    long *nearest; /* among the grains */
    struct pyramid reference_pyramid;
    uint16_t saturation;
    struct search_workspace *workspaces; /* one per thread */
    int threads;
};

/* Everything of one photo. */
struct follow {
    struct tracker *tracker;
    struct target_photos photos;
    struct pyramid pyramid;
    struct motion *expected; /* where each target is expected */
    int *has_expected;
    struct outcome *outcomes;
};

/* ---- the reference ---- */

/* The grey value at which the sensor clips: the largest one, when far more pixels hold it than chance would put there.
 * 0: none. */
static uint16_t saturation_of(const struct photo *photo)
{
    size_t n = (size_t)photo->width * (size_t)photo->height, count = 0;
    uint16_t largest = 0;
    for (size_t k = 0; k < n; k++) {
        if (photo->pixels[k] > largest) {
            largest = photo->pixels[k];
            count = 0;
        }
        count += photo->pixels[k] == largest;
    }
    unsigned range = photo->bits == 8 ? 255 : 65535;
    return largest > range / 2 && count > 16 + n / 100000 ? largest : 0;
}

static struct target grain_target(const struct photo_grains *grains, size_t k, double subset)
{
    struct target target = {
        .shape = {.cx = grains->x_px[k], .cy = grains->y_px[k], .radius = subset * grains->radius_px[k]}};
    target.given = isfinite(target.shape.cx) && isfinite(target.shape.cy) && target.shape.radius > 0 &&
                   fabs(target.shape.cx) < 1e6 && fabs(target.shape.cy) < 1e6 && target.shape.radius < 1e4;
    return target;
}

static struct target rect_target(const struct rect *rect)
{
    double w = (rect->x1 - rect->x0) / 2, h = (rect->y1 - rect->y0) / 2;
    return (struct target){
        .shape = {.cx = rect->x0 + w, .cy = rect->y0 + h, .radius = hypot(w, h), .half_w = w, .half_h = h},
        .given = w > 0 && h > 0};
}

/* Rims that reach into a grain's subset, with a margin for the slopes and the point spread: they move with their own
 * grain. */
static void find_intruders(struct tracker *tracker)
{
    const double margin = 3; /* px */
    const size_t base = tracker->patch_count;
    for (size_t k = 0; k < tracker->grains->count; k++) {
        struct target *target = &tracker->targets[base + k];
        for (int i = 0; target->given && i < NEIGHBOURS && tracker->nearest[k * NEIGHBOURS + (size_t)i] >= 0; i++) {
            size_t other = (size_t)tracker->nearest[k * NEIGHBOURS + (size_t)i];
            struct shape rim = {.cx = tracker->grains->x_px[other],
                                .cy = tracker->grains->y_px[other],
                                .radius = tracker->grains->radius_px[other] + margin};
            double away = hypot(rim.cx - target->shape.cx, rim.cy - target->shape.cy);
            if (away < rim.radius + target->shape.radius)
                target->neighbours[target->neighbour_count++] = rim;
        }
    }
}

static int make_targets(struct tracker *tracker)
{
    const struct tracker_options *options = &tracker->options;
    tracker->patch_count = options->drift_count + options->marker_count;
    tracker->count = tracker->patch_count + tracker->grains->count;
    tracker->targets = calloc(tracker->count ? tracker->count : 1, sizeof *tracker->targets);
    if (!tracker->targets)
        return error_memory("the grains to follow");
    for (size_t k = 0; k < options->drift_count; k++)
        tracker->targets[k] = rect_target(&options->drift[k]);
    for (size_t k = 0; k < options->marker_count; k++)
        tracker->targets[options->drift_count + k] = rect_target(&options->markers[k].rect);
    for (size_t k = 0; k < tracker->grains->count; k++)
        tracker->targets[tracker->patch_count + k] = grain_target(tracker->grains, k, options->subset);
    tracker->nearest = neighbours_find(tracker->targets + tracker->patch_count, tracker->grains->count);
    if (!tracker->nearest)
        return -1;
    find_intruders(tracker);
    return 0;
}

struct tracker *tracker_open(const struct photo *reference, const struct photo_grains *grains,
                             const struct tracker_options *options)
{
    struct tracker *tracker = calloc(1, sizeof *tracker);
    if (!tracker) {
        error_set(EXIT_FAILED, "out of memory: tracker: use a machine with more memory");
        return NULL;
    }
    tracker->reference = reference;
    tracker->grains = grains;
    tracker->options = *options;
    tracker->saturation = saturation_of(reference);
    tracker->threads = omp_get_max_threads();
    tracker->workspaces = calloc((size_t)tracker->threads, sizeof *tracker->workspaces);
    if (!tracker->workspaces || make_targets(tracker)) {
        error_set(EXIT_FAILED, "out of memory: tracker: use a machine with more memory");
        tracker_close(tracker);
        return NULL;
    }
    return tracker;
}

void tracker_close(struct tracker *tracker)
{
    if (!tracker)
        return;
    for (size_t k = 0; tracker->targets && k < tracker->count; k++)
        subset_free(&tracker->targets[k].subset);
    for (int k = 0; tracker->workspaces && k < tracker->threads; k++)
        search_workspace_free(&tracker->workspaces[k]);
    pyramid_free(&tracker->reference_pyramid);
    free(tracker->targets);
    free(tracker->workspaces);
    free(tracker->nearest);
    free(tracker);
}

/* ---- one photo ---- */

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

/* The motion at the photo before, with its increment once more. */
static void expect(struct follow *follow, const struct photo_grains *previous)
{
    const struct tracker *tracker = follow->tracker;
    for (size_t k = 0; k < tracker->count; k++)
        follow->has_expected[k] = 1;
    if (!previous || !previous->x_seen_px || !previous->y_seen_px || !previous->angle_seen)
        return;
    for (size_t k = 0; k < tracker->grains->count; k++) {
        struct motion *motion = &follow->expected[tracker->patch_count + k];
        if (!isfinite(previous->x_seen_px[k])) {
            follow->has_expected[tracker->patch_count + k] = 0;
            continue;
        }
        *motion = (struct motion){previous->x_seen_px[k] - tracker->grains->x_px[k],
                                  previous->y_seen_px[k] - tracker->grains->y_px[k], previous->angle_seen[k]};
        if (previous->dx_px && isfinite(previous->dx_px[k])) {
            motion->u += previous->dx_px[k];
            motion->v += previous->dy_px[k];
            motion->angle += previous->dangle[k];
        }
    }
}

static void demote(struct follow *follow)
{
    const struct tracker *tracker = follow->tracker;
    consistency_demote(follow->outcomes + tracker->patch_count, tracker->grains->count);
}

static int find_all(struct follow *follow)
{
    const struct tracker *tracker = follow->tracker;
    if (for_each(follow, 0, tracker->count, from_expected))
        return -1;
    demote(follow);
    if (!open_targets(follow, 0, tracker->count))
        return 0;
    if (need_pyramids(follow) || for_each(follow, 0, tracker->patch_count, from_nothing) || spread(follow))
        return -1;
    demote(follow);
    if (!open_targets(follow, tracker->patch_count, tracker->count))
        return 0;
    if (for_each(follow, tracker->patch_count, tracker->count, seeds_from_nothing) || spread(follow))
        return -1;
    if (for_each(follow, tracker->patch_count, tracker->count, from_nothing) || spread(follow))
        return -1;
    demote(follow);
    return 0;
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

static int same_photo(const struct photo *a, const struct photo *b)
{
    return !memcmp(a->pixels, b->pixels, (size_t)a->width * (size_t)a->height * sizeof *a->pixels);
}

static void follow_free(struct follow *follow)
{
    pyramid_free(&follow->pyramid);
    free(follow->expected);
    free(follow->has_expected);
    free(follow->outcomes);
}

/* The camera's motion from the paper; fixed when the scene has none. */
static int find_camera(const struct follow *follow, struct camera *camera)
{
    const struct tracker *tracker = follow->tracker;
    const size_t count = tracker->options.drift_count;
    *camera = (struct camera)CAMERA_FIXED;
    if (!count)
        return 0;
    struct corrected *patches = calloc(count, sizeof *patches);
    int *good = calloc(count, sizeof *good);
    for (size_t k = 0; patches && good && k < count; k++) {
        patches[k] = correct_lens(tracker->options.lens, &tracker->targets[k].shape, &follow->outcomes[k].fit);
        good[k] = follow->outcomes[k].found == 2;
    }
    int status = patches && good ? 0 : error_memory("the patches of paper");
    if (!status)
        *camera = camera_fit(patches, good, count);
    free(patches);
    free(good);
    return status;
}

static int write_down(const struct follow *follow, const struct photo_grains *previous, struct tracks *tracks)
{
    const struct tracker *tracker = follow->tracker;
    const struct tracker_options *options = &tracker->options;
    struct camera camera;
    int status = find_camera(follow, &camera);
    if (!status)
        status = tracks_of_grains(tracker->grains, tracker->targets + tracker->patch_count,
                                  follow->outcomes + tracker->patch_count, options->lens, &camera, previous,
                                  &tracks->grains);
    if (!status)
        status = tracks_of_patches(options, tracker->targets, follow->outcomes, &camera, &tracks->patches);
    if (status)
        tracks_free(tracks);
    return status;
}

int tracker_follow(struct tracker *tracker, const struct photo *photo, const struct photo_grains *previous,
                   struct tracks *tracks)
{
    const struct photo *reference = tracker->reference;
    struct follow follow = {.tracker = tracker,
                            .photos = {.reference = reference, .photo = photo, .saturation = tracker->saturation}};
    if (photo->width != reference->width || photo->height != reference->height)
        return error_input("the photo has %d x %d pixels, the reference %d x %d: take photos of one camera",
                           photo->width, photo->height, reference->width, reference->height);
    if (previous && previous->count != tracker->grains->count)
        return error_input("the previous photo has %zu grains, the reference %zu: take tracks of the same reference",
                           previous->count, tracker->grains->count);
    size_t n = tracker->count ? tracker->count : 1;
    follow.expected = calloc(n, sizeof *follow.expected);
    follow.has_expected = calloc(n, sizeof *follow.has_expected);
    follow.outcomes = calloc(n, sizeof *follow.outcomes);
    int status = follow.expected && follow.has_expected && follow.outcomes ? 0 : error_memory("tracker");
    if (!status) {
        expect(&follow, previous);
        status = same_photo(photo, reference) ? for_each(&follow, 0, tracker->count, stay) : find_all(&follow);
        consistency_check(tracker->targets + tracker->patch_count, tracker->grains->radius_px, tracker->nearest,
                          follow.outcomes + tracker->patch_count, tracker->grains->count);
    }
    if (!status)
        status = write_down(&follow, previous, tracks);
    follow_free(&follow);
    return status;
}

int track_grains(const struct photo *reference, const struct photo_grains *grains, const struct photo *photo,
                 const struct photo_grains *previous, const struct tracker_options *options, struct tracks *tracks)
{
    struct tracker *tracker = tracker_open(reference, grains, options);
    int status = tracker ? tracker_follow(tracker, photo, previous, tracks) : -1;
    tracker_close(tracker);
    return status;
}
