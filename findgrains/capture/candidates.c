/* Thinning: best first, and a candidate stays only where no better one stands too near. With the order fixed by merit
 * and then by position the result does not depend on the order in which threads or windows found them. */
#include "findgrains/capture/candidates.h"

#include "pipeline/numbers/cell_grid.h"
#include "pipeline/speak/error.h"

#include <math.h>
#include <stdlib.h>

#define CHANCE 0.3 /* support below which nothing is a rim */

int candidates_add(struct candidates *list, const struct candidate *item)
{
    if (list->count == list->room) {
        size_t room = list->room ? 2 * list->room : 256;
        struct candidate *items = realloc(list->items, room * sizeof *items);
        if (!items)
            return error_memory("list of candidates");
        list->items = items;
        list->room = room;
    }
    list->items[list->count++] = *item;
    return 0;
}

void candidates_free(struct candidates *list)
{
    free(list->items);
    *list = (struct candidates){0};
}

static int three_way(double a, double b)
{
    return (a > b) - (a < b);
}

/* For qsort(): by merit; equal ones by place, so that the order is total. */
static int better_first(const void *left, const void *right)
{
    const struct candidate *a = left, *b = right;
    int order = three_way(b->merit, a->merit);
    if (!order)
        order = three_way(a->rim.y, b->rim.y);
    if (!order)
        order = three_way(a->rim.x, b->rim.x);
    return order ? order : three_way(a->rim.radius, b->rim.radius);
}

/* No kept circle is nearer than `share` of the sum of the radii. */
static int clear_of(const struct candidates *list, const struct cell_grid *kept, double largest, const struct rim *rim,
                    double share)
{
    struct cell_search search = cell_grid_near(kept, rim->x, rim->y, share * (rim->radius + largest));
    for (size_t k = cell_grid_next(&search); k != CELL_GRID_END; k = cell_grid_next(&search)) {
        const struct rim *other = &list->items[k].rim;
        double reach = share * (rim->radius + other->radius), dx = rim->x - other->x, dy = rim->y - other->y;
        if (dx * dx + dy * dy < reach * reach)
            return 0;
    }
    return 1;
}

double candidates_support(const struct candidate *item)
{
    return item->support;
}

double candidates_merit(const struct candidate *item)
{
    return (item->support - CHANCE) * sqrt(item->rim.radius);
}

int candidates_thin(struct candidates *list, double share, double (*merit)(const struct candidate *))
{
    struct cell_grid grid;
    double largest = 0;
    size_t kept = 0;
    if (list->count == 0)
        return 0;
    for (size_t k = 0; k < list->count; k++) {
        list->items[k].merit = merit(&list->items[k]);
        largest = fmax(largest, list->items[k].rim.radius);
    }
    qsort(list->items, list->count, sizeof *list->items, better_first);
    int status = cell_grid_open(&grid, list->count, fmax(2 * share * largest, 1e-9));
    for (size_t k = 0; k < list->count && !status; k++) {
        const struct rim *rim = &list->items[k].rim;
        if (!clear_of(list, &grid, largest, rim, share))
            continue;
        cell_grid_add(&grid, kept, rim->x, rim->y);
        list->items[kept++] = list->items[k];
    }
    list->count = status ? list->count : kept;
    cell_grid_free(&grid);
    return status;
}
