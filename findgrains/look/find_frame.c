/* Each side by search among lines through two outermost points of rims (Fischler and Bolles, CACM 24 (1981) 381), then
 * least squares over the grains that touch it.
 *
 * A side is written e = offset + slope t, t along the side and e outwards. Candidates are the outermost few rims of
 * each of 64 strips across the specimen, all pairs of them make lines, and a line counts the rims that it touches less
 * three for each that lies behind it: a wall has grains on one side only. Errors are the larger of the residuals' and
 * the jackknife's. */
#include "findgrains/look/find_frame.h"

#include "pipeline/numbers/quantiles.h"
#include "pipeline/speak/error.h"

#include <math.h>
#include <stdlib.h>

enum { BINS = 64, PER_BIN = 4, MOST = BINS * PER_BIN, LEAST_TOUCHING = 6, PARTS = 5, ROUNDS = 6 };
#define TOUCH 1.5        /* px between a grain and the line that it touches, while searching */
#define LEAST_REACH 0.3  /* px: a gap that small is not told from touching, */
#define INSIDE 2         /* nor are gaps of so many standard deviations of those that touch */
#define MOST_TILT 0.07   /* of a side against the photo's */
#define BEHIND 3         /* a grain behind the line counts against as many that touch it */
#define FAR_APART 0.3    /* of the specimen's width: the two grains that make a line */
#define SPREAD_OVER 0.5  /* of the specimen's width: what the touching grains have to span at least */
#define CORNER_SHARE 0.7 /* of the nearest grain's radius: square corners leave 0.41 of it free */
#define CUT_DEPTH 1.5    /* px */

/* Outermost points of the rims towards one side: t along the side, e outwards. */
struct extremes {
    double t[MOST], e[MOST];
    int count;
};

/* One side of the frame as a line through the rims that touch it, px. */
struct side {
    double offset, slope;                 /* e = offset + slope t */
    double s_offset, s_slope, mean;       /* of t: there offset and slope err independently */
    double offsets[PARTS], slopes[PARTS]; /* the same without one part of the side's grains */
    int touching;
};

static struct vec outward_of(int side)
{
    static const struct vec outward[4] = {{0, -1}, {1, 0}, {0, 1}, {-1, 0}};
    return outward[side];
}

/* px from the centre to the rim in that direction, shape included; angles are counter-clockwise as seen, y is down. */
static double rim_towards(const struct photo_grains *grains, size_t k, struct vec direction)
{
    double r = grains->radius_px[k];
    if (grains->shape_c) {
        double phi = atan2(-direction.y, direction.x);
        r += grains->shape_c[k] * cos(2 * phi) + grains->shape_s[k] * sin(2 * phi);
    }
    return r;
}

/* A trusted row with a place and a radius. */
static int usable(const struct photo_grains *grains, size_t k)
{
    return !(grains->flags[k] & GRAIN_DISTRUST) && isfinite(grains->x_px[k] + grains->y_px[k] + grains->radius_px[k]);
}

/* Keep the outermost PER_BIN of a strip, the outermost first. */
static int insert(double e, double t, int count, double *top, double *place)
{
    if (count == PER_BIN && e <= top[PER_BIN - 1])
        return count;
    int at = count < PER_BIN ? count : PER_BIN - 1;
    for (; at > 0 && top[at - 1] < e; at--) {
        top[at] = top[at - 1];
        place[at] = place[at - 1];
    }
    top[at] = e;
    place[at] = t;
    return count < PER_BIN ? count + 1 : count;
}

/* The few outermost grains of each strip across the specimen. */
static void gather(const struct photo_grains *grains, int side, double t0, double t1, struct extremes *extremes)
{
    struct vec out = outward_of(side), along = vec_turn(out);
    double top[BINS][PER_BIN], place[BINS][PER_BIN];
    int count[BINS] = {0};
    for (size_t k = 0; k < grains->count; k++) {
        if (!usable(grains, k))
            continue;
        struct vec centre = vec(grains->x_px[k], grains->y_px[k]);
        double t = vec_dot(centre, along), e = vec_dot(centre, out) + rim_towards(grains, k, out);
        int bin = (int)fmin(BINS - 1, (t - t0) / (t1 - t0) * BINS);
        count[bin] = insert(e, t, count[bin], top[bin], place[bin]);
    }
    extremes->count = 0;
    for (int bin = 0; bin < BINS; bin++)
        for (int k = 0; k < count[bin]; k++) {
            extremes->t[extremes->count] = place[bin][k];
            extremes->e[extremes->count++] = top[bin][k];
        }
}

