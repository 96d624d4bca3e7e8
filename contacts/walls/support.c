/* A wall's offset and tilt from the rims near it, by the product of a prior and a likelihood on a grid of both (see the
 * header). The grid starts as wide as the prior and shrinks about the mean to some deviations of what it shows, until
 * it resolves it; its moments are the estimate. The likelihood has kinks where rims begin to touch, so that no Newton
 * step is safe; a grid is. */
#include "contacts/walls/support.h"

#include <stdlib.h>

#include "contacts/network/pair.h"
#include "pipeline/speak/error.h"
#include "pipeline/numbers/quantiles.h"

enum { GRID = 25, MAX_ZOOMS = 16, MAX_FOLLOWED = 400 };
#define PRIOR_REACH 5.0 /* prior standard deviations that are searched */
#define ZOOM_REACH 4.5  /* posterior standard deviations of the next grid */

/* Overlaps at one wall over those in the photo: a load on one pair of walls squeezes its own grains more. With
 * principal stresses of ratio 3, the most that mu = tan 30 degrees bears, the mean forces at the walls are half and one
 * and a half times the mean; and fewer contacts reach a straight wall than an inner line. All are as likely beforehand.
 */
static const double wall_scales[] = {0.6, 1, 1.6, 2.5};
enum { WALL_SCALES = sizeof wall_scales / sizeof *wall_scales };

/* A rim point near the line: how far beyond the line, where along it, with what error; where its grain was and is. */
struct rim_point {
    double out, arm, s;
    struct vec was, is;
    const struct pair_statistics *statistics;
};

struct rim_points {
    struct rim_point *points;
    size_t count;
};

void wall_line_shift(struct wall_line *line, double offset, double tilt)
{
    line->middle = vec_sub(line->middle, vec_scale(offset, wall_line_inward(line)));
    line->along = vec_rotate(line->along, -atan(tilt));
}

static int collect(const struct grains *grains, const struct vec *positions, const struct rim_statistics *statistics,
                   const struct wall_line *line, double depth, struct rim_points *rim)
{
    struct vec outward = vec_scale(-1, wall_line_inward(line));
    *rim = (struct rim_points){.points = malloc((grains->count + 1) * sizeof *rim->points)};
    if (!rim->points)
        return error_memory("rim points");
    for (size_t k = 0; k < grains->count; k++) {
        struct vec now = vec(grains->x[k], grains->y[k]), at = positions ? positions[k] : now;
        if ((grains->flags[k] & GRAIN_DISTRUST) || !isfinite(at.x + at.y + now.x + now.y) || !(grains->radius[k] > 0))
            continue;
        struct vec from = vec_sub(at, line->middle);
        struct rim_point point = {.out = vec_dot(from, outward) + rim_radius(grains, k, outward),
                                  .arm = vec_dot(from, line->along),
                                  .s = sqrt(rim_variance(grains, k, outward)),
                                  .was = at,
                                  .is = now,
                                  .statistics = statistics->idle && statistics->idle[k] ? statistics->idle_pairs
                                                                                        : statistics->bearing};
        if (point.out > -depth && fabs(point.arm) < line->half_length)
            rim->points[rim->count++] = point;
    }
    return 0;
}

/* A rectangle of (offset, tilt) and what the posterior looks like in it. */
struct posterior {
    double centre[2], half[2];
    double mean[2], sd[2];
};

static double log_likelihood(const struct rim_points *rim, double offset, double tilt, double scale)
{
    double value = 0;
    for (size_t k = 0; k < rim->count; k++) {
        const struct rim_point *point = &rim->points[k];
        struct pair_statistics statistics = *point->statistics;
        statistics.scale *= scale;
        value += pair_odds(&statistics, point->out - offset - tilt * point->arm, point->s).log_density;
    }
    return value;
}

/* The scale of the wall's overlaps is integrated over. */
static double log_posterior(const struct rim_points *rim, const struct wall_line *prior, double offset, double tilt)
{
    double value[WALL_SCALES], best = -INFINITY, sum = 0, belief = -0.5 * pow(offset / prior->s_offset, 2);
    if (prior->s_angle > 0)
        belief -= 0.5 * pow(tilt / prior->s_angle, 2);
    for (int k = 0; k < WALL_SCALES; k++) {
        value[k] = log_likelihood(rim, offset, tilt, wall_scales[k]);
        best = fmax(best, value[k]);
    }
    for (int k = 0; k < WALL_SCALES; k++)
        sum += exp(value[k] - best) / WALL_SCALES;
    return belief + best + log(sum);
}

static double grid_value(const struct posterior *p, int axis, int step)
{
    return p->centre[axis] + p->half[axis] * (2.0 * step / (GRID - 1) - 1);
}

