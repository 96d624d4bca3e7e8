/* One photo: where targets are expected, the rounds that find them, the camera's motion, and the tables.
 *
 * A grain is expected to move once more as it moved up to the photo before, unless a number is
 * missing. Expectations only say where to look first; the match is always with the reference, so that its error does
 * not grow along the series. */
#include "tracker/follow/track_grains.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "pipeline/speak/error.h"
#include "tracker/search/consistency.h"
#include "tracker/follow/drift.h"
#include "tracker/follow/follow.h"
#include "tracker/follow/fill_tracks.h"

/* Can a subset be there? The limit is that of the reference's grains (reference.c); a turn beyond it has no digits. */
static int within_reach(const struct target *target, const struct motion *motion)
{
    const double far = 1e6; /* px; rad */
    return fabs(target->shape.cx + motion->u) < far && fabs(target->shape.cy + motion->v) < far &&
           fabs(motion->angle) < far; /* NaN is not */
}

/* The motion of grain k at the photo before, with its increment once more where that is known; 0: not known. */
static int motion_before(const struct photo_grains *previous, const struct target *target, size_t k,
                         struct motion *motion)
{
    *motion = (struct motion){previous->x_seen_px[k] - target->shape.cx, previous->y_seen_px[k] - target->shape.cy,
                              previous->angle_seen[k]};
    if (!target->given || !within_reach(target, motion))
        return 0;
    if (previous->dx_px && previous->dy_px && previous->dangle) {
        struct motion next = {motion->u + previous->dx_px[k], motion->v + previous->dy_px[k],
                              motion->angle + previous->dangle[k]};
        if (within_reach(target, &next))
            *motion = next;
    }
    return 1;
}

/* Where every target is looked for first: patches and, without a photo before, grains where they are in the
 * reference. */
static void expect(struct follow *follow, const struct photo_grains *previous)
{
    const struct tracker *tracker = follow->tracker;
    for (size_t k = 0; k < tracker->count; k++)
        follow->has_expected[k] = 1;
    if (!previous || !previous->x_seen_px || !previous->y_seen_px || !previous->angle_seen)
        return;
    for (size_t k = 0; k < tracker->grains->count; k++) {
        size_t at = tracker->patch_count + k;
        struct motion motion;
        follow->has_expected[at] = motion_before(previous, &tracker->targets[at], k, &motion);
        if (follow->has_expected[at])
            follow->expected[at] = motion;
    }
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
    const size_t first = tracker->patch_count > tracker->first_quarter ? tracker->first_quarter : 0;
    const size_t count = first ? QUARTERS : tracker->options.drift_count;
    *camera = (struct camera)CAMERA_FIXED;
    if (!count)
        return 0;
    struct corrected *patches = calloc(count, sizeof *patches);
    int *good = calloc(count, sizeof *good);
    for (size_t k = 0; patches && good && k < count; k++) {
        patches[k] =
            correct_lens(tracker->options.lens, &tracker->targets[first + k].shape, &follow->outcomes[first + k].fit);
        good[k] = follow->outcomes[first + k].found == 2;
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
        status = same_photo(photo, reference) ? rounds_stay(&follow) : rounds_find(&follow);
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