/* One for each rim at the line; rims behind it, which no wall allows, count against it. */
static int score_of(const struct extremes *extremes, double offset, double slope)
{
    int score = 0;
    for (int k = 0; k < extremes->count; k++) {
        double off = extremes->e[k] - offset - slope * extremes->t[k];
        score += off > TOUCH ? -BEHIND : off > -TOUCH;
    }
    return score;
}

static int search_line(const struct extremes *extremes, double width, struct side *side)
{
    int best = 0;
    for (int i = 0; i < extremes->count; i++)
        for (int j = i + 1; j < extremes->count; j++) {
            double run = extremes->t[j] - extremes->t[i];
            double slope = (extremes->e[j] - extremes->e[i]) / run;
            if (fabs(run) < FAR_APART * width || fabs(slope) > MOST_TILT)
                continue;
            double offset = extremes->e[i] - slope * extremes->t[i];
            int score = score_of(extremes, offset, slope);
            if (score > best) {
                best = score;
                side->offset = offset;
                side->slope = slope;
            }
        }
    return best >= LEAST_TOUCHING;
}

/* Those grains that touch, in the order of t. */
struct touching {
    double t[MOST], e[MOST];
    int count;
};

/* Least squares over the touching grains but those from `first` up to `end`. */
static void fit_without(const struct touching *touching, int first, int end, double *offset, double *slope,
                        double *mean)
{
    double st = 0, se = 0, stt = 0, ste = 0, n = 0;
    for (int k = 0; k < touching->count; k++)
        if (k < first || k >= end) {
            st += touching->t[k];
            se += touching->e[k];
            n += 1;
        }
    *mean = st / n;
    for (int k = 0; k < touching->count; k++)
        if (k < first || k >= end) {
            stt += (touching->t[k] - *mean) * (touching->t[k] - *mean);
            ste += (touching->t[k] - *mean) * (touching->e[k] - se / n);
        }
    *slope = ste / stt;
    *offset = se / n - *slope * *mean;
}

static void set_errors(const struct touching *touching, struct side *side)
{
    double rest = 0, stt = 0, mean;
    int n = touching->count;
    for (int k = 0; k < n; k++) {
        double off = touching->e[k] - side->offset - side->slope * touching->t[k];
        rest += off * off;
        stt += (touching->t[k] - side->mean) * (touching->t[k] - side->mean);
    }
    side->s_offset = sqrt(rest / (n - 2) / n);
    side->s_slope = sqrt(rest / (n - 2) / stt);
    for (int part = 0; part < PARTS; part++)
        fit_without(touching, part * n / PARTS, (part + 1) * n / PARTS, &side->offsets[part], &side->slopes[part],
                    &mean);
}

static int fit_once(const struct extremes *extremes, double width, double *reach, struct side *side)
{
    struct touching touching = {.count = 0};
    double out[MOST];
    int n = 0;
    for (int k = 0; k < extremes->count; k++) {
        double off = extremes->e[k] - side->offset - side->slope * extremes->t[k];
        if (off <= -*reach || off >= TOUCH)
            continue;
        int at = touching.count++;
        for (; at > 0 && touching.t[at - 1] > extremes->t[k]; at--) {
            touching.t[at] = touching.t[at - 1];
            touching.e[at] = touching.e[at - 1];
        }
        touching.t[at] = extremes->t[k];
        touching.e[at] = extremes->e[k];
    }
    if (touching.count < LEAST_TOUCHING || touching.t[touching.count - 1] - touching.t[0] < SPREAD_OVER * width)
        return 0;
    struct side next = {.touching = touching.count};
    fit_without(&touching, 0, 0, &next.offset, &next.slope, &next.mean);
    for (int k = 0; k < touching.count; k++) {
        double off = touching.e[k] - next.offset - next.slope * touching.t[k];
        if (off > 0)
            out[n++] = off;
    }
    set_errors(&touching, &next);
    *reach = fmin(*reach, fmax(LEAST_REACH, INSIDE * 1.4826 * median_of(out, (size_t)n)));
    *side = next;
    return 1;
}

/* Least squares over the grains that touch, in turn with who does. Grains with a small gap behind the side are many,
 * beyond it there are none: the scatter of those that touch is what lies outside the line, and only little more is
 * allowed inside. */
static int fit_line(const struct extremes *extremes, double width, struct side *side)
{
    double reach = TOUCH;
    for (int round = 0; round < ROUNDS; round++)
        if (!fit_once(extremes, width, &reach, side))
            return 0;
    return 1;
}

