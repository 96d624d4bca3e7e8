/* The pixels of a shape, scanned row by row. What is left out: pixels so near the border of the reference that slopes
 * would need what lies beyond it, saturated ones, those of neighbours that reach in (they move with another grain), and
 * those that the expected motion carries beyond the border of the other photo. */
#include "tracker/subset/runs.h"

#include <math.h>
#include <stdlib.h>

#include "pipeline/speak/error.h"
#include "tracker/subset/slopes.h"

/* First and last column of the shape in row y; an empty range when it has none. */
static void columns_of(const struct shape *shape, int y, int *first, int *last)
{
    double half = shape->half_w, dy = y - shape->cy;
    if (!(half > 0)) {
        double square = shape->radius * shape->radius - dy * dy;
        half = square >= 0 ? sqrt(square) : -1;
    }
    *first = (int)ceil(shape->cx - half);
    *last = (int)floor(shape->cx + half);
}

static void rows_of(const struct shape *shape, int *first, int *last)
{
    double half = shape->half_h > 0 ? shape->half_h : shape->radius;
    *first = (int)ceil(shape->cy - half);
    *last = (int)floor(shape->cy + half);
}

/* Does the warp carry this pixel to a place where the spline of the searched photo is its own? */
static int lands_inside(const struct subset_mask *mask, const struct shape *shape, int x, int y)
{
    double c = cos(mask->angle), s = sin(mask->angle), dx = x - shape->cx, dy = y - shape->cy;
    double px = shape->cx + mask->u + c * dx + s * dy, py = shape->cy + mask->v - s * dx + c * dy;
    return px >= SLOPES_REACH && py >= SLOPES_REACH && px <= mask->photo->width - 1 - SLOPES_REACH &&
           py <= mask->photo->height - 1 - SLOPES_REACH;
}

static int is_used(const struct photo *reference, const struct shape *shape, const struct subset_mask *mask, int x,
                   int y)
{
    if (mask->saturation && photo_row(reference, y)[x] >= mask->saturation)
        return 0;
    if (mask->photo && !lands_inside(mask, shape, x, y))
        return 0;
    for (size_t k = 0; k < mask->neighbour_count; k++) {
        double dx = x - mask->neighbours[k].cx, dy = y - mask->neighbours[k].cy;
        if (dx * dx + dy * dy < mask->neighbours[k].radius * mask->neighbours[k].radius)
            return 0;
    }
    return 1;
}

static int add_run(struct runs *runs, size_t *capacity, int x, int y, int count)
{
    if (runs->count == *capacity) {
        size_t grown = *capacity ? 2 * *capacity : 64;
        struct run *items = realloc(runs->items, grown * sizeof *items);
        if (!items)
            return error_memory("the runs of a subset");
        runs->items = items;
        *capacity = grown;
    }
    runs->items[runs->count++] = (struct run){x, y, count, runs->pixels};
    runs->pixels += (size_t)count;
    return 0;
}

int runs_find(const struct photo *reference, const struct shape *shape, const struct subset_mask *mask,
              struct runs *runs)
{
    int masked = mask->saturation || mask->photo || mask->neighbour_count;
    int y_first, y_last;
    size_t capacity = 0, all = 0;
    *runs = (struct runs){0};
    rows_of(shape, &y_first, &y_last);
    for (int y = y_first; y <= y_last; y++) {
        int first, last;
        columns_of(shape, y, &first, &last);
        all += last >= first ? (size_t)(last - first + 1) : 0;
        if (y < SLOPES_REACH || y >= reference->height - SLOPES_REACH)
            continue;
        first = first < SLOPES_REACH ? SLOPES_REACH : first;
        last = last >= reference->width - SLOPES_REACH ? reference->width - SLOPES_REACH - 1 : last;
        for (int x = first; x <= last;) {
            int begin = x;
            if (!masked)
                x = last + 1;
            while (x <= last && is_used(reference, shape, mask, x, y))
                x++;
            if (x > begin && add_run(runs, &capacity, begin, y, x - begin)) {
                free(runs->items);
                runs->items = NULL;
                return -1;
            }
            for (; x <= last && masked && !is_used(reference, shape, mask, x, y); x++)
                if (mask->saturation && photo_row(reference, y)[x] >= mask->saturation)
                    runs->saturated++;
        }
    }
    runs->used = all ? (double)runs->pixels / (double)all : 0;
    return 0;
}
