/* Least squares of many small systems that share their columns. Each pixel of the annulus adds its products to the sums
 * of its sector; when all pixels are through, every sector's normal equations are ready, and each is solved on its own.
 * So a pixel is touched once however many columns there are, and the profile is looked up, not computed.
 *
 * Priors are rows of the system: the texture terms T_1, T_2 with weight 1 / texture^2, the void's level B with the
 * weight (noise / void_spread)^2. The SHIFT column is phi(t) / s, the derivative of the edge with respect to an outward
 * shift, so that its coefficient over the step is the shift in px; the second right-hand side e_SHIFT gives the
 * diagonal of the inverse, which is the shift's variance per variance of a pixel.
 *
 * A neighbour whose blurred edge reaches in adds an edge of unknown height (column NEIGHBOUR). Pixels inside it or
 * beyond the frame are left out, and a sector whose rim lies too near to either is hidden: it tells nothing of this
 * grain. */
#include "findgrains/rims/edge_fit.h"

#include "findgrains/rims/edge_profile.h"
#include "pipeline/numbers/quantiles.h"
#include "pipeline/speak/error.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Columns of the least squares in one sector; the photo itself is one of them. The first SIMPLE ones are there at every
 * pixel, the first PLAIN ones when there is texture. Even numbers: products are made in pairs. */
enum {
    LEVEL_OUT,
    STEP,
    SHIFT,
    GREY,
    SIMPLE,
    TEXTURE_NEAR = SIMPLE,
    TEXTURE_DEEP,
    PLAIN,
    NEIGHBOUR = PLAIN,
    BLUR,
    COLUMNS
};
/* What a sector collects: products of columns, its number of pixels, the narrowest gap to something else, whether
 * a neighbour is near at all. */
enum { PIXELS = COLUMNS * COLUMNS, NEAREST, CROWDED, SUMS };

enum { AHEAD = 6 };       /* rows */
#define HIDDEN_GAP 1.2    /* blurs: a sector whose rim is nearer to a neighbour's than this tells nothing */
#define BLUR_REACH 5.0    /* blurs: further out a neighbour's edge is nothing */
#define LEAST_SECTORS 8.0 /* of a rim */
#define LEAST_SEEN 7
#define NEGLIGIBLE 1e-6  /* share of a neighbour's step at a pixel */
#define INSIDE_OTHER 1.0 /* blurs: pixels deeper than this inside a neighbour are left out */
#define OUTSIDE_ZONE 1.0 /* blurs: pixels nearer than this to the frame are left out */

void edge_work_free(struct edge_work *work)
{
    free(work->sectors);
    free(work->sums);
    *work = (struct edge_work){0};
}

static int make_room(struct edge_work *work, int count)
{
    if (count > work->room) {
        struct sector *sectors = realloc(work->sectors, (size_t)count * sizeof *sectors);
        if (sectors)
            work->sectors = sectors;
        double *sums = realloc(work->sums, (size_t)count * (SUMS + 1) * sizeof *sums);
        if (sums)
            work->sums = sums;
        if (!sectors || !sums)
            return error_memory("rim sectors");
        work->room = count;
    }
    work->count = count;
    memset(work->sums, 0, (size_t)count * SUMS * sizeof *work->sums);
    for (int k = 0; k < count; k++)
        work->sums[(size_t)k * SUMS + NEAREST] = INFINITY;
    return 0;
}

/* What one rim asks of the pixels around it. */
struct annulus {
    const struct photo *photo;
    const struct zone *zone;
    const struct rim *rim, *others;
    size_t other_count;
    const struct edge_settings *settings;
    double per_blur;     /* 1 / s */
    double shrink;       /* s^2 / (2 R) */
    double outer, inner; /* radii between which it lies */
    int near_frame;      /* some of the annulus may lie outside the zone */
};

/* Sum of the neighbours' profiles at a pixel; *depth: how deep inside the nearest, px. */
static double neighbour_profile(const struct annulus *ring, double x, double y, double *depth)
{
    double sum = 0, s = ring->settings->blur;
    *depth = -INFINITY;
    for (size_t k = 0; k < ring->other_count; k++) {
        const struct rim *other = &ring->others[k];
        double dx = x - other->x, dy = y - other->y,
               reach = other->radius + fabs(other->c2) + fabs(other->s2) + BLUR_REACH * s;
        double square = dx * dx + dy * dy;
        if (square > reach * reach)
            continue;
        double r = sqrt(square), rho = r > 0 ? r - rim_radius_at(other, dx / r, dy / r) : -other->radius;
        rho += s * s / (2 * other->radius);
        sum += profile_at(rho / s).step;
        *depth = -rho > *depth ? -rho : *depth;
    }
    return sum;
}

