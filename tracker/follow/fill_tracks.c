/* From matches to columns, in this order: what is seen, the lens undone (correct.h), the camera's motion undone
 * (drift.h). Variances go the same way and the camera's is added; errors of the reference position, which all photos
 * share, stay in columns of their own (s_x_ref, s_y_ref). */
#include "tracker/follow/fill_tracks.h"

#include <math.h>
#include <stdio.h>

static const double too_saturated = 0.2; /* share of the subset */
static const double cut_subset = 0.97;   /* below this share of its pixels a subset counts as masked */
static const double half_subset = 0.5;   /* below this share of its pixels a grain is not in view */

/* Are errors of half a pixel or half a degree within so many standard errors? */
static int is_vague(const struct fit *fit, double sigmas)
{
    const double shift = 0.5 / sigmas, turn = 0.5 / sigmas * M_PI / 180;
    return fit->covariance[0][0] > shift * shift || fit->covariance[1][1] > shift * shift ||
           fit->covariance[2][2] > turn * turn;
}

static uint32_t flags_of(const struct target *target, const struct outcome *outcome)
{
    const struct subset *subset = &target->subset;
    uint32_t flags = 0;
    if (!target->given)
        return GRAIN_NOT_FINITE | GRAIN_LOST;
    if (subset->used < cut_subset || (outcome->found && outcome->used < cut_subset))
        flags |= GRAIN_MASKED;
    if ((double)subset->saturated > too_saturated * (double)(subset->count + subset->saturated))
        flags |= GRAIN_SATURATED;
    if (!subset_usable(subset))
        return flags | GRAIN_LOST | (subset->used < half_subset ? GRAIN_OUT_OF_VIEW : GRAIN_NO_CONTRAST);
    if (!outcome->found)
        return flags | GRAIN_LOST;
    if (outcome->used < half_subset)
        flags |= GRAIN_OUT_OF_VIEW;
    if (is_vague(&outcome->fit, 2))
        flags |= GRAIN_NO_CONTRAST;
    if (is_vague(&outcome->fit, 4))
        flags |= GRAIN_VAGUE;
    if (outcome->found == 1)
        flags |= GRAIN_LOW_ZNCC;
    if (outcome->contradicted || outcome->ambiguous)
        flags |= GRAIN_AMBIGUOUS;
    return flags | (outcome->searched ? GRAIN_RESCUED : 0) | (outcome->fit.fine ? GRAIN_SPECKLED_FINE : 0);
}

/* Of the reference's flags, those that say something of the grain or its circle stay with the row. How it was matched
 * in the file's photo, or whether it bore a load there, says nothing of this one. */
static uint32_t inherited(const struct photo_grains *grains, size_t k)
{
    const uint32_t of_circle = GRAIN_CUT | GRAIN_WEAK_EDGE | GRAIN_NOT_CONVERGED | GRAIN_SATURATED | GRAIN_NO_CONTRAST |
                               GRAIN_NOT_FINITE | GRAIN_OVERLAPPING | GRAIN_FIXED | GRAIN_FLANK | GRAIN_BY_HAND;
    return grains->flags ? grains->flags[k] & of_circle : 0;
}

static int alloc_grains(const struct photo_grains *grains, const struct lens *lens, struct photo_grains *tracks)
{
    static const char *const names[] = {"x_px",     "y_px",     "radius_px",  "angle",      "s_x",
                                        "s_y",      "s_angle",  "zncc",       "iterations", "flags",
                                        "dx_px",    "dy_px",    "dangle",     "x_seen_px",  "y_seen_px",
                                        "x_ref_px", "y_ref_px", "angle_seen", NULL};
    if (table_alloc(&PHOTO_GRAINS, tracks, grains->count, names))
        return -1;
    const struct {
        const char *name;
        const double *column;
    } optional[] = {{"s_radius", grains->s_radius}, {"shape_c", grains->shape_c}, {"shape_s", grains->shape_s},
                    {"s_shape", grains->s_shape},   {"s_x_ref", grains->s_x},     {"s_y_ref", grains->s_y}};
    for (size_t k = 0; k < sizeof optional / sizeof *optional; k++)
        if (optional[k].column && table_add(&PHOTO_GRAINS, tracks, optional[k].name))
            return -1;
    /* A lens shows circles as ellipses. */
    return lens && (table_add(&PHOTO_GRAINS, tracks, "shape_c") || table_add(&PHOTO_GRAINS, tracks, "shape_s")) ? -1
                                                                                                                : 0;
}

