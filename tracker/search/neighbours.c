/* The nearest grains are those that a grain leans on or nearly so: they move alike but for their own rolling. A median
 * of their motions is not moved by up to half of them being wrong. Nearest others are found in cells of a grid, in ever
 * wider squares until the eighth lies within the square. */
#include "tracker/search/neighbours.h"

#include <math.h>
#include <stdlib.h>

#include "pipeline/numbers/cell_grid.h"
#include "pipeline/numbers/quantiles.h"
#include "pipeline/speak/error.h"

/* Square cells that hold some three targets each; *span: no two are further apart. */
static int grid_of(const struct target *targets, size_t count, struct cell_grid *grid, double *span)
{
    double x0 = INFINITY, y0 = INFINITY, x1 = -INFINITY, y1 = -INFINITY;
    size_t given = 0;
    for (size_t k = 0; k < count; k++)
        if (targets[k].given) {
            x0 = fmin(x0, targets[k].shape.cx);
            y0 = fmin(y0, targets[k].shape.cy);
            x1 = fmax(x1, targets[k].shape.cx);
            y1 = fmax(y1, targets[k].shape.cy);
            given++;
        }
    *span = given ? hypot(x1 - x0, y1 - y0) : 0;
    double area = given ? (x1 - x0) * (y1 - y0) : 0;
    if (cell_grid_open(grid, given, fmax(1, sqrt(area * 3 / (double)(given + 1)))))
        return -1;
    for (size_t k = 0; k < count; k++)
        if (targets[k].given)
            cell_grid_add(grid, k, targets[k].shape.cx, targets[k].shape.cy);
    return 0;
}

/* Keep the nearest, nearest first, of equally near ones that of the smaller number. */
static void offer(const struct target *targets, size_t of, long candidate, long nearest[NEIGHBOURS],
                  double distance[NEIGHBOURS])
{
    double d =
        hypot(targets[candidate].shape.cx - targets[of].shape.cx, targets[candidate].shape.cy - targets[of].shape.cy);
    int k = NEIGHBOURS;
    for (; k > 0 && (d < distance[k - 1] || (d == distance[k - 1] && candidate < nearest[k - 1])); k--)
        if (k < NEIGHBOURS) {
            distance[k] = distance[k - 1];
            nearest[k] = nearest[k - 1];
        }
    if (k == NEIGHBOURS)
        return;
    distance[k] = d;
    nearest[k] = candidate;
}

/* Ever wider around the target until the nearest are all within reach. */
static void find_one(const struct target *targets, size_t of, const struct cell_grid *grid, double span,
                     long nearest[NEIGHBOURS])
{
    double distance[NEIGHBOURS], reach = grid->size;
    int done;
    do {
        for (int k = 0; k < NEIGHBOURS; k++) {
            nearest[k] = -1;
            distance[k] = INFINITY;
        }
        if (!targets[of].given)
            return;
        struct cell_search search = cell_grid_near(grid, targets[of].shape.cx, targets[of].shape.cy, reach);
        for (size_t k = cell_grid_next(&search); k != CELL_GRID_END; k = cell_grid_next(&search))
            if (k != of)
                offer(targets, of, (long)k, nearest, distance);
        done = distance[NEIGHBOURS - 1] <= reach || reach > span;
        reach *= 2;
    } while (!done);
}

long *neighbours_find(const struct target *targets, size_t count)
{
    struct cell_grid grid = {.count = 0};
    double span;
    long *nearest = malloc((count ? count : 1) * NEIGHBOURS * sizeof *nearest);
    int status = nearest ? grid_of(targets, count, &grid, &span) : error_memory("the neighbours of grains");
    for (size_t k = 0; k < count && !status; k++)
        find_one(targets, k, &grid, span, nearest + k * NEIGHBOURS);
    cell_grid_free(&grid);
    if (!status)
        return nearest;
    free(nearest);
    return NULL;
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
