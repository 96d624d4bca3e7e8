/* How far to look. Statistics need the density of gaps beside the pile-up of contacts: a window of some errors of an
 * overlap, or a share of a radius where errors are small. Single pairs need more: those of the worst measured grains,
 * whose overlaps may still be contacts. */
#include "contacts/network/near_pairs.h"

#include <stdlib.h>

#include "contacts/network/cell_list.h"
#include "pipeline/speak/error.h"
#include "pipeline/numbers/quantiles.h"

#define WINDOW_OF_RADIUS 0.02 /* gaps up to this share of the median radius tell the density of gaps */
#define WINDOW_OF_ERROR 6.0   /* standard errors that the window must hold to see the density's shape */
#define SAME_PLACE 1e-6       /* centres nearer than this share of the radius are one grain found twice */

/* How far to look: `margin` for a pair to be seen at all, `window` for the statistics. */
static int choose_window(const struct grains *grains, double sigmas, double reach, double *window, double *margin)
{
    double *radii = malloc((grains->count + 1) * sizeof *radii), *errors = malloc((grains->count + 1) * sizeof *errors);
    double largest = 0, worst = 0, shape = 0;
    size_t n = 0;
    if (!radii || !errors) {
        free(radii);
        free(errors);
        return error_memory("radii");
    }
    for (size_t k = 0; k < grains->count; k++) {
        if (grains->flags[k] & GRAIN_NOT_FINITE)
            continue;
        radii[n] = grains->radius[k];
        errors[n] = sqrt(fmax(rim_variance(grains, k, vec(1, 0)), rim_variance(grains, k, vec(0, 1))));
        largest = fmax(largest, radii[n]);
        worst = fmax(worst, errors[n]);
        double c = column_or_zero(grains->shape_c, k), s = column_or_zero(grains->shape_s, k);
        shape = isfinite(c + s) ? fmax(shape, hypot(c, s)) : shape;
        n++;
    }
    *window = n ? fmin(fmax(WINDOW_OF_RADIUS * median_of(radii, n),
                            fmax(WINDOW_OF_ERROR, sigmas) * M_SQRT2 * median_of(errors, n)),
                       largest)
                : 0;
    *margin = fmax(fmin(fmax(*window, sigmas * M_SQRT2 * worst), largest) + 2 * shape, reach);
    free(radii);
    free(errors);
    return 0;
}

static int push(struct pairs *pairs, struct pair pair)
{
    if (pairs->count == pairs->room) {
        size_t more = pairs->room ? 2 * pairs->room : 1024;
        struct pair *grown = realloc(pairs->pair, more * sizeof *grown);
        if (!grown)
            return error_memory("pairs");
        pairs->pair = grown;
        pairs->room = more;
    }
    pairs->pair[pairs->count++] = pair;
    return 0;
}

static int measure_near(const struct grains *grains, const struct near_pairs *near, struct pairs *pairs)
{
    for (size_t p = 0; p < near->count; p++) {
        size_t i = (size_t)near->i[p], j = (size_t)near->j[p];
        double apart = hypot(grains->x[j] - grains->x[i], grains->y[j] - grains->y[i]);
        if (apart < SAME_PLACE * fmax(grains->radius[i], grains->radius[j]))
            return error_input("grains %zu and %zu have the same centre: remove one of them from the grain file", i, j);
        if (push(pairs, pair_of_grains(grains, i, j)))
            return -1;
    }
    return 0;
}

int candidates_between_grains(const struct grains *grains, double sigmas, double reach, struct pairs *pairs,
                              double *window)
{
    struct near_pairs near = {0};
    double margin = 0;
    unsigned char *skip = malloc(grains->count + 1);
    *pairs = (struct pairs){0};
    if (!skip)
        return error_memory("rows");
    for (size_t k = 0; k < grains->count; k++)
        skip[k] = (grains->flags[k] & GRAIN_NOT_FINITE) != 0;
    int status = choose_window(grains, sigmas, reach, window, &margin);
    if (status == 0)
        status = near_pairs_find(grains->x, grains->y, grains->radius, skip, grains->count, margin, &near);
    if (status == 0)
        status = measure_near(grains, &near, pairs);
    if (!(*window > 0))
        *window = 1;
    if (status)
        pairs_free(pairs);
    near_pairs_free(&near);
    free(skip);
    return status;
}

/* Both lists are sorted by i and every wall comes after every grain, so one merge keeps the order. */
int candidates_with_walls(const struct grains *grains, const struct walls *walls, double window, struct pairs *pairs)
{
    struct pairs all = {0};
    size_t next = 0;
    for (size_t k = 0; k < grains->count; k++) {
        int status = 0;
        for (; status == 0 && next < pairs->count && pairs->pair[next].i == (int64_t)k; next++)
            status = push(&all, pairs->pair[next]);
        for (size_t w = 0; status == 0 && w < walls->count && !(grains->flags[k] & GRAIN_NOT_FINITE); w++) {
            struct pair pair = pair_with_wall(grains, k, walls, w);
            if (pair.overlap > -window)
                status = push(&all, pair);
        }
        if (status) {
            pairs_free(&all);
            return -1;
        }
    }
    pairs_free(pairs);
    *pairs = all;
    return 0;
}

int pairs_median_error(const struct pairs *pairs, double *error)
{
    double *s = malloc((pairs->count + 1) * sizeof *s);
    if (!s)
        return error_memory("errors of overlaps");
    for (size_t p = 0; p < pairs->count; p++)
        s[p] = pairs->pair[p].s_overlap;
    *error = pairs->count ? median_of(s, pairs->count) : 0;
    free(s);
    return 0;
}

void pairs_free(struct pairs *pairs)
{
    free(pairs->pair);
    *pairs = (struct pairs){0};
}
