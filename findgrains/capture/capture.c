/* From a rough place to a rim by sampling consensus. Along 96 rays the steepest falls are candidates for the edge, up
 * to three each, because specks fall too. Three edges determine a circle; of the circles drawn that is kept which has
 * the most rays whose edge lies on it, weighted by the fall. Then some Gauss-Newton steps on its supporters.
 *
 * A draw succeeds when all three edges belong to the rim: with a share w of such edges, log(1 - p) / log(1 - w^3) draws
 * find it with probability p (Fischler and Bolles, eq. 4). Numbers are drawn by a key per place: the same circle
 * whatever the threads do. */
#include "findgrains/capture/capture.h"

#include "pipeline/numbers/random.h"

#include <math.h>
#include <string.h>

enum { RAYS = 96, PER_RAY = 3, PROFILE = 96, TRIALS = 160, ROUNDS = 4 };
#define REACH 0.35           /* edges are looked for within this share of the radius */
#define FAINTEST 0.15        /* fall over two pixels, in contrasts of this grain */
#define NEIGHBOUR_BEHIND 0.3 /* trust in a fall that is not followed by void: another grain may be there */
#define TOLERANCE 0.75       /* level pixels between an edge and the circle that it supports */
#define LUCKY 0.6            /* share of the draws that take the right edge of a ray that has it */
#define BESIDE 0.15          /* of the radius: over this depth the void outside a rim is darker than the grain inside */

struct ray_edge {
    double x, y, r, fall; /* fall: 0 to 1, full from half the grain's contrast on */
};

/* Edges along rays from a first guess of the centre outwards, PER_RAY at most on each, the strongest first. */
struct rays {
    double cos[RAYS], sin[RAYS];
    struct ray_edge edges[RAYS][PER_RAY];
    int count[RAYS];
    int usable[RAYS]; /* rays that have an edge */
    int usable_count;
};

/* Mean of a few samples in the middle of the grain: its own brightness. */
static double inner_level(const struct level *level, const struct rim *place)
{
    double sum = 0;
    int count = 0;
    for (int ring = 0; ring < 3; ring++)
        for (int k = 0; k < 16; k++) {
            double r = place->radius * (0.25 + 0.2 * ring), a = (k + 0.5 * ring) * M_PI / 8;
            sum += level_at(level, place->x + r * cos(a), place->y + r * sin(a));
            count++;
        }
    return sum / count;
}

/* Keeps the list in order; the weakest falls out. */
static void insert_edge(struct rays *rays, int ray, const struct ray_edge *edge)
{
    struct ray_edge *list = rays->edges[ray];
    int n = rays->count[ray], at = n;
    while (at > 0 && list[at - 1].fall < edge->fall)
        at--;
    if (at >= PER_RAY)
        return;
    int last = n < PER_RAY ? n : PER_RAY - 1;
    memmove(list + at + 1, list + at, (size_t)(last - at) * sizeof *list);
    list[at] = *edge;
    rays->count[ray] = n < PER_RAY ? n + 1 : PER_RAY;
}

/* How much darker it is over some depth outside than inside: dark specks are steep, but the grain goes on behind. */
static double fall_beside(const double *profile, int count, int at, int depth)
{
    double inside = 0, outside = 0;
    int in = 0, out = 0;
    for (int k = at - depth; k < at; k++)
        if (k >= 0) {
            inside += profile[k];
            in++;
        }
    for (int k = at + 1; k <= at + depth && k < count; k++) {
        outside += profile[k];
        out++;
    }
    return inside / in - outside / out;
}

