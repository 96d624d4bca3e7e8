#include "report/compare/match.h"

#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "pipeline/speak/error.h"

/* The points of b, sorted into square cells not smaller than the longest reach. */
struct grid {
    double x0, y0, size;
    long columns, rows;
    size_t *first; /* columns * rows + 2: the points of cell c are first[c] ... first[c + 1] - 1 */
    size_t *point; /* rows of b, cell by cell */
};

struct pair {
    double distance;
    size_t a, b;
};

struct pairs {
    struct pair *list;
    size_t count, capacity;
};

/* Further out no differences could be told from infinity. */
#define FARTHEST 1e150

static int is_placed(const struct match_points *p, size_t k)
{
    return fabs(p->x[k]) < FARTHEST && fabs(p->y[k]) < FARTHEST; /* NaN is not */
}

static void grid_free(struct grid *grid)
{
    free(grid->first);
    free(grid->point);
}

/* About as many cells as points at most, however far some of them lie. */
static void grid_measure(struct grid *grid, const struct match_points *b, const double *radius)
{
    double x1 = -INFINITY, y1 = -INFINITY, reach = 0;
    grid->x0 = grid->y0 = INFINITY;
    for (size_t k = 0; k < b->count; k++) {
        if (!is_placed(b, k))
            continue;
        grid->x0 = fmin(grid->x0, b->x[k]);
        grid->y0 = fmin(grid->y0, b->y[k]);
        x1 = fmax(x1, b->x[k]);
        y1 = fmax(y1, b->y[k]);
        if (isfinite(radius[k]))
            reach = fmax(reach, 0.5 * radius[k]);
    }
    double longest = fmax(x1 - grid->x0, y1 - grid->y0), most = sqrt((double)b->count) + 1;
    int some = isfinite(longest);
    grid->size = some ? fmax(fmax(reach, longest / most), 1e-300) : 1;
    grid->columns = some ? (long)((x1 - grid->x0) / grid->size) + 1 : 1;
    grid->rows = some ? (long)((y1 - grid->y0) / grid->size) + 1 : 1;
}

static size_t cell_of(const struct grid *grid, double x, double y)
{
    return (size_t)((y - grid->y0) / grid->size) * (size_t)grid->columns + (size_t)((x - grid->x0) / grid->size);
}

static int grid_fill(struct grid *grid, const struct match_points *b)
{
    size_t cells = (size_t)grid->columns * (size_t)grid->rows;
    grid->first = calloc(cells + 2, sizeof *grid->first);
    grid->point = calloc(b->count + 1, sizeof *grid->point);
    if (!grid->first || !grid->point)
        return error_memory("matching of grains");
    for (size_t k = 0; k < b->count; k++)
        if (is_placed(b, k))
            grid->first[cell_of(grid, b->x[k], b->y[k]) + 2]++;
    for (size_t c = 2; c < cells + 2; c++)
        grid->first[c] += grid->first[c - 1];
    for (size_t k = 0; k < b->count; k++)
        if (is_placed(b, k))
            grid->point[grid->first[cell_of(grid, b->x[k], b->y[k]) + 1]++] = k;
    return 0;
}

static int add_pair(struct pairs *pairs, size_t a, size_t b, double distance)
{
    if (pairs->count == pairs->capacity) {
        size_t capacity = pairs->capacity ? 2 * pairs->capacity : 256;
        struct pair *list = realloc(pairs->list, capacity * sizeof *list);
        if (!list)
            return error_memory("matching of grains");
        pairs->list = list;
        pairs->capacity = capacity;
    }
    pairs->list[pairs->count++] = (struct pair){distance, a, b};
    return 0;
}

/* Every point of b within reach of point k of a. */
static int look_around(const struct grid *grid, const struct match_points *a, size_t k, const struct match_points *b,
                       const double *radius, struct pairs *pairs)
{
    double column = floor((a->x[k] - grid->x0) / grid->size), row = floor((a->y[k] - grid->y0) / grid->size);
    for (double r = fmax(row - 1, 0); r <= fmin(row + 1, (double)grid->rows - 1); r++)
        for (double c = fmax(column - 1, 0); c <= fmin(column + 1, (double)grid->columns - 1); c++) {
            size_t cell = (size_t)r * (size_t)grid->columns + (size_t)c;
            for (size_t p = grid->first[cell]; p < grid->first[cell + 1]; p++) {
                size_t m = grid->point[p];
                double distance = hypot(a->x[k] - b->x[m], a->y[k] - b->y[m]);
                if (distance < 0.5 * radius[m] && add_pair(pairs, k, m, distance))
                    return -1;
            }
        }
    return 0;
}

static int by_distance(const void *left, const void *right)
{
    const struct pair *p = left, *q = right;
    if (p->distance != q->distance)
        return p->distance < q->distance ? -1 : 1;
    if (p->a != q->a)
        return p->a < q->a ? -1 : 1;
    return (p->b > q->b) - (p->b < q->b);
}

static int take_nearest_first(struct pairs *pairs, size_t count_a, size_t count_b, long *b_of_a)
{
    char *taken = calloc(count_b + 1, 1);
    if (!taken)
        return error_memory("matching of grains");
    if (pairs->count)
        qsort(pairs->list, pairs->count, sizeof *pairs->list, by_distance);
    for (size_t k = 0; k < count_a; k++)
        b_of_a[k] = -1;
    for (size_t p = 0; p < pairs->count; p++) {
        const struct pair *pair = &pairs->list[p];
        if (b_of_a[pair->a] >= 0 || taken[pair->b])
            continue;
        b_of_a[pair->a] = (long)pair->b;
        taken[pair->b] = 1;
    }
    free(taken);
    return 0;
}

int match_grains(const struct match_points *a, const struct match_points *b, const double *radius_b, long *b_of_a)
{
    struct grid grid = {0};
    struct pairs pairs = {0};
    grid_measure(&grid, b, radius_b);
    int result = grid_fill(&grid, b);
    for (size_t k = 0; k < a->count && result == 0; k++)
        if (is_placed(a, k))
            result = look_around(&grid, a, k, b, radius_b, &pairs);
    if (result == 0)
        result = take_nearest_first(&pairs, a->count, b->count, b_of_a);
    grid_free(&grid);
    free(pairs.list);
    return result;
}