/* What belongs to the grain and not to the photo. */
static void carry(const struct photo_grains *grains, const struct lens *lens, size_t k, struct photo_grains *tracks)
{
    const double x = grains->x_px[k], y = grains->y_px[k], radius = grains->radius_px[k];
    struct vec centre = lens ? lens_corrected(lens, vec(x, y)) : vec(x, y);
    struct stretch stretch = correct_stretch(lens, x, y);
    tracks->x_ref_px[k] = centre.x;
    tracks->y_ref_px[k] = centre.y;
    tracks->radius_px[k] = stretch.magnification * radius;
    if (grains->s_radius)
        tracks->s_radius[k] = stretch.magnification * grains->s_radius[k];
    if (tracks->shape_c)
        tracks->shape_c[k] = stretch.magnification * column_or_zero(grains->shape_c, k) + stretch.shape_c * radius;
    if (tracks->shape_s)
        tracks->shape_s[k] = stretch.magnification * column_or_zero(grains->shape_s, k) + stretch.shape_s * radius;
    if (grains->s_shape)
        tracks->s_shape[k] = stretch.magnification * grains->s_shape[k];
    if (grains->s_x)
        tracks->s_x_ref[k] = stretch.magnification * grains->s_x[k];
    if (grains->s_y)
        tracks->s_y_ref[k] = stretch.magnification * grains->s_y[k];
}

static void place(const struct target *target, size_t k, const struct outcome *outcome, const struct lens *lens,
                  const struct camera *camera, struct photo_grains *tracks)
{
    const struct fit *fit = &outcome->fit;
    struct corrected body = correct_lens(lens, &target->shape, fit);
    double xx, yy, turn;
    tracks->x_seen_px[k] = target->shape.cx + fit->motion.u;
    tracks->y_seen_px[k] = target->shape.cy + fit->motion.v;
    tracks->angle_seen[k] = fit->motion.angle;
    tracks->zncc[k] = fit->zncc;
    tracks->iterations[k] = fit->iterations;
    if (!camera->known) {
        tracks->flags[k] |= GRAIN_LOST;
        return;
    }
    camera_variance(camera, body.x, body.y, &xx, &yy, &turn);
    camera_undo(camera, &body.x, &body.y, &body.angle);
    tracks->x_px[k] = body.x;
    tracks->y_px[k] = body.y;
    tracks->angle[k] = body.angle;
    tracks->s_x[k] = sqrt(body.xx + xx);
    tracks->s_y[k] = sqrt(body.yy + yy);
    tracks->s_angle[k] = sqrt(body.aa + turn);
}

int tracks_of_grains(const struct photo_grains *grains, const struct target *targets, const struct outcome *outcomes,
                     const struct lens *lens, const struct camera *camera, const struct photo_grains *previous,
                     struct photo_grains *tracks)
{
    if (alloc_grains(grains, lens, tracks))
        return -1;
    for (size_t k = 0; k < grains->count; k++) {
        uint32_t flags = flags_of(&targets[k], &outcomes[k]);
        carry(grains, lens, k, tracks);
        tracks->flags[k] = flags | inherited(grains, k);
        if (!(flags & GRAIN_LOST))
            place(&targets[k], k, &outcomes[k], lens, camera, tracks);
        if (!previous)
            continue;
        tracks->dx_px[k] = tracks->x_px[k] - previous->x_px[k]; /* NaN when either was lost */
        tracks->dy_px[k] = tracks->y_px[k] - previous->y_px[k];
        tracks->dangle[k] = tracks->angle[k] - previous->angle[k];
    }
    return 0;
}

/* `camera` NULL: a piece of paper, which shows the camera's motion itself. */
static void place_patch(const struct target *target, const struct outcome *outcome, const struct lens *lens,
                        const struct camera *camera, size_t row, struct patches *patches)
{
    struct corrected body = correct_lens(lens, &target->shape, &outcome->fit);
    double xx = 0, yy = 0, turn = 0;
    patches->x_px[row] = target->shape.cx + outcome->fit.motion.u;
    patches->y_px[row] = target->shape.cy + outcome->fit.motion.v;
    patches->zncc[row] = outcome->fit.zncc;
    if (camera && !camera->known) {
        patches->flags[row] |= GRAIN_LOST;
        return;
    }
    if (camera) {
        camera_variance(camera, body.x, body.y, &xx, &yy, &turn);
        camera_undo(camera, &body.x, &body.y, &body.angle);
    }
    patches->dx_px[row] = body.x - body.x_ref;
    patches->dy_px[row] = body.y - body.y_ref;
    patches->angle[row] = body.angle;
    patches->s_x[row] = sqrt(body.xx + xx);
    patches->s_y[row] = sqrt(body.yy + yy);
    patches->s_angle[row] = sqrt(body.aa + turn);
}

int tracks_of_patches(const struct tracker_options *options, const struct target *targets,
                      const struct outcome *outcomes, const struct camera *camera, struct patches *patches)
{
    size_t count = options->drift_count + options->marker_count;
    if (table_alloc(&PATCHES, patches, count, NULL))
        return -1;
    for (size_t k = 0; k < count; k++) {
        int wall = k >= options->drift_count;
        snprintf(patches->kind[k], NAME_LENGTH, "%s", wall ? "wall" : "drift");
        snprintf(patches->name[k], NAME_LENGTH, "%s", wall ? options->markers[k - options->drift_count].wall : "paper");
        patches->flags[k] = flags_of(&targets[k], &outcomes[k]);
        if (!(patches->flags[k] & GRAIN_LOST))
            place_patch(&targets[k], &outcomes[k], options->lens, wall ? camera : NULL, k, patches);
    }
    return 0;
}