/* The steepest falls along one ray. */
static void scan_ray(const struct level *level, const struct rim *place, double contrast, int ray, struct rays *rays)
{
    double first = fmax(1, (1 - REACH) * place->radius - 2), last = (1 + REACH) * place->radius + 2;
    int count = (int)fmin(PROFILE, (last - first) / 0.5 + 1);
    double profile[PROFILE], fall[PROFILE] = {0}, step = (last - first) / (count - 1);
    for (int k = 0; k < count; k++) {
        double r = first + k * step;
        profile[k] = level_at(level, place->x + r * rays->cos[ray], place->y + r * rays->sin[ray]);
    }
    int half = (int)lround(fmax(1, 1 / level->scale) / step); /* a magnified photo is no sharper for it */
    half = half < 1 ? 1 : half;
    for (int k = half; k < count - half; k++)
        fall[k] = (profile[k - half] - profile[k + half]) / contrast;
    int beside = (int)lround(BESIDE * place->radius / step);
    beside = beside < half ? half : beside;
    for (int k = half + 1; k < count - half - 1; k++) {
        if (fall[k] < FAINTEST || fall[k] < fall[k - 1] || fall[k] <= fall[k + 1])
            continue;
        double bend = fall[k - 1] - 2 * fall[k] + fall[k + 1];
        double shift = bend < 0 ? 0.5 * (fall[k - 1] - fall[k + 1]) / bend : 0;
        double r = first + (k + shift) * step;
        double wide = fmax(0, fall_beside(profile, count, k, beside) / contrast);
        struct ray_edge edge = {place->x + r * rays->cos[ray], place->y + r * rays->sin[ray], r,
                                fmin(1, 2 * fall[k]) * (NEIGHBOUR_BEHIND + (1 - NEIGHBOUR_BEHIND) * fmin(1, 2 * wide))};
        insert_edge(rays, ray, &edge);
    }
}

static void scan_rays(const struct level *level, const struct rim *place, double contrast, struct rays *rays)
{
    rays->usable_count = 0;
    for (int k = 0; k < RAYS; k++) {
        rays->cos[k] = cos(2 * M_PI * k / RAYS);
        rays->sin[k] = sin(2 * M_PI * k / RAYS);
        rays->count[k] = 0;
        scan_ray(level, place, contrast, k, rays);
        if (rays->count[k])
            rays->usable[rays->usable_count++] = k;
    }
}

/* The circle through three points: its centre is where two perpendicular bisectors meet. 0 when they lie on a line. */
static int circle_through(const struct ray_edge *a, const struct ray_edge *b, const struct ray_edge *c, struct rim *rim)
{
    double bx = b->x - a->x, by = b->y - a->y, cx = c->x - a->x, cy = c->y - a->y, det = 2 * (bx * cy - by * cx);
    if (fabs(det) < 1e-6)
        return 0;
    double bb = bx * bx + by * by, cc = cx * cx + cy * cy, ux = (cy * bb - by * cc) / det,
           uy = (bx * cc - cx * bb) / det;
    *rim = (struct rim){.x = a->x + ux, .y = a->y + uy, .radius = hypot(ux, uy)};
    return 1;
}

/* The edge of a ray nearest to the circle, within the tolerance; NULL: none. */
static const struct ray_edge *supporter(const struct rays *rays, int ray, const struct rim *rim, double tolerance)
{
    const struct ray_edge *best = NULL;
    double nearest = tolerance;
    for (int k = 0; k < rays->count[ray]; k++) {
        const struct ray_edge *edge = &rays->edges[ray][k];
        double dx = edge->x - rim->x, dy = edge->y - rim->y, off = fabs(sqrt(dx * dx + dy * dy) - rim->radius);
        if (off < nearest) {
            nearest = off;
            best = edge;
        }
    }
    return best;
}

/* The largest fall within the tolerance on each ray; this is asked for every trial, so without roots, and only until
 * it is clear that the support cannot exceed `least` any more (0 then). */
static double support_of(const struct rays *rays, const struct rim *rim, double least)
{
    double support = 0, low = rim->radius - TOLERANCE, high = rim->radius + TOLERANCE;
    low *= fmax(0, low);
    high *= high;
    for (int k = 0; k < rays->usable_count; k++) {
        int ray = rays->usable[k];
        double fall = 0;
        for (int e = 0; e < rays->count[ray]; e++) {
            const struct ray_edge *edge = &rays->edges[ray][e];
            double dx = edge->x - rim->x, dy = edge->y - rim->y, square = dx * dx + dy * dy;
            if (square > low && square < high && edge->fall > fall)
                fall = edge->fall;
        }
        support += fall;
        if (support + (rays->usable_count - 1 - k) < least * RAYS)
            return 0;
    }
    return support / RAYS;
}

/* Three edges from three thirds of the usable rays, so that they determine a circle well; of a ray's edges the
 * steepest more often: the square of a uniform number picks it 6 times of 10. */
static void draw_edges(const struct rays *rays, uint64_t key, int trial, int ray[3], const struct ray_edge *picked[3])
{
    int n = rays->usable_count, third = n / 3;
    uint64_t first = random_bits(key, (uint64_t)trial * 7);
    for (int k = 0; k < 3; k++) {
        uint64_t draw =
            first + (uint64_t)(k * third) + random_bits(key, (uint64_t)(trial * 7 + 1 + k)) % (uint64_t)third;
        ray[k] = rays->usable[draw % (uint64_t)n];
        double u = random_uniform(key, (uint64_t)(trial * 7 + 4 + k));
        picked[k] = &rays->edges[ray[k]][(int)(u * u * rays->count[ray[k]])];
    }
}

