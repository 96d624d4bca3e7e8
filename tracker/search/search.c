/* The blind search. For a disc of n pixels, with p the reference's values turned by an angle, less their mean and of
 * unit norm, and w the photo's values under the disc at one position,
 *
 *     ZNCC = sum p w / sqrt(sum w^2 - (sum w)^2 / n),
 *
 * since sum p = 0 takes the mean of w off by itself (Lewis, Fast normalized cross-correlation, 1995). The two sums of w
 * do not depend on the angle and are made once. Loops run over the disc's pixels outside and over positions inside:
 * whole rows of positions at a time, which compilers vectorise; the disc is small on its level, so that this beats
 * transforms.
 *
 * Angles are as far apart as move the rim by angle_step pixels, positions by one pixel of the level: a true place falls
 * at most half of either short of its top, and IC-GN does the rest. */
#include "tracker/search/search.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "pipeline/speak/error.h"

static const double smallest_radius = 8; /* px, of the disc on the level that is searched */
static const double angle_step = 0.7;    /* px, that the rim moves from one angle to the next */

/* The grid of shifts (whole pixels of the level) and what is correlated on it. */
struct grid {
    int x0, y0, side;          /* shift of the first position, positions per row and column */
    int reach;                 /* of the disc, px */
    int width;                 /* of the window: side + 2 reach */
    float *window;             /* the photo around all positions, less its mean */
    float *dot, *sum, *square; /* side * side each */
    float *pattern;            /* the disc's values, turned; (2 reach + 1)^2, 0 outside */
};

static int clamp(int i, int n)
{
    return i < 0 ? 0 : i >= n ? n - 1 : i;
}

static int grid_alloc(struct grid *grid, struct search_workspace *workspace)
{
    size_t window = (size_t)grid->width * (size_t)grid->width, cells = (size_t)grid->side * (size_t)grid->side;
    size_t disc = (size_t)(2 * grid->reach + 1), needed = window + 3 * cells + disc * disc;
    if (workspace->capacity < needed) {
        float *grown = realloc(workspace->values, needed * sizeof *grown);
        if (!grown)
            return error_memory("the window of a search");
        workspace->values = grown;
        workspace->capacity = needed;
    }
    grid->window = workspace->values;
    grid->dot = grid->window + window;
    grid->sum = grid->dot + cells;
    grid->square = grid->sum + cells;
    grid->pattern = grid->square + cells;
    return 0;
}

/* Position (i, j) of the grid puts the disc's centre at (x0 + i, y0 + j): integers, the pattern takes the fraction. */
static void load_window(const struct photo *photo, const struct grid *grid)
{
    double total = 0;
    size_t n = (size_t)grid->width * (size_t)grid->width;
    for (int j = 0; j < grid->width; j++) {
        const uint16_t *row = photo_row(photo, clamp(grid->y0 - grid->reach + j, photo->height));
        for (int i = 0; i < grid->width; i++)
            total += grid->window[(size_t)j * (size_t)grid->width + (size_t)i] =
                row[clamp(grid->x0 - grid->reach + i, photo->width)];
    }
    for (size_t k = 0; k < n; k++)
        grid->window[k] -= (float)(total / (double)n);
}

static int in_disc(int dx, int dy, double radius)
{
    return dx * dx + dy * dy <= radius * radius;
}

/* out(position) += weight * window(position + (dx, dy)) over the whole grid. */
static void add_shifted(const struct grid *grid, int dx, int dy, float weight, float *restrict out)
{
    for (int j = 0; j < grid->side; j++) {
        const float *restrict in =
            grid->window + (size_t)(j + grid->reach + dy) * (size_t)grid->width + (size_t)(grid->reach + dx);
        float *restrict to = out + (size_t)j * (size_t)grid->side;
        for (int i = 0; i < grid->side; i++)
            to[i] += weight * in[i];
    }
}

static void add_shifted_square(const struct grid *grid, int dx, int dy)
{
    for (int j = 0; j < grid->side; j++) {
        const float *restrict in =
            grid->window + (size_t)(j + grid->reach + dy) * (size_t)grid->width + (size_t)(grid->reach + dx);
        float *restrict sum = grid->sum + (size_t)j * (size_t)grid->side;
        float *restrict square = grid->square + (size_t)j * (size_t)grid->side;
        for (int i = 0; i < grid->side; i++) {
            sum[i] += in[i];
            square[i] += in[i] * in[i];
        }
    }
}

