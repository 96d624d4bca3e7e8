/* Rows in reading order, so that the same photo gives the same numbers to the same grains. Standard errors are those of
 * the fit times the photo's correlation factor; a row that the fine fit could not measure has what its capture was good
 * for. */
#include "findgrains/rims/rims_table.h"

#include "findgrains/rims/measure.h"
#include "pipeline/numbers/quantiles.h"
#include "pipeline/speak/error.h"

#include <math.h>
#include <stdlib.h>

#define RAGGED 3.0    /* a rim whose sectors scatter this much more than is usual is not to be trusted */
#define CUT_DEPTH 1.5 /* px that a rim may lie beyond the frame before the grain counts as cut */

/* What is usual on this photo. */
struct usual {
    double shape;   /* RMS of the shapes over the radii: for rims that are too small to show one */
    double scatter; /* px, of the sectors about the rim */
};

static uint32_t flags_of(const struct zone *zone, const struct refined *item, const struct candidate *origin,
                         const struct usual *usual)
{
    uint32_t flags = origin->by_hand ? GRAIN_BY_HAND : 0;
    double x = item->rim.x, y = item->rim.y, r = item->rim.radius;
    if (!isfinite(x + y + r))
        return flags | GRAIN_LOST;
    if (zone_photo_depth(zone, x, y) < r || zone_depth(zone, x, y) < r - fmax(CUT_DEPTH, 0.03 * r) - zone->bend)
        flags |= GRAIN_CUT;
    if (item->support < MEASURE_LEAST_SUPPORT)
        return flags | GRAIN_WEAK_EDGE | GRAIN_NO_CONTRAST;
    if ((item->support < MEASURE_WEAK_SUPPORT && item->hidden < 0.5) || item->scatter > RAGGED * usual->scatter)
        flags |= GRAIN_WEAK_EDGE;
    if (!(item->moved < fmax(0.02, item->s_radius)))
        flags |= GRAIN_NOT_CONVERGED;
    return flags;
}

static int find_usual(const struct rims *rims, struct usual *usual)
{
    double sum = 0, count = 0, *scatters = malloc((rims->count + 1) * sizeof *scatters);
    size_t n = 0;
    if (!scatters)
        return error_memory("scatter of the rims");
    for (size_t k = 0; k < rims->count; k++) {
        const struct refined *item = &rims->items[k];
        if (item->support > 0)
            scatters[n++] = item->scatter;
        if (item->s_shape > 0) {
            double share = hypot(item->rim.c2, item->rim.s2) / item->rim.radius;
            sum += share * share;
            count += 1;
        }
    }
    usual->scatter = median_of(scatters, n);
    usual->shape = count > 0 ? sqrt(0.5 * sum / count) : 0;
    free(scatters);
    return 0;
}

static void fill_row(const struct zone *zone, const struct rims_state *state, const struct rims *rims, size_t from,
                     const struct usual *usual, struct photo_grains *grains, size_t row)
{
    const struct refined *item = &rims->items[from];
    const struct candidate *origin = &rims->origin[from];
    int measured = item->support >= MEASURE_LEAST_SUPPORT;
    grains->x_px[row] = item->rim.x;
    grains->y_px[row] = item->rim.y;
    grains->radius_px[row] = item->rim.radius;
    grains->s_x[row] = measured ? item->s_x * state->correlation : origin->spread;
    grains->s_y[row] = measured ? item->s_y * state->correlation : origin->spread;
    grains->s_radius[row] = measured ? item->s_radius * state->correlation : origin->spread;
    grains->flags[row] = flags_of(zone, item, origin, usual);
    if (state->ellipse) {
        int shown = measured && item->s_shape > 0;
        grains->shape_c[row] = shown ? item->rim.c2 : 0;
        grains->shape_s[row] = shown ? -item->rim.s2 : 0; /* y down to counter-clockwise as seen */
        grains->s_shape[row] = shown ? item->s_shape * state->correlation : usual->shape * item->rim.radius;
    }
}

struct place {
    double y, x;
    size_t row;
};

static int reading_order(const void *left, const void *right)
{
    const struct place *a = left, *b = right;
    int order = (a->y > b->y) - (a->y < b->y);
    return order ? order : (a->x > b->x) - (a->x < b->x);
}

static int alloc_columns(const struct rims *rims, int ellipse, struct photo_grains *grains)
{
    static const char *const circle[] = {"x_px", "y_px", "radius_px", "s_x", "s_y", "s_radius", "flags", NULL};
    static const char *const shaped[] = {"x_px",  "y_px",    "radius_px", "s_x",     "s_y", "s_radius",
                                         "flags", "shape_c", "shape_s",   "s_shape", NULL};
    return table_alloc(&PHOTO_GRAINS, grains, rims->count, ellipse ? shaped : circle);
}

int rims_table(const struct zone *zone, const struct rims_state *state, const struct rims *rims, int keep_order,
               struct photo_grains *grains)
{
    struct place *places = malloc((rims->count + 1) * sizeof *places);
    if (!places)
        return error_memory("order of the grains");
    for (size_t k = 0; k < rims->count; k++)
        places[k] = (struct place){rims->items[k].rim.y, rims->items[k].rim.x, k};
    if (!keep_order && rims->count)
        qsort(places, rims->count, sizeof *places, reading_order);
    struct usual usual;
    int status = find_usual(rims, &usual) || alloc_columns(rims, state->ellipse, grains) ? -1 : 0;
    for (size_t k = 0; k < rims->count && !status; k++)
        fill_row(zone, state, rims, places[k].row, &usual, grains, k);
    free(places);
    return status;
}