/* Trials after which a better circle would have been met but once in a thousand times: Fischler and Bolles, eq. (4),
 * with three edges that belong to the rim. */
static double trials_for(double support)
{
    double share = LUCKY * support;
    return log(1e-3) / log(1 - share * share * share);
}

/* RANSAC over three edges of three rays (Fischler and Bolles 1981); random numbers by `key` and trial. Returns the
 * support of the best circle. */
static double best_circle(const struct rays *rays, const struct rim *place, uint64_t key, struct rim *best)
{
    double support = 0, needed = TRIALS;
    for (int trial = 0; trial < needed; trial++) {
        const struct ray_edge *picked[3];
        int ray[3];
        draw_edges(rays, key, trial, ray, picked);
        struct rim rim;
        if (ray[0] == ray[1] || ray[1] == ray[2] || ray[0] == ray[2] ||
            !circle_through(picked[0], picked[1], picked[2], &rim))
            continue;
        if (fabs(rim.radius - place->radius) > REACH * place->radius ||
            hypot(rim.x - place->x, rim.y - place->y) > 0.5 * place->radius)
            continue;
        double now = support_of(rays, &rim, support);
        if (now > support) {
            support = now;
            needed = fmin(TRIALS, trials_for(support));
            *best = rim;
        }
    }
    return support;
}

/* One Gauss-Newton step of sum w (|p - c| - R)^2 over the supporters; 0 when they do not determine a circle. */
static int polish(const struct rays *rays, struct rim *rim)
{
    double m[3][4] = {{0}};
    for (int k = 0; k < rays->usable_count; k++) {
        const struct ray_edge *edge = supporter(rays, rays->usable[k], rim, 1.5 * TOLERANCE);
        if (!edge)
            continue;
        double dx = edge->x - rim->x, dy = edge->y - rim->y, r = hypot(dx, dy);
        double row[4] = {1, dx / r, dy / r, r - rim->radius};
        for (int i = 0; i < 3; i++)
            for (int j = 0; j < 4; j++)
                m[i][j] += edge->fall * row[i] * row[j];
    }
    for (int i = 0; i < 3; i++) {
        if (!(m[i][i] > 1e-9))
            return 0;
        for (int k = i + 1; k < 3; k++) {
            double factor = m[k][i] / m[i][i];
            for (int j = i; j < 4; j++)
                m[k][j] -= factor * m[i][j];
        }
    }
    double dy = m[2][3] / m[2][2], dx = (m[1][3] - m[1][2] * dy) / m[1][1];
    rim->radius += (m[0][3] - m[0][1] * dx - m[0][2] * dy) / m[0][0];
    rim->x += dx;
    rim->y += dy;
    return 1;
}

static void weigh(const struct rays *rays, struct candidate *found)
{
    double sum = 0, x = 0, y = 0;
    for (int k = 0; k < rays->usable_count; k++) {
        const struct ray_edge *edge = supporter(rays, rays->usable[k], &found->rim, TOLERANCE);
        if (!edge)
            continue;
        double dx = edge->x - found->rim.x, dy = edge->y - found->rim.y, r = hypot(dx, dy);
        sum += edge->fall;
        x += edge->fall * dx / r;
        y += edge->fall * dy / r;
    }
    found->support = sum / RAYS;
    found->one_side = sum > 0 ? hypot(x, y) / sum : 1;
    found->spread = 0.5 * TOLERANCE;
}

int capture_rim(const struct level *level, const struct rim *place, double void_level, uint64_t key,
                double least_contrast, struct candidate *found)
{
    struct rays rays;
    double contrast = inner_level(level, place) - void_level;
    *found = (struct candidate){.rim = *place};
    if (!(contrast > least_contrast))
        return 0;
    scan_rays(level, place, contrast, &rays);
    if (rays.usable_count < RAYS / 8 || !(best_circle(&rays, place, key, &found->rim) > 0))
        return 0;
    for (int k = 0; k < ROUNDS; k++)
        if (!polish(&rays, &found->rim))
            return 0;
    if (!(fabs(found->rim.radius - place->radius) <= REACH * place->radius))
        return 0;
    weigh(&rays, found);
    return 1;
}
