#include "tracker/search/neighbours.h"

#include <math.h>
#include <stdlib.h>

#include "pipeline/speak/error.h"
#include "pipeline/numbers/quantiles.h"

/* Targets sorted into square cells. */
struct cells {
    double x0, y0, size;
    int columns, rows;
    long *first, *next; /* list of each cell, ends with -1 */
};

static int cell_of(double x, double x0, double size, int cells)
{
    int k = (int)((x - x0) / size);
    return k < 0 ? 0 : k >= cells ? cells - 1 : k;
}

static int cells_make(const struct target *targets, size_t count, struct cells *cells)
{
    double x1 = -INFINITY, y1 = -INFINITY;
    size_t given = 0;
    *cells = (struct cells){.x0 = INFINITY, .y0 = INFINITY};
    for (size_t k = 0; k < count; k++)
        if (targets[k].given) {
            cells->x0 = fmin(cells->x0, targets[k].shape.cx);
            cells->y0 = fmin(cells->y0, targets[k].shape.cy);
            x1 = fmax(x1, targets[k].shape.cx);
            y1 = fmax(y1, targets[k].shape.cy);
            given++;
        }
    double width = given ? x1 - cells->x0 : 1, height = given ? y1 - cells->y0 : 1;
    cells->size = fmax(1, fmax(sqrt(width * height * 3 / (double)(given + 1)), fmax(width, height) / 1000));
    cells->columns = (int)(width / cells->size) + 1;
    cells->rows = (int)(height / cells->size) + 1;
    size_t cell_count = (size_t)cells->columns * (size_t)cells->rows;
    cells->first = malloc((cell_count + count) * sizeof *cells->first);
    if (!cells->first)
        return error_memory("the neighbours of grains");
    cells->next = cells->first + cell_count;
    for (size_t k = 0; k < cell_count; k++)
        cells->first[k] = -1;
    for (size_t k = count; k-- > 0;)
        if (targets[k].given) {
            size_t cell =
                (size_t)cell_of(targets[k].shape.cy, cells->y0, cells->size, cells->rows) * (size_t)cells->columns +
                (size_t)cell_of(targets[k].shape.cx, cells->x0, cells->size, cells->columns);
            cells->next[k] = cells->first[cell];
            cells->first[cell] = (long)k;
        }
    return 0;
}

/* Keep the nearest, nearest first. */
static void offer(const struct target *targets, size_t of, long candidate, long nearest[NEIGHBOURS],
                  double distance[NEIGHBOURS])
{
    double d =
        hypot(targets[candidate].shape.cx - targets[of].shape.cx, targets[candidate].shape.cy - targets[of].shape.cy);
    int k = NEIGHBOURS - 1;
    if (d >= distance[k])
        return;
    for (; k > 0 && distance[k - 1] > d; k--) {
        distance[k] = distance[k - 1];
        nearest[k] = nearest[k - 1];
    }
    distance[k] = d;
    nearest[k] = candidate;
}

/* Rings of cells around the target until no nearer one can come. */
static void find_one(const struct target *targets, size_t of, const struct cells *cells, long nearest[NEIGHBOURS])
{
    double distance[NEIGHBOURS];
    for (int k = 0; k < NEIGHBOURS; k++) {
        nearest[k] = -1;
        distance[k] = INFINITY;
    }
    if (!targets[of].given)
        return;
    int cx = cell_of(targets[of].shape.cx, cells->x0, cells->size, cells->columns);
    int cy = cell_of(targets[of].shape.cy, cells->y0, cells->size, cells->rows);
    int largest = cells->columns > cells->rows ? cells->columns : cells->rows;
    for (int ring = 0; ring <= largest; ring++) {
        if (distance[NEIGHBOURS - 1] < (ring - 1) * cells->size)
            return;
        for (int y = cy - ring; y <= cy + ring; y++)
            for (int x = cx - ring; x <= cx + ring; x += abs(y - cy) == ring || ring == 0 ? 1 : 2 * ring)
                if (x >= 0 && y >= 0 && x < cells->columns && y < cells->rows)
                    for (long k = cells->first[y * cells->columns + x]; k >= 0; k = cells->next[k])
                        if (k != (long)of)
                            offer(targets, of, k, nearest, distance);
    }
}

long *neighbours_find(const struct target *targets, size_t count)
{
    struct cells cells;
    long *nearest = malloc((count ? count : 1) * NEIGHBOURS * sizeof *nearest);
    if (!nearest || cells_make(targets, count, &cells)) {
        free(nearest);
        error_set(EXIT_FAILED, "out of memory: the neighbours of grains: use a machine with more memory");
        return NULL;
    }
    for (size_t k = 0; k < count; k++)
        find_one(targets, k, &cells, nearest + k * NEIGHBOURS);
    free(cells.first);
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