/* Sums and squares under the disc, the same for every angle; returns the disc's pixels. */
static int sum_window(const struct grid *grid, double radius)
{
    size_t cells = (size_t)grid->side * (size_t)grid->side;
    int count = 0;
    memset(grid->sum, 0, 2 * cells * sizeof *grid->sum); /* square follows sum */
    for (int dy = -grid->reach; dy <= grid->reach; dy++)
        for (int dx = -grid->reach; dx <= grid->reach; dx++)
            if (in_disc(dx, dy, radius)) {
                add_shifted_square(grid, dx, dy);
                count++;
            }
    return count;
}

static double bilinear(const struct photo *photo, double x, double y)
{
    int ix = (int)floor(x), iy = (int)floor(y);
    double fx = x - ix, fy = y - iy;
    const uint16_t *above = photo_row(photo, clamp(iy, photo->height));
    const uint16_t *below = photo_row(photo, clamp(iy + 1, photo->height));
    int left = clamp(ix, photo->width), right = clamp(ix + 1, photo->width);
    return (1 - fy) * ((1 - fx) * above[left] + fx * above[right]) + fy * ((1 - fx) * below[left] + fx * below[right]);
}

/* The reference as it looks turned by `angle`, zero mean and unit norm; 0 when it is flat. */
static int turn_pattern(const struct photo *reference, const struct shape *shape, double angle, const struct grid *grid)
{
    const double c = cos(angle), s = sin(angle);
    const int side = 2 * grid->reach + 1;
    double total = 0, energy = 0;
    int count = 0;
    for (int dy = -grid->reach; dy <= grid->reach; dy++)
        for (int dx = -grid->reach; dx <= grid->reach; dx++)
            if (in_disc(dx, dy, shape->radius)) {
                double grey = bilinear(reference, shape->cx + c * dx - s * dy, shape->cy + s * dx + c * dy);
                grid->pattern[(dy + grid->reach) * side + dx + grid->reach] = (float)grey;
                total += grey;
                count++;
            }
    float mean = (float)(total / count);
    for (int pass = 0; pass < 2; pass++) {
        float scale = pass && energy > 0 ? (float)(1 / sqrt(energy)) : 1;
        for (int dy = -grid->reach; dy <= grid->reach; dy++)
            for (int dx = -grid->reach; dx <= grid->reach; dx++)
                if (in_disc(dx, dy, shape->radius)) {
                    float *p = &grid->pattern[(dy + grid->reach) * side + dx + grid->reach];
                    *p = pass ? *p * scale : *p - mean;
                    energy += pass ? 0 : (double)*p * *p;
                }
    }
    return energy > 0;
}

static void correlate(const struct grid *grid, double radius)
{
    const int side = 2 * grid->reach + 1;
    memset(grid->dot, 0, (size_t)grid->side * (size_t)grid->side * sizeof *grid->dot);
    for (int dy = -grid->reach; dy <= grid->reach; dy++)
        for (int dx = -grid->reach; dx <= grid->reach; dx++)
            if (in_disc(dx, dy, radius))
                add_shifted(grid, dx, dy, grid->pattern[(dy + grid->reach) * side + dx + grid->reach], grid->dot);
}

/* Places found so far, best first; neighbours (closer than 2 px and two angles) share one entry. */
struct best {
    int count;
    struct search_place places[SEARCH_CANDIDATES];
    double near_px, near_angle;
};

static int same_place(const struct best *best, const struct motion *a, const struct motion *b)
{
    return fabs(a->u - b->u) <= best->near_px && fabs(a->v - b->v) <= best->near_px &&
           motion_turn(a, b) <= best->near_angle;
}

static void offer(struct best *best, struct search_place place)
{
    int k = 0, end;
    for (; k < best->count && best->places[k].zncc >= place.zncc; k++)
        if (same_place(best, &best->places[k].motion, &place.motion))
            return;
    for (end = k; end < best->count; end++) /* a worse entry of the same place gives way */
        if (same_place(best, &best->places[end].motion, &place.motion))
            break;
    if (end == SEARCH_CANDIDATES)
        end--;
    if (k > end)
        return;
    if (end == best->count)
        best->count++;
    memmove(&best->places[k + 1], &best->places[k], (size_t)(end - k) * sizeof *best->places);
    best->places[k] = place;
}

static void offer_all(const struct grid *grid, const struct shape *shape, double angle, int pixels, struct best *best)
{
    for (int j = 0; j < grid->side; j++)
        for (int i = 0; i < grid->side; i++) {
            size_t k = (size_t)j * (size_t)grid->side + (size_t)i;
            double spread = grid->square[k] - (double)grid->sum[k] * grid->sum[k] / pixels;
            double zncc = spread > 0 ? grid->dot[k] / sqrt(spread) : 0;
            if (zncc > 0 && (best->count < SEARCH_CANDIDATES || zncc > best->places[best->count - 1].zncc))
                offer(best, (struct search_place){{grid->x0 + i - shape->cx, grid->y0 + j - shape->cy, angle}, zncc});
        }
}

