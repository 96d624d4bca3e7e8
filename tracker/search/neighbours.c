#include "tracker/search/neighbours.h"

#include <math.h>
#include <stdlib.h>

#include "pipeline/numbers/cell_grid.h"
#include "pipeline/speak/error.h"
#include "pipeline/numbers/quantiles.h"

/* Keep the nearest, nearest first; of two that are equally far the one of smaller number. */
static void offer(const struct target *targets, size_t of, long candidate, long nearest[NEIGHBOURS],
                  double distance[NEIGHBOURS])
{
    double d =
        hypot(targets[candidate].shape.cx - targets[of].shape.cx, targets[candidate].shape.cy - targets[of].shape.cy);
    int k = NEIGHBOURS;
    while (k > 0 && (d < distance[k - 1] || (d == distance[k - 1] && candidate < nearest[k - 1])))
        k--;
    for (int last = NEIGHBOURS - 1; last > k; last--) {
        distance[last] = distance[last - 1];
        nearest[last] = nearest[last - 1];
    }
    if (k < NEIGHBOURS) {
        distance[k] = d;
        nearest[k] = candidate;
    }
}

/* In squares that double until NEIGHBOURS are within the circle inside, or all targets have been seen. */
static void find_one(const struct target *targets, size_t of, const struct cell_grid *grid, long nearest[NEIGHBOURS])
{
    double distance[NEIGHBOURS];
    struct cell_search search;
    double reach = grid->size;
    do {
        for (int k = 0; k < NEIGHBOURS; k++) {
            nearest[k] = -1;
            distance[k] = INFINITY;
        }
        if (!targets[of].given)
            return;
        search = cell_grid_near(grid, targets[of].shape.cx, targets[of].shape.cy, reach);
        for (size_t k; (k = cell_grid_next(&search)) != CELL_GRID_END;)
            if (k != of)
                offer(targets, of, (long)k, nearest, distance);
        reach *= 2;
    } while (distance[NEIGHBOURS - 1] > 0.5 * reach && !search.all);
}

long *neighbours_find(const struct target *targets, size_t count)
{
    struct cell_grid grid = {0};
    double size = 1; /* px: some two grains wide */
    for (size_t k = 0; k < count; k++)
        size += targets[k].given ? 4 * targets[k].shape.radius / (double)count : 0;
    long *nearest = malloc((count ? count : 1) * NEIGHBOURS * sizeof *nearest);
    if (!nearest || cell_grid_open(&grid, count, size)) {
        free(nearest);
        cell_grid_free(&grid);
        (void)error_memory("the neighbours of grains");
        return NULL;
    }
    for (size_t k = 0; k < count; k++)
        if (targets[k].given)
            cell_grid_add(&grid, k, targets[k].shape.cx, targets[k].shape.cy);
    for (size_t k = 0; k < count; k++)
        find_one(targets, k, &grid, nearest + k * NEIGHBOURS);
    cell_grid_free(&grid);
    return nearest;
}

int neighbours_motion(const long *nearest, const struct outcome *outcomes, struct motion *motion)
{
    double u[NEIGHBOURS], v[NEIGHBOURS], angle[NEIGHBOURS];
    int count = 0;
    for (int k = 0; k < NEIGHBOURS && nearest[k] >= 0; k++) {
        const struct outcome *outcome = &outcomes[nearest[k]];
        if (outcome->found < 2 || outcome->ambiguous)
            continue;
        u[count] = outcome->fit.motion.u;
        v[count] = outcome->fit.motion.v;
        angle[count++] = outcome->fit.motion.angle;
    }
    if (count)
        *motion =
            (struct motion){median_of(u, (size_t)count), median_of(v, (size_t)count), median_of(angle, (size_t)count)};
    return count;
}
