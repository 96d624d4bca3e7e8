/* Four lines from eight numbers. The corners of the scene tell where the sides are to some tenths of a pixel; the
 * grains that lean on a side tell it better. In a later state the lines move with their markers or, without any, with
 * the grains that lay on them, and are refined again.
 *
 * Corners are where neighbouring lines meet. Discs on the corners sit there, with the mean error of the two lines. */
#include "contacts/walls/frame.h"

#include <stdio.h>
#include <string.h>

#include "contacts/walls/marker.h"
#include "pipeline/speak/error.h"

enum { SIDES = 4 };
/* Counter-clockwise from the bottom, so that the interior is on the left; side k runs from corner k to corner k + 1. */
static const char *const side_names[SIDES] = {"bottom", "right", "top", "left"};
static const char *const corner_names[SIDES] = {"bottom-left", "bottom-right", "top-right", "top-left"};
static const int corner_order[SIDES] = {CORNER_BOTTOM_LEFT, CORNER_BOTTOM_RIGHT, CORNER_TOP_RIGHT, CORNER_TOP_LEFT};

/* Corner k of the frame in the reference photo, its lens undone, m. */
static struct vec corner_at(const struct frame_request *request, int k)
{
    struct vec px = request->scene->frame.corners_px[corner_order[k]];
    return scene_metres(request->scene, request->lens ? lens_corrected(request->lens, px) : px);
}

static void lines_of_frame(const struct frame_request *request, struct wall_line lines[SIDES])
{
    double error = request->frame_error_px * request->scene->scale;
    for (int k = 0; k < SIDES; k++) {
        struct vec from = corner_at(request, k), to = corner_at(request, (k + 1) % SIDES);
        double length = vec_norm(vec_sub(to, from));
        lines[k] = (struct wall_line){.middle = vec_scale(0.5, vec_add(from, to)),
                                      .along = vec_unit(vec_sub(to, from)),
                                      .half_length = 0.5 * length,
                                      .s_offset = error,
                                      .s_angle = M_SQRT2 * error / length};
    }
}

/* The reference lines: the frame, refined by the grains where they were in the reference. */
static int reference_lines(const struct frame_request *request, struct wall_line lines[SIDES])
{
    lines_of_frame(request, lines);
    for (int k = 0; k < SIDES; k++)
        if (support_fit(request->grains, request->reference, &request->statistics, &lines[k]))
            return -1;
    return 0;
}

/* Lines of this state from the reference lines: by the markers, or by the grains. */
static int current_lines(const struct frame_request *request, struct wall_line lines[SIDES], double s_motion[SIDES])
{
    for (int k = 0; k < SIDES; k++) {
        struct wall_motion motion;
        double before = lines[k].s_offset;
        if (marker_motion(request->scene, request->patches, side_names[k], &motion)) {
            marker_move(&motion, &lines[k]);
            s_motion[k] = sqrt(fmax(0, lines[k].s_offset * lines[k].s_offset - before * before));
            continue;
        }
        if (support_follow(request->grains, request->reference, &request->statistics, &lines[k]) ||
            support_fit(request->grains, NULL, &request->statistics, &lines[k]))
            return -1;
        s_motion[k] = hypot(before, lines[k].s_offset);
    }
    return 0;
}

static struct vec corner_of(const struct wall_line *a, const struct wall_line *b)
{
    return vec_meet(a->middle, a->along, b->middle, b->along);
}

static int fill_walls(const struct scene *scene, const struct wall_line lines[SIDES], struct walls *walls)
{
    double radius = scene->frame.corner_radius_px > 0 ? scene->frame.corner_radius_px * scene->scale : 0;
    static const char *const columns[] = {"name",     "x0",      "y0", "x1", "y1",     "radius", "fx", "fy",
                                          "s_offset", "s_angle", "dx", "dy", "dangle", "flags",  NULL};
    if (table_alloc(&WALLS, walls, radius > 0 ? 2 * SIDES : SIDES, columns))
        return -1;
    for (int k = 0; k < SIDES; k++) {
        struct vec from = corner_of(&lines[(k + SIDES - 1) % SIDES], &lines[k]);
        struct vec to = corner_of(&lines[k], &lines[(k + 1) % SIDES]);
        snprintf(walls->name[k], NAME_LENGTH, "%s", side_names[k]);
        walls->x0[k] = from.x;
        walls->y0[k] = from.y;
        walls->x1[k] = to.x;
        walls->y1[k] = to.y;
        walls->radius[k] = 0;
        walls->s_offset[k] = lines[k].s_offset;
        walls->s_angle[k] = lines[k].s_angle;
    }
    for (int k = 0; radius > 0 && k < SIDES; k++) {
        int row = SIDES + k;
        snprintf(walls->name[row], NAME_LENGTH, "%s", corner_names[k]);
        walls->x0[row] = walls->x1[row] = walls->x0[k];
        walls->y0[row] = walls->y1[row] = walls->y0[k];
        walls->radius[row] = radius;
        walls->s_offset[row] = hypot(lines[k].s_offset, lines[(k + SIDES - 1) % SIDES].s_offset) * M_SQRT1_2;
        walls->s_angle[row] = 0;
    }
    return 0;
}