static void grid_moments(const struct rim_points *rim, const struct wall_line *prior, struct posterior *p)
{
    double value[GRID][GRID], best = -INFINITY, weight = 0, sum[2] = {0, 0}, square[2] = {0, 0};
    for (int a = 0; a < GRID; a++)
        for (int b = 0; b < GRID; b++) {
            value[a][b] = log_posterior(rim, prior, grid_value(p, 0, a), grid_value(p, 1, b));
            best = fmax(best, value[a][b]);
        }
    for (int a = 0; a < GRID; a++)
        for (int b = 0; b < GRID; b++) {
            double w = exp(value[a][b] - best);
            double at[2] = {grid_value(p, 0, a) - p->centre[0], grid_value(p, 1, b) - p->centre[1]};
            weight += w;
            for (int axis = 0; axis < 2; axis++) {
                sum[axis] += w * at[axis];
                square[axis] += w * at[axis] * at[axis];
            }
        }
    for (int axis = 0; axis < 2; axis++) {
        double mean = sum[axis] / weight;
        p->mean[axis] = p->centre[axis] + mean;
        p->sd[axis] = sqrt(fmax(0, square[axis] / weight - mean * mean));
    }
}

int support_fit(const struct grains *grains, const struct vec *positions, const struct rim_statistics *statistics,
                struct wall_line *line)
{
    struct rim_points rim;
    struct posterior p = {.half = {PRIOR_REACH * line->s_offset, PRIOR_REACH * line->s_angle}};
    if (!(line->s_offset > 0))
        return 0;
    double depth = p.half[0] + p.half[1] * line->half_length + statistics->bearing->window;
    if (collect(grains, positions, statistics, line, depth, &rim))
        return -1;
    for (int zoom = 0; zoom < MAX_ZOOMS; zoom++) {
        int coarse = 0;
        grid_moments(&rim, line, &p);
        for (int axis = 0; axis < 2; axis++) {
            double step = 2 * p.half[axis] / (GRID - 1);
            double half = fmax(ZOOM_REACH * p.sd[axis], 1.5 * step);
            coarse |= half < 0.8 * p.half[axis];
            p.centre[axis] = p.mean[axis];
            p.half[axis] = fmin(half, p.half[axis]);
        }
        if (!coarse)
            break;
    }
    free(rim.points);
    wall_line_shift(line, p.mean[0], p.mean[1]);
    line->s_offset = p.sd[0];
    line->s_angle = p.sd[1];
    return 0;
}

/* Median angle by which the segments between two points turned, of pairs at least a third of the line apart. */
static double median_turn(const struct rim_points *rim, double half_length, double *room)
{
    size_t count = 0;
    for (size_t a = 0; a < rim->count; a++)
        for (size_t b = a + 1; b < rim->count; b++) {
            if (fabs(rim->points[b].arm - rim->points[a].arm) < 2 * half_length / 3)
                continue;
            struct vec was = vec_sub(rim->points[b].was, rim->points[a].was);
            struct vec is = vec_sub(rim->points[b].is, rim->points[a].is);
            room[count++] = atan2(vec_cross(was, is), vec_dot(was, is));
        }
    return count ? median_of(room, count) : 0;
}

/* Keep the points that touch the line, at most MAX_FOLLOWED of them, evenly chosen. */
static void keep_touching(struct rim_points *rim)
{
    size_t kept = 0, stride;
    for (size_t k = 0; k < rim->count; k++)
        if (pair_odds(rim->points[k].statistics, rim->points[k].out, rim->points[k].s).apart < 0.5)
            rim->points[kept++] = rim->points[k];
    stride = kept / MAX_FOLLOWED + 1;
    rim->count = 0;
    for (size_t k = 0; k < kept; k += stride)
        rim->points[rim->count++] = rim->points[k];
}

/* The motion of the line's middle, in the direction `along`, that each point suggests when the line turns by `turn`. */
static void suggest(const struct rim_points *rim, struct vec middle, double turn, struct vec along, double *values)
{
    for (size_t k = 0; k < rim->count; k++) {
        struct vec to = vec_add(rim->points[k].is, vec_rotate(vec_sub(middle, rim->points[k].was), turn));
        values[k] = vec_dot(vec_sub(to, middle), along);
    }
}

static void follow(const struct rim_points *rim, double overlap, double *room, struct wall_line *line)
{
    size_t n = rim->count;
    double turn = median_turn(rim, line->half_length, room);
    struct vec along = vec_rotate(line->along, turn), inward = vec_turn(along);
    suggest(rim, line->middle, turn, along, room);
    double shift_along = median_of(room, n);
    suggest(rim, line->middle, turn, inward, room);
    double shift_inward = median_of(room, n);
    for (size_t k = 0; k < n; k++)
        room[k] = fabs(room[k] - shift_inward);
    double spread = 1.4826 * median_of(room, n) + overlap; /* overlaps may have changed by about their mean */
    line->middle = vec_add(line->middle, vec_add(vec_scale(shift_along, along), vec_scale(shift_inward, inward)));
    line->along = along;
    line->s_offset = hypot(line->s_offset, spread);
    line->s_angle = hypot(line->s_angle, n > 2 ? 2 * spread / (line->half_length * sqrt((double)n)) : 0);
}

int support_follow(const struct grains *grains, const struct vec *before, const struct rim_statistics *statistics,
                   struct wall_line *line)
{
    struct rim_points rim;
    if (collect(grains, before, statistics, line, statistics->bearing->window, &rim))
        return -1;
    keep_touching(&rim);
    double *room = malloc((rim.count * (rim.count + 1) / 2 + 1) * sizeof *room);
    if (!room) {
        free(rim.points);
        return error_memory("motion of a wall");
    }
    if (rim.count)
        follow(&rim, pair_mean_overlap(statistics->bearing), room, line);
    free(room);
    free(rim.points);
    return 0;
}