/* Every shift and angle in reach, on one level. */
static int scan(const struct photo *reference, const struct photo *photo, const struct shape *shape,
                struct motion around, const struct search_reach *reach, struct search_workspace *workspace,
                struct best *best)
{
    int half = (int)ceil(reach->px);
    struct grid grid = {.side = 2 * half + 1, .reach = (int)floor(shape->radius)};
    grid.x0 = (int)floor(shape->cx + around.u + 0.5) - half;
    grid.y0 = (int)floor(shape->cy + around.v + 0.5) - half;
    grid.width = grid.side + 2 * grid.reach;
    if (grid_alloc(&grid, workspace))
        return -1;
    load_window(photo, &grid);
    int pixels = sum_window(&grid, shape->radius), steps = (int)ceil(reach->angle * shape->radius / angle_step);
    double step = steps ? reach->angle / steps : 0;
    best->near_px = 2;
    best->near_angle = 2.5 * step;
    for (int k = -steps; k <= steps; k++) {
        double angle = around.angle + k * step;
        if (!turn_pattern(reference, shape, angle, &grid))
            return 0;
        correlate(&grid, shape->radius);
        offer_all(&grid, shape, angle, pixels, best);
    }
    return 0;
}

/* IC-GN on this level; a place from which it does not converge stays where it is. */
static int refine(const struct photo *reference, const struct photo *photo, const struct shape *shape, double reach,
                  struct search_workspace *workspace, struct best *best)
{
    const struct icgn_options options = {.tolerance = 0.02, .reach = reach, .iterations = 12, .coarse = 1};
    struct subset subset;
    int status = subset_build(reference, shape, NULL, &subset);
    for (int k = 0; !status && k < best->count && subset_usable(&subset); k++) {
        struct fit fit;
        status = icgn_fit(&subset, photo, best->places[k].motion, &options, &workspace->patch, &fit);
        if (!status && fit.converged)
            best->places[k] = (struct search_place){fit.motion, fit.zncc};
    }
    subset_free(&subset);
    return status;
}

/* Sort, and let places that met in the same optimum be one. */
static void tidy(struct best *best, double near_px, double near_angle)
{
    struct best sorted = {.near_px = near_px, .near_angle = near_angle};
    for (int k = 0; k < best->count; k++)
        offer(&sorted, best->places[k]);
    *best = sorted;
}

static int level_for(const struct shape *shape, const struct pyramid *reference, const struct pyramid *photo)
{
    int level = 0, top = reference->count < photo->count ? reference->count : photo->count;
    while (level + 1 < top && ldexp(shape->radius, -(level + 1)) >= smallest_radius)
        level++;
    return level;
}

int search_places(const struct pyramid *reference, const struct pyramid *photo, const struct shape *shape,
                  struct motion around, const struct search_reach *reach, struct search_workspace *workspace,
                  struct search_place places[SEARCH_CANDIDATES], int *count)
{
    int level = level_for(shape, reference, photo);
    struct shape small = pyramid_shape(shape, level);
    struct search_reach near = {ldexp(reach->px, -level), reach->angle};
    struct best best = {0};
    *count = 0;
    if (shape->half_w > 0) /* a rectangle is searched by the disc inside it */
        small.radius = ldexp(fmin(shape->half_w, shape->half_h), -level);
    small.half_w = small.half_h = 0;
    if (scan(&reference->levels[level], &photo->levels[level], &small, pyramid_motion_down(around, level), &near,
             workspace, &best))
        return -1;
    for (int k = level; k >= 0 && best.count; k--) {
        if (k > 0 || level == 0) {
            struct shape disc = pyramid_shape(
                &(struct shape){.cx = shape->cx, .cy = shape->cy, .radius = ldexp(small.radius, level)}, k);
            if (refine(&reference->levels[k], &photo->levels[k], &disc, 3, workspace, &best))
                return -1;
            tidy(&best, 1, 2 / disc.radius);
        }
        for (int i = 0; i < best.count && k > 0; i++)
            best.places[i].motion = pyramid_motion_up(best.places[i].motion, 1);
    }
    memcpy(places, best.places, sizeof best.places);
    *count = best.count;
    return 0;
}

void search_workspace_free(struct search_workspace *workspace)
{
    free(workspace->values);
    patch_free(&workspace->patch);
    *workspace = (struct search_workspace){0};
}