/* Two numbers that are multiplied at once; sums need no alignment of their own. */
typedef double pair __attribute__((vector_size(16)));
typedef double loose_pair __attribute__((vector_size(16), aligned(8), may_alias));

/* Products of the first 2 x `pairs` columns: the upper triangle, and what pairs of numbers bring along below it. */
static inline void add_triangle(const pair *row, int pairs, double *sums)
{
    for (int i = 0; i < pairs; i++)
        for (int half = 0; half < 2; half++) {
            loose_pair *line = (loose_pair *)(void *)(sums + (2 * i + half) * COLUMNS);
            const pair factor = {row[i][half], row[i][half]};
            for (int j = i; j < pairs; j++)
                line[j] += factor * row[j];
        }
}

/* Add one pixel's products to a sector. */
static void add_products(const struct annulus *ring, double t, double other, double grey, double *sums)
{
    const struct edge_settings *settings = ring->settings;
    struct profile profile = profile_at(t);
    double bell = profile.bell * ring->per_blur;
    const pair plain[PLAIN / 2] = {{1, profile.step}, {bell, grey}, {profile.near_rim, profile.deeper}};
    if (settings->texture > 0)
        add_triangle(plain, PLAIN / 2, sums);
    else
        add_triangle(plain, SIMPLE / 2, sums);
    sums[PIXELS] += 1;
    if (!(other > NEGLIGIBLE) && !settings->fit_blur)
        return;
    const double row[COLUMNS] = {1, profile.step, bell, grey, profile.near_rim, profile.deeper, other, t * bell};
    for (int i = 0; i <= NEIGHBOUR && other > NEGLIGIBLE; i++)
        sums[i * COLUMNS + NEIGHBOUR] += row[i] * other;
    for (int i = 0; i <= BLUR && settings->fit_blur; i++)
        sums[i * COLUMNS + BLUR] += row[i] * row[BLUR];
}

/* Angle of (x, y) as a share of the turn, 0 at -x, by a polynomial: right to 2e-5 turns. */
static double turn_of(double y, double x)
{
    double ax = fabs(x), ay = fabs(y), low = ax < ay ? ax : ay, high = ax < ay ? ay : ax, q = low / high, q2 = q * q;
    double a = q * (0.15914934 + q2 * (-0.05252893 + q2 * (0.02848955 + q2 * -0.01010790)));
    a = ay > ax ? 0.25 - a : a;
    a = x < 0 ? 0.5 - a : a;
    return 0.5 + (y < 0 ? -a : a);
}

static void add_pixel(const struct annulus *ring, int x, int y, double grey, struct edge_work *work)
{
    const struct rim *rim = ring->rim;
    double s = ring->settings->blur, dx = x - rim->x, dy = y - rim->y, r = sqrt(dx * dx + dy * dy);
    if (!(r > 0))
        return;
    double per_r = 1 / r, rho = r - rim_radius_at(rim, dx * per_r, dy * per_r) + ring->shrink;
    if (fabs(rho) > ring->settings->window)
        return;
    int k = (int)(turn_of(dy, dx) * work->count);
    k = k < 0 ? 0 : k >= work->count ? work->count - 1 : k;
    double *sums = work->sums + (size_t)k * SUMS, depth = -INFINITY;
    double other = sums[CROWDED] > 0 ? neighbour_profile(ring, x, y, &depth) : 0;
    /* The gap between the rims along this pixel's ray is about the distance outside the other less that outside ours.
     */
    if (rho > -s && rho - depth < sums[NEAREST])
        sums[NEAREST] = rho - depth;
    if (depth > INSIDE_OTHER * s)
        return;
    if (ring->near_frame) {
        double inside = zone_depth(ring->zone, x, y);
        if (rho > -s)
            sums[NEAREST] = fmin(sums[NEAREST], inside + rho);
        if (inside < OUTSIDE_ZONE * s)
            return;
    }
    add_products(ring, rho * ring->per_blur, other, grey, sums);
}

static void add_run(const struct annulus *ring, int y, double from, double to, struct edge_work *work)
{
    int x0 = (int)fmax(0, ceil(from)), x1 = (int)fmin(ring->photo->width - 1, floor(to));
    const uint16_t *row = photo_row(ring->photo, y);
    for (int x = x0; x <= x1; x++)
        add_pixel(ring, x, y, row[x], work);
}

