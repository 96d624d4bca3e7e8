#include "findgrains/capture/candidates.h"

#include "pipeline/speak/error.h"

#include <math.h>
#include <stdint.h>
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

/* Kept candidates by square cells that are as wide as any two of them have to be apart: lists through `next`, whose
 * ends are NONE. */
struct cells {
    double x0, y0, side;
    size_t columns, rows, *first, *next;
};
enum { MOST_CELLS = 1024 };
#define NONE SIZE_MAX

static size_t cell_of(double at, double from, double side, size_t count)
{
    double k = (at - from) / side;
    return k > 0 ? (size_t)fmin(k, (double)(count - 1)) : 0;
}

static int cells_make(const struct candidates *list, double share, struct cells *cells)
{
    double x1 = -INFINITY, y1 = -INFINITY, radius = 0;
    *cells = (struct cells){.x0 = INFINITY, .y0 = INFINITY};
    for (size_t k = 0; k < list->count; k++) {
        const struct rim *rim = &list->items[k].rim;
        cells->x0 = fmin(cells->x0, rim->x);
        cells->y0 = fmin(cells->y0, rim->y);
        x1 = fmax(x1, rim->x);
        y1 = fmax(y1, rim->y);
        radius = fmax(radius, rim->radius);
    }
    cells->side = fmax(2 * share * radius, fmax(x1 - cells->x0, y1 - cells->y0) / MOST_CELLS) + 1e-9;
    cells->columns = 1 + (size_t)fmin(MOST_CELLS, (x1 - cells->x0) / cells->side); /* also when it is no number */
    cells->rows = 1 + (size_t)fmin(MOST_CELLS, (y1 - cells->y0) / cells->side);
    cells->first = malloc((cells->columns * cells->rows + list->count) * sizeof *cells->first);
    if (!cells->first)
        return error_memory("cells of candidates");
    cells->next = cells->first + cells->columns * cells->rows;
    for (size_t k = 0; k < cells->columns * cells->rows; k++)
        cells->first[k] = NONE;
    return 0;
}

static int clear_of(const struct candidates *list, const struct cells *cells, size_t i, size_t j, const struct rim *rim,
                    double share)
{
    for (size_t v = j ? j - 1 : 0; v <= j + 1 && v < cells->rows; v++)
        for (size_t u = i ? i - 1 : 0; u <= i + 1 && u < cells->columns; u++)
            for (size_t k = cells->first[v * cells->columns + u]; k != NONE; k = cells->next[k]) {
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
    struct cells cells;
    if (list->count == 0)
        return 0;
    for (size_t k = 0; k < list->count; k++)
        list->items[k].merit = merit(&list->items[k]);
    qsort(list->items, list->count, sizeof *list->items, better_first);
    if (cells_make(list, share, &cells))
        return -1;
    size_t kept = 0;
    for (size_t k = 0; k < list->count; k++) {
        const struct rim *rim = &list->items[k].rim;
        size_t i = cell_of(rim->x, cells.x0, cells.side, cells.columns);
        size_t j = cell_of(rim->y, cells.y0, cells.side, cells.rows);
        if (!clear_of(list, &cells, i, j, rim, share))
            continue;
        cells.next[kept] = cells.first[j * cells.columns + i];
        cells.first[j * cells.columns + i] = kept;
        list->items[kept++] = list->items[k];
    }
    list->count = kept;
    free(cells.first);
    return 0;
}
