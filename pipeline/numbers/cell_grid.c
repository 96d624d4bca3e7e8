#include "pipeline/numbers/cell_grid.h"

#include <math.h>
#include <stdlib.h>

#include "pipeline/speak/error.h"

/* Cell numbers are cut off here, where int64 still holds them and their differences. The cut keeps the order of cells,
 * so that a search misses nothing; all that lies beyond shares a cell. */
#define LAST_CELL 1e18

int cell_grid_open(struct cell_grid *grid, size_t room, double size)
{
    size_t buckets = 16;
    while (buckets < room)
        buckets *= 2;
    *grid = (struct cell_grid){.size = size, .room = room, .mask = buckets - 1};
    grid->point = malloc((room + 1) * sizeof *grid->point);
    grid->head = malloc(buckets * sizeof *grid->head);
    if (!grid->point || !grid->head)
        return error_memory("cells of points");
    for (size_t b = 0; b < buckets; b++)
        grid->head[b] = CELL_GRID_END;
    return 0;
}

void cell_grid_free(struct cell_grid *grid)
{
    free(grid->point);
    free(grid->head);
    *grid = (struct cell_grid){0};
}

static int64_t cell_of(const struct cell_grid *grid, double at)
{
    return (int64_t)fmax(-LAST_CELL, fmin(LAST_CELL, floor(at / grid->size)));
}

/* Mixed as in Steele, Lea & Flood's SplitMix (OOPSLA 2014): neighbouring cells must not share buckets. */
static size_t bucket_of(const struct cell_grid *grid, int64_t column, int64_t row)
{
    uint64_t h = (uint64_t)column * 0x9E3779B97F4A7C15u ^ (uint64_t)row * 0xC2B2AE3D27D4EB4Fu;
    h ^= h >> 32;
    h *= 0xD6E8FEB86659FD93u;
    h ^= h >> 32;
    return (size_t)h & grid->mask;
}

void cell_grid_add(struct cell_grid *grid, size_t number, double x, double y)
{
    if (!(fabs(x) < CELL_GRID_FARTHEST && fabs(y) < CELL_GRID_FARTHEST) || grid->count == grid->room)
        return;
    struct cell_point point = {cell_of(grid, x), cell_of(grid, y), number, CELL_GRID_END};
    size_t *head = &grid->head[bucket_of(grid, point.column, point.row)];
    point.next = *head;
    *head = grid->count;
    grid->point[grid->count++] = point;
}

struct cell_search cell_grid_near(const struct cell_grid *grid, double x, double y, double reach)
{
    struct cell_search search = {.grid = grid, .next = CELL_GRID_END};
    search.first = cell_of(grid, x - reach), search.last = cell_of(grid, x + reach);
    search.bottom = cell_of(grid, y - reach), search.top = cell_of(grid, y + reach);
    search.column = search.first - 1, search.row = search.bottom;
    double cells = ((double)(search.last - search.first) + 1) * ((double)(search.top - search.bottom) + 1);
    search.all = cells > (double)grid->count;
    if (search.all)
        search.next = grid->count;
    return search;
}

/* The head of the next cell's chain, or CELL_GRID_END after the last cell. */
static int next_cell(struct cell_search *search)
{
    if (search->column++ == search->last) {
        search->column = search->first;
        if (search->row++ == search->top)
            return 0;
    }
    search->next = search->grid->head[bucket_of(search->grid, search->column, search->row)];
    return 1;
}

size_t cell_grid_next(struct cell_search *search)
{
    const struct cell_point *point = search->grid->point;
    if (search->all)
        return search->next ? point[--search->next].number : CELL_GRID_END;
    for (;;) {
        while (search->next != CELL_GRID_END) {
            const struct cell_point *at = &point[search->next];
            search->next = at->next;
            if (at->column == search->column && at->row == search->row)
                return at->number;
        }
        if (!next_cell(search))
            return CELL_GRID_END;
    }
}