/* The columns of one row that meet the annulus: from `hole` to `half` on both sides of the centre. */
static void row_of(const struct annulus *ring, int y, double *half, double *hole)
{
    double dy = y - ring->rim->y;
    *half = sqrt(fmax(0, ring->outer * ring->outer - dy * dy));
    *hole = fabs(dy) < ring->inner ? sqrt(ring->inner * ring->inner - dy * dy) : 0;
}

/* The pixels of a row are asked for some rows ahead: the photo is far larger than any cache. */
static void fetch(const struct annulus *ring, int y)
{
    const struct photo *photo = ring->photo;
    double half, hole, x = ring->rim->x;
    if (y >= photo->height)
        return;
    row_of(ring, y, &half, &hole);
    const double ends[] = {x - half, x - hole, x + hole, x + half};
    for (int k = 0; k < 4; k++)
        __builtin_prefetch(photo_row(photo, y) + (int)fmax(0, fmin(photo->width - 1, ends[k])));
}

static void add_annulus(const struct annulus *ring, struct edge_work *work)
{
    double x = ring->rim->x, y = ring->rim->y, half, hole;
    int y0 = (int)fmax(0, ceil(y - ring->outer)), y1 = (int)fmin(ring->photo->height - 1, floor(y + ring->outer));
    for (int row = y0; row <= y1; row++) {
        fetch(ring, row + AHEAD);
        row_of(ring, row, &half, &hole);
        if (hole > 0) {
            add_run(ring, row, x - half, x - hole, work);
            add_run(ring, row, x + hole, x + half, work);
        } else {
            add_run(ring, row, x - half, x + half, work);
        }
    }
}

/* Mark the sectors that a neighbour's blurred edge reaches. */
static void mark_crowded(const struct annulus *ring, struct edge_work *work)
{
    const struct rim *rim = ring->rim;
    double s = ring->settings->blur, outer = rim->radius + ring->settings->window + fabs(rim->c2) + fabs(rim->s2);
    for (size_t k = 0; k < ring->other_count; k++) {
        const struct rim *other = &ring->others[k];
        double dx = other->x - rim->x, dy = other->y - rim->y, d = hypot(dx, dy);
        double reach = other->radius + fabs(other->c2) + fabs(other->s2) + BLUR_REACH * s;
        /* Widest angle at which the circle of radius `outer` about the rim's centre meets the reach: law of cosines,
         * or tangent when the outer circle passes behind the neighbour's centre. */
        double cosine = d > 0 && outer * outer + reach * reach < d * d
                            ? (d * d + outer * outer - reach * reach) / (2 * d * outer)
                        : d > reach ? sqrt(1 - reach * reach / (d * d))
                                    : -1;
        double half = acos(fmax(-1, fmin(1, cosine))) / (2 * M_PI) * work->count + 1.5;
        double middle = turn_of(dy, dx) * work->count - 0.5;
        for (int i = (int)floor(middle - half); i <= (int)ceil(middle + half) && i < middle - half + work->count + 1;
             i++)
            work->sums[(size_t)(((i % work->count) + work->count) % work->count) * SUMS + CROWDED] = 1;
    }
}

/* Gauss-Jordan on a positive semidefinite n x n system with two right-hand sides (columns n and n + 1), in place;
 * 0 when it is singular. */
static int solve(int n, double m[][COLUMNS + 2])
{
    double scale[COLUMNS];
    for (int i = 0; i < n; i++)
        scale[i] = m[i][i];
    for (int i = 0; i < n; i++) {
        if (!(m[i][i] > 1e-8 * scale[i]))
            return 0;
        double pivot = 1 / m[i][i];
        for (int j = i; j < n + 2; j++)
            m[i][j] *= pivot;
        for (int k = 0; k < n; k++) {
            double factor = m[k][i];
            if (k != i)
                for (int j = i; j < n + 2; j++)
                    m[k][j] -= factor * m[i][j];
        }
    }
    return 1;
}

/* The void's level is known roughly; the texture terms are small. */
static void add_priors(double *sums, const struct edge_settings *settings)
{
    double weight = pow(settings->noise / settings->void_spread, 2), level = settings->void_level;
    sums[LEVEL_OUT * COLUMNS + LEVEL_OUT] += weight;
    sums[LEVEL_OUT * COLUMNS + GREY] += weight * level;
    sums[GREY * COLUMNS + GREY] += weight * level * level;
    if (settings->texture > 0) {
        double texture = 1 / (settings->texture * settings->texture);
        sums[TEXTURE_NEAR * COLUMNS + TEXTURE_NEAR] += texture;
        sums[TEXTURE_DEEP * COLUMNS + TEXTURE_DEEP] += texture;
    }
}

