/* The whole way of one photo: zone and grey levels (look/), rims captured at coarse pixels (capture/), corrections by
 * hand, rims measured to the noise (rims/), the table and its flags, and the frame that the grains lean against.
 *
 * Everything that could be a threshold is relative: to the contrast between grain and void, to the blur, to the noise
 * of this photo. A photo with another exposure, focus or resolution gives the same circles. */
#include "findgrains/find_grains.h"

#include "findgrains/capture/detect.h"
#include "findgrains/rims/measure.h"
#include "findgrains/rims/rim_looks.h"
#include "findgrains/rims/rims_table.h"
#include "pipeline/speak/error.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Of the noise, between grains and voids: noise alone, cut in two halves, gives 1.35. */
#define LEAST_CONTRAST 2.0
#define KNOWN_SPREAD 1.0 /* px: how far a known grain may be from where it is said to be */
#define RANGE_SIGMAS 3.0 /* standard errors by which a radius may lie beyond the range that was given */

/* Mean over the measured rims, grey levels; NaN without one. */
static double mean_noise(const struct rims *rims)
{
    double sum = 0, count = 0;
    for (size_t k = 0; k < rims->count; k++)
        if (rims->items[k].support > 0) {
            sum += rims->items[k].noise;
            count += 1;
        }
    return count > 0 ? sum / count : NAN;
}

/* Always -1: a photo without any grain is an error, since no later stage could say more. */
static int no_grain(const char *why)
{
    return error_input("no grain found: %s: check the photo, grains.radius_px and frame.corners_px of the scene", why);
}

/* Zone and grey levels; an error when the photo is of one grey. */
static int look_at(const struct photo *photo, const struct find_options *options, struct find_notes *notes)
{
    *notes = (struct find_notes){0};
    if (zone_make(photo->width, photo->height, options->has_frame ? options->corners_px : NULL,
                  options->corner_radius_px, &notes->zone))
        return -1;
    notes->zone.bend = options->frame_bend_px;
    if (threshold_find(photo, &notes->zone, &notes->levels))
        return -1;
    double contrast = notes->levels.grain_level - notes->levels.void_level;
    if (!(contrast > 0))
        return no_grain("the photo has one grey level only");
    return contrast > LEAST_CONTRAST * notes->levels.noise ? 0 : no_grain("the photo shows noise only");
}

static void note(const struct rims_state *state, const struct rims *rims, struct find_notes *notes)
{
    notes->blur_px = state->blur;
    notes->noise = mean_noise(rims);
    notes->texture = state->texture;
    notes->window_px = state->window;
    notes->correlation = state->correlation;
    notes->ellipses = state->ellipse;
}

/* Flags that need the photo. */
static void look_at_rims(const struct photo *photo, const struct find_notes *notes, struct photo_grains *grains)
{
#pragma omp parallel for schedule(dynamic, 16)
    for (size_t k = 0; k < grains->count; k++) {
        struct rim rim = {.x = grains->x_px[k], .y = grains->y_px[k], .radius = grains->radius_px[k]};
        if (grains->shape_c) {
            rim.c2 = grains->shape_c[k];
            rim.s2 = -grains->shape_s[k];
        }
        if (!rim_is_possible(photo, &rim))
            continue;
        if (rim_shows_flank(photo, &rim, &notes->levels, notes->blur_px))
            grains->flags[k] |= GRAIN_FLANK;
        if (rim_is_saturated(photo, &rim, notes->blur_px))
            grains->flags[k] |= GRAIN_SATURATED;
    }
}

/* Measure the candidates and put them into the table. */
static int measure(const struct photo *photo, const struct find_options *options, const struct candidates *found,
                   int keep_all, struct photo_grains *grains, struct find_notes *notes)
{
    struct rims rims = {0};
    struct rims_state state = rims_first_guess(&notes->levels);
    int status = -1;
    if (!rims_make(found, &rims) && !measure_rims(photo, &notes->zone, options->shape, keep_all, &state, &rims))
        status = measure_count(&rims) || keep_all ? 0 : no_grain("no bright disc with an edge around it");
    if (!status) {
        note(&state, &rims, notes);
        status = rims_table(&notes->zone, &state, &rims, keep_all, grains);
    }
    if (!status)
        look_at_rims(photo, notes, grains);
    rims_free(&rims);
    return status;
}

