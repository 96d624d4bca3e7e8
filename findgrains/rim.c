#include "findgrains/rim.h"

#include "pipeline/error.h"

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

static int clear_of(const struct candidates *list, size_t kept, const struct rim *rim, double share)
{
    for (size_t k = 0; k < kept; k++) {
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

void candidates_thin(struct candidates *list, double share, double (*merit)(const struct candidate *))
{
    if (list->count == 0)
        return;
    for (size_t k = 0; k < list->count; k++)
        list->items[k].merit = merit(&list->items[k]);
    qsort(list->items, list->count, sizeof *list->items, better_first);
    size_t kept = 0;
    for (size_t k = 0; k < list->count; k++)
        if (clear_of(list, kept, &list->items[k].rim, share))
            list->items[kept++] = list->items[k];
    list->count = kept;
}
