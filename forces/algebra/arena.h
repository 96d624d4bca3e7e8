/* Arrays of numbers side by side in one block. Their owner lays them out twice with the same function: without a block,
 * which counts them, then with it; so no size stands in two places, and one free() is enough. */
#ifndef FORCES_ARENA_H
#define FORCES_ARENA_H

#include <stddef.h>

struct arena {
    double *block; /* NULL: only count */
    size_t used;   /* numbers taken so far */
};

/* The next `count` numbers; NULL while there is no block. */
static inline double *arena_take(struct arena *arena, size_t count)
{
    double *taken = arena->block ? arena->block + arena->used : NULL;
    arena->used += count;
    return taken;
}

/* The same as rows of two or three. */
static inline void *arena_rows(struct arena *arena, size_t rows, size_t columns)
{
    return arena_take(arena, rows * columns);
}

#endif