int frame_walls(const struct frame_request *request, struct frame *frame)
{
    struct wall_line lines[SIDES];
    *frame = (struct frame){0};
    if (!request->scene->frame.given)
        return 0;
    if (reference_lines(request, lines) || fill_walls(request->scene, lines, &frame->reference))
        return -1;
    if (request->reference && current_lines(request, lines, frame->s_motion)) {
        frame_free(frame);
        return -1;
    }
    for (int k = 0; k < SIDES; k++)
        frame->s_motion[SIDES + k] = hypot(frame->s_motion[k], frame->s_motion[(k + SIDES - 1) % SIDES]) * M_SQRT1_2;
    if (fill_walls(request->scene, lines, &frame->now)) {
        frame_free(frame);
        return -1;
    }
    return 0;
}

void frame_free(struct frame *frame)
{
    table_free(&WALLS, &frame->now);
    table_free(&WALLS, &frame->reference);
}

void frame_motion(struct walls *walls, const struct walls *before)
{
    for (size_t w = 0; w < walls->count; w++) {
        long old = walls_find(before, walls->name[w]);
        walls->dx[w] = walls->dy[w] = walls->dangle[w] = NAN;
        if (old < 0)
            continue;
        struct vec moved = vec_sub(wall_middle(walls, w), wall_middle(before, (size_t)old));
        struct vec was = wall_direction(before, (size_t)old), is = wall_direction(walls, w);
        walls->dx[w] = moved.x;
        walls->dy[w] = moved.y;
        walls->dangle[w] = wall_is_disc(walls, w) ? 0 : atan2(vec_cross(was, is), vec_dot(was, is));
    }
}

/* The affine map of four corners about their mean, least squares: F = (sum y x^T) (sum x x^T)^-1. */
void frame_strain(const struct walls *walls, const struct walls *reference, double strain[3])
{
    double a[2][2] = {{0}}, b[2][2] = {{0}};
    struct vec old_mean = vec(0, 0), new_mean = vec(0, 0);
    strain[0] = strain[1] = strain[2] = NAN;
    if (walls->count < SIDES || reference->count < SIDES)
        return;
    for (size_t k = 0; k < SIDES; k++) {
        old_mean = vec_add(old_mean, vec_scale(0.25, vec(reference->x0[k], reference->y0[k])));
        new_mean = vec_add(new_mean, vec_scale(0.25, vec(walls->x0[k], walls->y0[k])));
    }
    for (size_t k = 0; k < SIDES; k++) {
        struct vec x = vec_sub(vec(reference->x0[k], reference->y0[k]), old_mean);
        struct vec u = vec_sub(vec_sub(vec(walls->x0[k], walls->y0[k]), new_mean), x);
        a[0][0] += x.x * x.x;
        a[0][1] += x.x * x.y;
        a[1][1] += x.y * x.y;
        b[0][0] += u.x * x.x;
        b[0][1] += u.x * x.y;
        b[1][0] += u.y * x.x;
        b[1][1] += u.y * x.y;
    }
    double determinant = a[0][0] * a[1][1] - a[0][1] * a[0][1];
    double xx = (b[0][0] * a[1][1] - b[0][1] * a[0][1]) / determinant;
    double xy = (b[0][1] * a[0][0] - b[0][0] * a[0][1]) / determinant;
    double yx = (b[1][0] * a[1][1] - b[1][1] * a[0][1]) / determinant;
    double yy = (b[1][1] * a[0][0] - b[1][0] * a[0][1]) / determinant;
    strain[0] = -xx;
    strain[1] = -yy;
    strain[2] = xy + yx;
}
