#include "findgrains/edge_fit.h"

#include "pipeline/error.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { LEVEL_OUT, STEP, SHIFT, NEIGHBOUR, BLUR, GREY, COLUMNS };
enum { PRODUCTS = COLUMNS * COLUMNS, PIXELS = PRODUCTS, NEAREST, SUMS };

#define HIDDEN_GAP 1.2    /* blurs: a sector whose rim is nearer to a neighbour's than this tells nothing */
#define LEAST_SECTORS 8.0 /* of a rim */
#define LEAST_SEEN 7
#define INSIDE_OTHER 1.0 /* blurs: pixels deeper than this inside a neighbour are left out */
#define OUTSIDE_ZONE 1.0 /* blurs: pixels nearer than this to the frame are left out */

double rim_radius_at(const struct rim *rim, double c, double s)
{
    return rim->radius + rim->c2 * (c * c - s * s) + rim->s2 * 2 * c * s;
}

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

static double normal_cdf(double t)
{
    return 0.5 * erfc(-t * M_SQRT1_2);
}

static double normal_pdf(double t)
{
    return 0.3989422804014327 * exp(-0.5 * t * t);
}

struct annulus {
    const struct photo *photo;
    const struct zone *zone;
    const struct rim *rim, *others;
    size_t other_count;
    const struct edge_settings *settings;
    double shrink;  /* s^2 / (2 R) */
    int near_frame; /* some of the annulus may lie outside the zone */
};

/* Sum of the neighbours' profiles at a pixel; *depth: how deep inside the nearest, px. */
static double neighbour_profile(const struct annulus *ring, double x, double y, double *depth)
{
    double sum = 0, s = ring->settings->blur;
    *depth = -INFINITY;
    for (size_t k = 0; k < ring->other_count; k++) {
        const struct rim *other = &ring->others[k];
        double dx = x - other->x, dy = y - other->y, reach = other->radius + fabs(other->c2) + fabs(other->s2) + 5 * s;
        double square = dx * dx + dy * dy;
        if (square > reach * reach)
            continue;
        double r = sqrt(square), rho = r > 0 ? r - rim_radius_at(other, dx / r, dy / r) : -other->radius;
        rho += s * s / (2 * other->radius);
        sum += normal_cdf(-rho / s);
        *depth = fmax(*depth, -rho);
    }
    return sum;
}

static void add_pixel(const struct annulus *ring, int x, int y, double grey, struct edge_work *work)
{
    const struct rim *rim = ring->rim;
    double s = ring->settings->blur, dx = x - rim->x, dy = y - rim->y, r = sqrt(dx * dx + dy * dy);
    if (!(r > 0))
        return;
    double rho = r - rim_radius_at(rim, dx / r, dy / r) + ring->shrink;
    if (fabs(rho) > ring->settings->window)
        return;
    int k = (int)((atan2(dy, dx) / (2 * M_PI) + 0.5) * work->count);
    k = k < 0 ? 0 : k >= work->count ? work->count - 1 : k;
    double *sums = work->sums + (size_t)k * SUMS, depth = -INFINITY;
    double other = ring->other_count ? neighbour_profile(ring, x, y, &depth) : 0;
    /* The gap between the rims along this pixel's ray is about the distance outside the other less that outside ours.
     */
    if (rho > -s)
        sums[NEAREST] = fmin(sums[NEAREST], -depth + rho);
    if (depth > INSIDE_OTHER * s)
        return;
    if (ring->near_frame) {
        double inside = zone_depth(ring->zone, x, y);
        if (rho > -s)
            sums[NEAREST] = fmin(sums[NEAREST], inside + rho);
        if (inside < OUTSIDE_ZONE * s)
            return;
    }
    double t = rho / s, bell = normal_pdf(t) / s;
    double row[COLUMNS] = {1, normal_cdf(-t), bell, other, t * bell, grey};
    for (int i = 0; i < COLUMNS; i++)
        for (int j = i; j < COLUMNS; j++)
            sums[i * COLUMNS + j] += row[i] * row[j];
    sums[PIXELS] += 1;
}

static void add_run(const struct annulus *ring, int y, double from, double to, struct edge_work *work)
{
    int x0 = (int)fmax(0, ceil(from)), x1 = (int)fmin(ring->photo->width - 1, floor(to));
    const uint16_t *row = photo_row(ring->photo, y);
    for (int x = x0; x <= x1; x++)
        add_pixel(ring, x, y, row[x], work);
}