/* Without a frame from the scene: that which the grains lean against, if there is one. */
static int look_for_frame(const struct photo *photo, const struct find_options *options, struct photo_grains *grains,
                          struct find_notes *notes)
{
    if (options->has_frame)
        return 0;
    if (find_frame(grains, &notes->frame))
        return -1;
    if (!notes->frame.found)
        return 0;
    if (zone_make(photo->width, photo->height, notes->frame.corners, notes->frame.corner_radius, &notes->zone))
        return -1;
    find_frame_flag(&notes->zone, grains);
    return 0;
}

/* Radii beyond the range that was asked for by more than their errors: the search ends there, a fit need not. What was
 * added by hand was asked for. */
static void flag_outside_range(const struct find_options *options, struct photo_grains *grains)
{
    for (size_t k = 0; k < grains->count; k++) {
        double radius = grains->radius_px[k], margin = RANGE_SIGMAS * column_or_zero(grains->s_radius, k);
        if (!(grains->flags[k] & GRAIN_BY_HAND) &&
            (radius + margin < options->radius_min_px || radius - margin > options->radius_max_px))
            grains->flags[k] |= GRAIN_OUTSIDE_RANGE;
    }
}

/* A circle larger than the photo, or far from it, would stand over every grain. */
static int check_added(const struct photo *photo, const struct candidates *found)
{
    for (size_t k = 0; k < found->count; k++) {
        const struct rim *rim = &found->items[k].rim;
        if (found->items[k].by_hand && !rim_is_possible(photo, rim))
            return error_input("a circle of %g px at (%g, %g) is no grain of a photo of %d x %d px: correct the list "
                               "of grains to add",
                               rim->radius, rim->x, rim->y, photo->width, photo->height);
    }
    return 0;
}

int find_grains(const struct photo *photo, const struct find_options *options, struct photo_grains *grains,
                struct find_notes *notes)
{
    struct find_notes own;
    struct candidates found = {0};
    notes = notes ? notes : &own;
    if (look_at(photo, options, notes))
        return -1;
    double range[2] = {options->radius_min_px, options->radius_max_px};
    int status = detect_grains(photo, &notes->zone, &notes->levels, range, &found, &notes->candidates);
    notes->radius_min_px = range[0];
    notes->radius_max_px = range[1];
    notes->captured = found.count;
    if (!status)
        status = corrections_apply(options->corrections, &found) || check_added(photo, &found) ? -1 : 0;
    if (!status)
        status = measure(photo, options, &found, 0, grains, notes);
    if (!status)
        flag_outside_range(options, grains);
    if (!status)
        status = look_for_frame(photo, options, grains, notes);
    candidates_free(&found);
    return status;
}

/* A number that no photo can have is as good as none: the grain is lost, and flagged. */
static double possible(double px)
{
    return fabs(px) < 1e6 ? px : NAN;
}

int find_known_grains(const struct photo *photo, const struct find_options *options, const struct photo_grains *known,
                      struct photo_grains *grains, struct find_notes *notes)
{
    struct find_notes own;
    struct candidates list = {0};
    int status = 0;
    notes = notes ? notes : &own;
    if (look_at(photo, options, notes))
        return -1;
    /* The frame may have moved since the scene was written: known grains need it no more. */
    if (zone_make(photo->width, photo->height, NULL, 0, &notes->zone))
        return -1;
    const double *x = known->x_seen_px ? known->x_seen_px : known->x_px;
    const double *y = known->y_seen_px ? known->y_seen_px : known->y_px;
    for (size_t k = 0; k < known->count && !status; k++) {
        const struct rim rim = {.x = possible(x[k]), .y = possible(y[k]), .radius = possible(known->radius_px[k])};
        struct candidate item = {.rim = rim, .spread = KNOWN_SPREAD};
        item.captured = item.rim;
        status = candidates_add(&list, &item);
    }
    if (!status)
        status = measure(photo, options, &list, 1, grains, notes);
    candidates_free(&list);
    return status;
}

size_t find_count_flagged(const struct photo_grains *grains)
{
    size_t count = 0;
    for (size_t k = 0; k < grains->count; k++)
        count += (grains->flags[k] & GRAIN_DISTRUST) != 0;
    return count;
}
