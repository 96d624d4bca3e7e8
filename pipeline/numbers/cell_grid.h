/* Points of the plane in square cells, to find those near a place without looking at all.
 *
 * Only cells that hold points take memory (they are hashed: Teschner et al., Optimized spatial hashing, VMV 2003), so
 * neither a far-off point nor a thin crowd costs anything. A search looks at the cells that its square touches, or at
 * every point when those are more: with cells as wide as its reach, at some 9 times the points of a cell. */
#ifndef PIPELINE_CELL_GRID_H
#define PIPELINE_CELL_GRID_H

#include <stddef.h>
#include <stdint.h>

#define CELL_GRID_END ((size_t)-1)
#define CELL_GRID_FARTHEST 1e150 /* further out squares of differences are no numbers */

struct cell_point {
    int64_t column, row;
    size_t number, next; /* the caller's number; the next point of the bucket */
};

struct cell_grid {
    double size;
    size_t count, room, mask; /* points, most points, buckets - 1 */
    struct cell_point *point;
    size_t *head; /* of each bucket's chain, the last added first */
};

/* A search under way: see cell_grid_near(). */
struct cell_search {
    const struct cell_grid *grid;
    int64_t first, last, bottom, top; /* columns and rows to look at */
    int64_t column, row;
    size_t next;
    int all; /* no cells: every point */
};

/* An empty grid for up to `room` points in cells of width `size` > 0 (unit of the points). 0, or -1 when out of memory;
 * cell_grid_free() in either case, which also accepts a zeroed struct. */
int cell_grid_open(struct cell_grid *grid, size_t room, double size);
void cell_grid_free(struct cell_grid *grid);

/* Add a point by the caller's number of it. A point that is not finite, or lies beyond CELL_GRID_FARTHEST, is left out
 * and never found. At most `room` points. */
void cell_grid_add(struct cell_grid *grid, size_t number, double x, double y);

/* All points with |x - x_k| <= reach and |y - y_k| <= reach, and some that are further: the caller measures
 * distances. Call cell_grid_next() until CELL_GRID_END for their numbers: cell by cell along x, then y, in a cell the
 * last added first. Points may be added meanwhile; whether they are found is open. */
struct cell_search cell_grid_near(const struct cell_grid *grid, double x, double y, double reach);
size_t cell_grid_next(struct cell_search *search);

#endif