/* A point of the side and its direction. */
static void line_of(const struct side *side, int which, struct vec *point, struct vec *along)
{
    struct vec out = outward_of(which), t = vec_turn(out);
    *point = vec_add(vec_scale(side->mean, t), vec_scale(side->offset + side->slope * side->mean, out));
    *along = vec_add(t, vec_scale(side->slope, out));
}

/* Standard error of a side at t, across it: of least squares, or, where a side is bent or grains with a small gap tilt
 * it, of what it would be without one part of its grains (jackknife: Efron, Ann. Statist. 7 (1979) 1). */
static double error_at(const struct side *side, double t)
{
    double mean = 0, sum = 0;
    for (int k = 0; k < PARTS; k++)
        mean += (side->offsets[k] + side->slopes[k] * t) / PARTS;
    for (int k = 0; k < PARTS; k++) {
        double off = side->offsets[k] + side->slopes[k] * t - mean;
        sum += off * off;
    }
    return fmax(hypot(side->s_offset, side->s_slope * (t - side->mean)), sqrt(sum * (PARTS - 1) / PARTS));
}

/* Corner k joins side k - 1 (left, top, right, bottom) and side k. One of them is upright: it gives the x. */
static void join(const struct side sides[4], int k, struct found_frame *frame)
{
    int before = (k + 3) % 4;
    struct vec p, u, q, v;
    line_of(&sides[before], before, &p, &u);
    line_of(&sides[k], k, &q, &v);
    struct vec corner = vec_meet(p, u, q, v);
    double s_before = error_at(&sides[before], vec_dot(corner, vec_turn(outward_of(before))));
    double s_this = error_at(&sides[k], vec_dot(corner, vec_turn(outward_of(k))));
    frame->corners[k] = corner;
    frame->s_corners[k][0] = k % 2 ? s_this : s_before;
    frame->s_corners[k][1] = k % 2 ? s_before : s_this;
}

static void find_corner_radius(const struct photo_grains *grains, struct found_frame *frame)
{
    double least = INFINITY, share = INFINITY;
    for (int corner = 0; corner < 4; corner++) {
        double nearest = INFINITY, radius = 1;
        for (size_t k = 0; k < grains->count; k++) {
            double d = usable(grains, k) ? hypot(grains->x_px[k] - frame->corners[corner].x,
                                                 grains->y_px[k] - frame->corners[corner].y) -
                                               grains->radius_px[k]
                                         : INFINITY;
            if (d < nearest) {
                nearest = d;
                radius = grains->radius_px[k];
            }
        }
        least = fmin(least, nearest);
        share = fmin(share, nearest / radius);
    }
    frame->corner_radius = share > CORNER_SHARE ? least : 0;
}

static int find_side(const struct photo_grains *grains, int which, struct extremes *extremes, struct side *side)
{
    struct vec along = vec_turn(outward_of(which));
    double t0 = INFINITY, t1 = -INFINITY;
    for (size_t k = 0; k < grains->count; k++)
        if (usable(grains, k)) {
            double t = vec_dot(vec(grains->x_px[k], grains->y_px[k]), along);
            t0 = fmin(t0, t);
            t1 = fmax(t1, t);
        }
    if (!(t1 > t0))
        return 0;
    gather(grains, which, t0, t1, extremes);
    return search_line(extremes, t1 - t0, side) && fit_line(extremes, t1 - t0, side);
}

int find_frame(const struct photo_grains *grains, struct found_frame *frame)
{
    struct extremes *extremes = malloc(sizeof *extremes);
    struct side sides[4] = {{0}};
    *frame = (struct found_frame){0};
    if (!extremes)
        return error_memory("outermost grains");
    frame->found = 1;
    for (int k = 0; k < 4 && frame->found; k++) {
        frame->found = find_side(grains, k, extremes, &sides[k]);
        frame->touching[k] = sides[k].touching;
    }
    free(extremes);
    for (int k = 0; k < 4 && frame->found; k++)
        join(sides, k, frame);
    if (frame->found)
        find_corner_radius(grains, frame);
    return 0;
}

void find_frame_flag(const struct zone *zone, struct photo_grains *grains)
{
    for (size_t k = 0; k < grains->count; k++) {
        double r = grains->radius_px[k];
        if (zone_depth(zone, grains->x_px[k], grains->y_px[k]) < r - fmax(CUT_DEPTH, 0.03 * r))
            grains->flags[k] |= GRAIN_CUT;
    }
}