static void add_annulus(const struct annulus *ring, struct edge_work *work)
{
    const struct rim *rim = ring->rim;
    double bulge = fabs(rim->c2) + fabs(rim->s2) + ring->settings->window;
    double outer = rim->radius + bulge, inner = fmax(0, rim->radius - ring->shrink - bulge);
    int y0 = (int)fmax(0, ceil(rim->y - outer)), y1 = (int)fmin(ring->photo->height - 1, floor(rim->y + outer));
    for (int y = y0; y <= y1; y++) {
        double dy = y - rim->y, half = sqrt(fmax(0, outer * outer - dy * dy));
        double hole = fabs(dy) < inner ? sqrt(inner * inner - dy * dy) : 0;
        if (hole > 0) {
            add_run(ring, y, rim->x - half, rim->x - hole, work);
            add_run(ring, y, rim->x + hole, rim->x + half, work);
        } else {
            add_run(ring, y, rim->x - half, rim->x + half, work);
        }
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

/* The void's level is known roughly; a neighbour's step is about as high as other steps, or half or twice that. */
static void add_priors(double *sums, const struct edge_settings *settings)
{
    double noise2 = settings->noise * settings->noise,
           weight = noise2 / (settings->void_spread * settings->void_spread);
    sums[LEVEL_OUT * COLUMNS + LEVEL_OUT] += weight;
    sums[LEVEL_OUT * COLUMNS + GREY] += weight * settings->void_level;
    sums[GREY * COLUMNS + GREY] += weight * settings->void_level * settings->void_level;
}

static int ascending(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* Small rims have neighbours all around: at most half of a rim counts as hidden, and at least LEAST_SEEN sectors are
 * seen. */
static double hidden_gap_of(const struct edge_work *work, double blur)
{
    double *gaps = work->sums + (size_t)work->count * SUMS; /* room behind the sums */
    for (int k = 0; k < work->count; k++)
        gaps[k] = work->sums[(size_t)k * SUMS + NEAREST];
    qsort(gaps, (size_t)work->count, sizeof *gaps, ascending);
    int seen = work->count - work->count / 2;
    seen = seen < LEAST_SEEN ? LEAST_SEEN : seen;
    return fmin(HIDDEN_GAP * blur, gaps[work->count - seen]);
}

/* Least squares of one sector from its sums. */
static void fit_sector(double *sums, double hidden_gap, const struct edge_settings *settings, struct sector *sector)
{
    int active[COLUMNS], n = 0;
    active[n++] = LEVEL_OUT;
    active[n++] = STEP;
    int shift_at = n;
    active[n++] = SHIFT;
    if (sums[NEIGHBOUR * COLUMNS + NEIGHBOUR] > 1e-4)
        active[n++] = NEIGHBOUR;
    int blur_at = n;
    if (settings->fit_blur)
        active[n++] = BLUR;
    sector->hidden = sums[NEAREST] < hidden_gap;
    double pixels = sums[PIXELS];
    if (sector->hidden || pixels < n + 1)
        return;
    add_priors(sums, settings);
    double m[COLUMNS][COLUMNS + 2];
    for (int i = 0; i < n; i++) {
        for (int j = 0; j < n; j++)
            m[i][j] =
                active[i] <= active[j] ? sums[active[i] * COLUMNS + active[j]] : sums[active[j] * COLUMNS + active[i]];
        m[i][n] = sums[active[i] * COLUMNS + GREY];
        m[i][n + 1] = i == shift_at;
    }
    if (!solve(n, m))
        return;
    double square = sums[GREY * COLUMNS + GREY];
    for (int i = 0; i < n; i++)
        square -= m[i][n] * sums[active[i] * COLUMNS + GREY];
    double step = m[1][n];
    if (!(step > settings->least_step))
        return;
    sector->residual = fmax(square, 0) / (pixels - n);
    sector->step = step;
    sector->shift = m[shift_at][n] / step;
    sector->variance = m[shift_at][n + 1] / (step * step); /* times the residual's variance: the caller's choice */
    sector->blur_error = settings->fit_blur ? m[blur_at][n] / step : 0;
    sector->used = isfinite(sector->shift) && fabs(sector->shift) < settings->window && sector->variance > 0;
}

int edge_fit(const struct photo *photo, const struct zone *zone, const struct rim *rim, const struct rim *others,
             size_t other_count, const struct edge_settings *settings, struct edge_work *work)
{
    int count = (int)fmax(LEAST_SECTORS, floor(2 * M_PI * rim->radius / settings->sector));
    if (make_room(work, count))
        return -1;
    double s = settings->blur, reach = rim->radius + settings->window + 2 * s;
    struct annulus ring = {photo, zone, rim, others, other_count, settings, .shrink = s * s / (2 * rim->radius)};
    ring.near_frame = zone->has_frame && zone_depth(zone, rim->x, rim->y) < reach;
    add_annulus(&ring, work);
    double hidden_gap = hidden_gap_of(work, s);
    for (int k = 0; k < count; k++) {
        work->sectors[k] = (struct sector){.theta = 2 * M_PI * ((k + 0.5) / count - 0.5)};
        fit_sector(work->sums + (size_t)k * SUMS, hidden_gap, settings, &work->sectors[k]);
    }
    return 0;
}
