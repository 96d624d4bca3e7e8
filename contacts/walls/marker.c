/* Markers are rigid with their wall. Its shift is the mean of their shifts, its rotation the weighted mean of two
 * independent measurements: the mean of their own rotations, and what their shifts say about their mean position, sum
 * (r x d) / sum r^2 (least squares for a small rotation; y up, counter-clockwise). */
#include "contacts/walls/marker.h"

#include <string.h>

static int is_marker(const struct patches *patches, size_t k, const char *wall)
{
    return !strncmp(patches->kind[k], "wall", NAME_LENGTH) && !strncmp(patches->name[k], wall, NAME_LENGTH) &&
           !(patches->flags[k] & GRAIN_DISTRUST) &&
           isfinite(patches->x_px[k] + patches->y_px[k] + patches->dx_px[k] + patches->dy_px[k]);
}

/* Position in the reference and motion since, in metres, y up. */
static void marker_at(const struct scene *scene, const struct patches *patches, size_t k, struct vec *was,
                      struct vec *moved)
{
    struct vec px = vec(patches->x_px[k] - patches->dx_px[k], patches->y_px[k] - patches->dy_px[k]);
    *was = scene_metres(scene, px);
    *moved = vec(scene->scale * patches->dx_px[k], -scene->scale * patches->dy_px[k]);
}

static double error_or(const double *column, size_t k, double otherwise)
{
    return column && column[k] > 0 ? column[k] : otherwise;
}

/* Two independent measurements of one angle by their weights. */
static void combine(struct wall_motion *motion, double angle, double variance)
{
    double own = motion->s_angle * motion->s_angle;
    if (!isfinite(own)) {
        motion->angle = angle;
        motion->s_angle = sqrt(variance);
    } else if (variance + own > 0) {
        motion->angle = (motion->angle * variance + angle * own) / (variance + own);
        motion->s_angle = sqrt(own * variance / (own + variance));
    }
}

int marker_motion(const struct scene *scene, const struct patches *patches, const char *wall,
                  struct wall_motion *motion)
{
    double n = 0, own_angle = 0, own_variance = 0, variance = 0, turned = 0, arms = 0;
    struct vec was, moved;
    *motion = (struct wall_motion){.s_angle = INFINITY};
    for (size_t k = 0; patches && k < patches->count; k++) {
        if (!is_marker(patches, k, wall))
            continue;
        marker_at(scene, patches, k, &was, &moved);
        double s = scene->scale * fmax(error_or(patches->s_x, k, 0), error_or(patches->s_y, k, 0));
        motion->about = vec_add(motion->about, was);
        motion->shift = vec_add(motion->shift, moved);
        own_angle += patches->angle ? patches->angle[k] : NAN;
        own_variance += pow(error_or(patches->s_angle, k, 0), 2);
        variance += s * s;
        n++;
    }
    if (n == 0)
        return 0;
    motion->about = vec_scale(1 / n, motion->about);
    motion->shift = vec_scale(1 / n, motion->shift);
    motion->s_shift = sqrt(variance) / n;
    for (size_t k = 0; k < patches->count; k++) {
        if (!is_marker(patches, k, wall))
            continue;
        marker_at(scene, patches, k, &was, &moved);
        struct vec arm = vec_sub(was, motion->about);
        turned += vec_cross(arm, vec_sub(moved, motion->shift));
        arms += vec_dot(arm, arm);
    }
    if (arms > 0)
        combine(motion, turned / arms, variance / n / arms);
    if (isfinite(own_angle))
        combine(motion, own_angle / n, own_variance / (n * n));
    if (!isfinite(motion->s_angle))
        motion->s_angle = 0;
    return 1;
}

void marker_move(const struct wall_motion *motion, struct wall_line *line)
{
    struct vec from = vec_sub(line->middle, motion->about);
    double arm = vec_dot(from, line->along);
    line->middle = vec_add(vec_add(motion->about, motion->shift), vec_rotate(from, motion->angle));
    line->along = vec_rotate(line->along, motion->angle);
    line->s_offset = hypot(line->s_offset, hypot(motion->s_shift, arm * motion->s_angle));
    line->s_angle = hypot(line->s_angle, motion->s_angle);
}