/* Small rims have neighbours all around: at most half of a rim counts as hidden, and at least LEAST_SEEN sectors are
 * seen. */
static double hidden_gap_of(const struct edge_work *work, double blur)
{
    double *gaps = work->sums + (size_t)work->count * SUMS; /* room behind the sums */
    for (int k = 0; k < work->count; k++)
        gaps[k] = work->sums[(size_t)k * SUMS + NEAREST];
    int seen = work->count - work->count / 2;
    seen = seen < LEAST_SEEN ? LEAST_SEEN : seen;
    return fmin(HIDDEN_GAP * blur, select_rank(gaps, (size_t)work->count, (size_t)(work->count - seen)));
}

static double product(const double *sums, int a, int b)
{
    return sums[a < b ? a * COLUMNS + b : b * COLUMNS + a];
}

/* Which columns a sector has; returns how many. */
static int choose_columns(const double *sums, const struct edge_settings *settings, int column[COLUMNS])
{
    int n = 0;
    column[n++] = LEVEL_OUT;
    column[n++] = STEP;
    column[n++] = SHIFT;
    if (settings->texture > 0) {
        column[n++] = TEXTURE_NEAR;
        column[n++] = TEXTURE_DEEP;
    }
    if (product(sums, NEIGHBOUR, NEIGHBOUR) > 1e-4)
        column[n++] = NEIGHBOUR;
    if (settings->fit_blur)
        column[n++] = BLUR;
    return n;
}

/* Least squares of one sector from its sums. */
static void fit_sector(double *sums, double hidden_gap, const struct edge_settings *settings, struct sector *sector)
{
    int column[COLUMNS], n = choose_columns(sums, settings, column), with_prior = settings->texture > 0 ? 2 : 0;
    double spare = sums[PIXELS] - (n - with_prior);
    sector->hidden = sums[NEAREST] < hidden_gap;
    if (sector->hidden || spare < 1)
        return;
    add_priors(sums, settings);
    double m[COLUMNS][COLUMNS + 2], square = product(sums, GREY, GREY);
    for (int i = 0; i < n; i++) {
        for (int j = 0; j < n; j++)
            m[i][j] = product(sums, column[i], column[j]);
        m[i][n] = product(sums, column[i], GREY);
        m[i][n + 1] = column[i] == SHIFT;
    }
    if (!solve(n, m))
        return;
    for (int i = 0; i < n; i++)
        square -= m[i][n] * product(sums, column[i], GREY);
    double step = m[STEP][n] + (settings->texture > 0 ? m[TEXTURE_NEAR][n] : 0);
    if (!(step > settings->least_step))
        return;
    sector->residual = fmax(square, 0) / spare;
    sector->step = step;
    sector->shift = m[SHIFT][n] / step;
    sector->variance = m[SHIFT][n + 1] / (step * step);
    sector->blur_error = settings->fit_blur ? m[n - 1][n] / step : 0;
    sector->used = isfinite(sector->shift) && fabs(sector->shift) < settings->window && sector->variance > 0;
}

int edge_fit(const struct photo *photo, const struct zone *zone, const struct rim *rim, const struct rim *others,
             size_t other_count, const struct edge_settings *settings, struct edge_work *work)
{
    int count = (int)fmax(LEAST_SECTORS, floor(2 * M_PI * rim->radius / settings->sector));
    if (make_room(work, count))
        return -1;
    profile_prepare();
    double s = settings->blur, reach = rim->radius + settings->window + 2 * s;
    struct annulus ring = {
        photo, zone, rim, others, other_count, settings, .per_blur = 1 / s, .shrink = s * s / (2 * rim->radius)};
    double bulge = fabs(rim->c2) + fabs(rim->s2) + settings->window;
    ring.outer = rim->radius + bulge;
    ring.inner = fmax(0, rim->radius - ring.shrink - bulge);
    ring.near_frame = zone->has_frame && zone_depth(zone, rim->x, rim->y) < reach;
    mark_crowded(&ring, work);
    add_annulus(&ring, work);
    double hidden_gap = hidden_gap_of(work, s);
    for (int k = 0; k < count; k++) {
        work->sectors[k] = (struct sector){.theta = 2 * M_PI * ((k + 0.5) / count - 0.5)};
        fit_sector(work->sums + (size_t)k * SUMS, hidden_gap, settings, &work->sectors[k]);
    }
    return 0;
}
