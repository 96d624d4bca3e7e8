/* Greedy matching: all pairs within reach are listed, then taken from the nearest on, as long as both grains are
 * free. Half a radius is less than half the distance of two discs that touch, so that a grain seldom has more than
 * one candidate, and the order of taking seldom matters. A grid of cells as wide as the longest reach keeps it O(n
 * log n). Equal distances are ordered by row: the result does not depend on qsort(). */
#include "report/compare/match.h"

#include <math.h>
#include <stdlib.h>

#include "pipeline/numbers/cell_grid.h"
#include "pipeline/speak/error.h"

/* A row of a and a row of b within reach of each other, and their distance in the unit of the points. */
struct pair {
    double distance;
    size_t a, b;
};

/* A growing list; `list` is freed by match_grains(). */
struct pairs {
    struct pair *list;
    size_t count, capacity;
};

/* The points of b, in cells as wide as the longest reach. */
static int grid_fill(struct cell_grid *grid, const struct match_points *b, const double *radius)
{
    double reach = 0;
    for (size_t k = 0; k < b->count; k++)
        if (isfinite(radius[k]))
            reach = fmax(reach, 0.5 * radius[k]);
    if (cell_grid_open(grid, b->count, fmax(reach, 1e-300)))
        return -1;
    for (size_t k = 0; k < b->count; k++)
        cell_grid_add(grid, k, b->x[k], b->y[k]);
    return 0;
}

/* -1 without memory; the list stays as it was. */
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
static int look_around(const struct cell_grid *grid, const struct match_points *a, size_t k,
                       const struct match_points *b, const double *radius, struct pairs *pairs)
{
    struct cell_search search = cell_grid_near(grid, a->x[k], a->y[k], grid->size);
    for (size_t m; (m = cell_grid_next(&search)) != CELL_GRID_END;) {
        double distance = hypot(a->x[k] - b->x[m], a->y[k] - b->y[m]);
        if (distance < 0.5 * radius[m] && add_pair(pairs, k, m, distance))
            return -1;
    }
    return 0;
}

/* Ties by row of a, then of b, so that the order is total. */
static int by_distance(const void *left, const void *right)
{
    const struct pair *p = left, *q = right;
    if (p->distance != q->distance)
        return p->distance < q->distance ? -1 : 1;
    if (p->a != q->a)
        return p->a < q->a ? -1 : 1;
    return (p->b > q->b) - (p->b < q->b);
}

/* Sorts the pairs. b_of_a[k]: the row of b, or -1. -1 without memory. */
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
    struct cell_grid grid = {0};
    struct pairs pairs = {0};
    int result = grid_fill(&grid, b, radius_b);
    for (size_t k = 0; k < a->count && result == 0; k++)
        if (fabs(a->x[k]) < CELL_GRID_FARTHEST && fabs(a->y[k]) < CELL_GRID_FARTHEST)
            result = look_around(&grid, a, k, b, radius_b, &pairs);
    if (result == 0)
        result = take_nearest_first(&pairs, a->count, b->count, b_of_a);
    cell_grid_free(&grid);
    free(pairs.list);
    return result;
}
