/* Who may touch whom: a cell list gives all pairs nearer than a skin; they stay valid until two grains together, or a
 * grain and a wall, have moved by the skin. Friction springs survive the search. */
#include <stdlib.h>
#include <string.h>

#include "pipeline/numbers/cell_grid.h"
#include "pipeline/speak/error.h"
#include "simulation/dem/dem.h"

/* The grains in cells as wide as the reach of the largest two; *largest: its radius. */
static int cells_fill(const struct dem *dem, struct cell_grid *cells, double *largest)
{
    *largest = 0;
    for (size_t k = 0; k < dem->count; k++) {
        if (!isfinite(dem->grains[k].x) || !isfinite(dem->grains[k].y))
            return error_failed("grain %zu left the plane: the time step is too long", k);
        *largest = fmax(*largest, dem->grains[k].radius);
    }
    if (cell_grid_open(cells, dem->count, 2 * *largest + dem->skin))
        return -1;
    for (size_t k = 0; k < dem->count; k++)
        cell_grid_add(cells, k, dem->grains[k].x, dem->grains[k].y);
    return 0;
}

/* Room for one more pair; doubles. -1 without memory. */
static int pair_room(struct dem *dem)
{
    if (dem->pair_count < dem->pair_capacity)
        return 0;
    size_t capacity = dem->pair_capacity ? 2 * dem->pair_capacity : 8 * dem->count + 16;
    struct dem_pair *pairs = realloc(dem->pairs, capacity * sizeof *pairs);
    if (!pairs)
        return error_memory("pairs of grains");
    dem->pairs = pairs;
    dem->pair_capacity = capacity;
    return 0;
}

/* A pair that does not touch yet, at the end of the list. */
static int pair_add(struct dem *dem, int i, int j)
{
    if (pair_room(dem))
        return -1;
    dem->pairs[dem->pair_count++] = (struct dem_pair){.i = i, .j = j};
    return 0;
}

/* What depends on the partners: the dashpot, and the law of unequal radii. The mass that counts is the reduced one: a
 * wall, and what is fixed, is infinitely heavy. */
static int pairs_complete(struct dem *dem)
{
    int linear = contact_law_row(&dem->law)->linear;
    struct contact_pair *laws = linear ? NULL : realloc(dem->pair_law, (dem->pair_capacity + 1) * sizeof *laws);
    if (!linear && !laws)
        return error_memory("pairs of grains");
    if (linear) {
        free(dem->pair_law);
        dem->linear = contact_pair_of(&dem->law, 0);
    }
    dem->pair_law = laws;
    for (size_t p = 0; p < dem->pair_count; p++) {
        struct dem_pair *pair = &dem->pairs[p];
        const struct dem_grain *g = &dem->grains[pair->i];
        const struct dem_grain *h = (size_t)pair->j < dem->count ? &dem->grains[pair->j] : NULL;
        double other = h ? h->radius : (size_t)pair->j >= dem->count + SIDES ? dem->box.corner_radius : INFINITY;
        double mobility = (g->fixed ? 0 : 1 / g->mass) + (h && !h->fixed ? 1 / h->mass : 0);
        pair->damping = mobility > 0 ? 2 * dem->damping_ratio / sqrt(mobility) : 0;
        if (!linear)
            laws[p] = contact_pair_of(&dem->law, 1 / (1 / g->radius + 1 / other));
    }
    return 0;
}

int dem_change_law(struct dem *dem, const struct contact_law *law)
{
    dem->law = *law;
    return pairs_complete(dem);
}

/* For each grain the pairs in which it comes second, in order: counting sort. */
static int pairs_back(struct dem *dem)
{
    size_t grain_pairs = dem->first[dem->count];
    size_t *back = realloc(dem->back, (grain_pairs + 1) * sizeof *back);
    if (!back)
        return error_memory("pairs of grains");
    dem->back = back;
    memset(dem->back_first, 0, (dem->count + 2) * sizeof *dem->back_first);
    for (size_t p = 0; p < grain_pairs; p++)
        dem->back_first[dem->pairs[p].j + 2]++;
    for (size_t k = 1; k <= dem->count + 1; k++)
        dem->back_first[k] += dem->back_first[k - 1];
    for (size_t p = 0; p < grain_pairs; p++)
        back[dem->back_first[dem->pairs[p].j + 1]++] = p;
    return 0;
}

/* For qsort() within one grain's pairs. */
static int by_partner(const void *a, const void *b)
{
    const struct dem_pair *p = a, *q = b;
    return (p->j > q->j) - (p->j < q->j);
}

/* All j > i nearer than the skin. */
static int pairs_of_grain(struct dem *dem, const struct cell_grid *cells, double largest, int i)
{
    const struct dem_grain *g = &dem->grains[i];
    size_t begin = dem->pair_count;
    struct cell_search search = cell_grid_near(cells, g->x, g->y, g->radius + largest + dem->skin);
    for (size_t j; (j = cell_grid_next(&search)) != CELL_GRID_END;) {
        const struct dem_grain *h = &dem->grains[j];
        double reach = g->radius + h->radius + dem->skin, dx = h->x - g->x, dy = h->y - g->y;
        if ((int)j > i && dx * dx + dy * dy < reach * reach && pair_add(dem, i, (int)j))
            return -1;
    }
    if (dem->pair_count > begin + 1)
        qsort(dem->pairs + begin, dem->pair_count - begin, sizeof *dem->pairs, by_partner);
    return 0;
}

/* All sides and corners within the skin of a rim, in the order of grains, then sides, then corners. */
static int pairs_with_walls(struct dem *dem)
{
    for (size_t i = 0; i < dem->count; i++) {
        dem->wall_first[i] = dem->pair_count;
        for (int s = 0; s < SIDES && dem->box.given; s++) {
            const struct dem_grain *g = &dem->grains[i];
            const struct dem_side *side = &dem->box.side[s];
            double distance = vec_dot(vec_sub(vec(g->x, g->y), side->point), side->inward);
            if (distance < g->radius + dem->skin && pair_add(dem, (int)i, (int)dem->count + s))
                return -1;
        }
        for (int k = 0; k < BOX_CORNERS && dem->box.given && dem->box.corner_radius > 0; k++) {
            const struct dem_grain *g = &dem->grains[i];
            struct vec apart = vec_sub(vec(g->x, g->y), dem->box.corner[k].at);
            if (vec_norm(apart) < g->radius + dem->box.corner_radius + dem->skin &&
                pair_add(dem, (int)i, (int)dem->count + SIDES + k))
                return -1;
        }
    }
    dem->wall_first[dem->count] = dem->pair_count;
    return 0;
}

/* Carry the touching pairs of the old list over: both lists are sorted alike. */
static void keep_history(struct dem *dem, const struct dem_pair *old, size_t old_count, size_t old_walls)
{
    size_t walls = dem->first[dem->count];
    for (int part = 0; part < 2; part++) {
        size_t o = part ? old_walls : 0, o_end = part ? old_count : old_walls;
        size_t p = part ? walls : 0, p_end = part ? dem->pair_count : walls;
        for (; o < o_end; o++) {
            if (!old[o].touching)
                continue;
            while (p < p_end &&
                   (dem->pairs[p].i < old[o].i || (dem->pairs[p].i == old[o].i && dem->pairs[p].j < old[o].j)))
                p++;
            if (p < p_end && dem->pairs[p].i == old[o].i && dem->pairs[p].j == old[o].j)
                dem->pairs[p] = old[o];
        }
    }
}

/* A pair that was left out is further apart than the skin; it cannot touch before two grains, or a grain and a wall,
 * have together moved that far since the search. */
static int search_needed(const struct dem *dem)
{
    if (!dem->first[dem->count] && !dem->pair_count && !dem->searches)
        return 1;
    double wall = 0, farthest = 0;
    const double *size = dem->box.size, *then = dem->searched_size;
    if (dem->box.given)
        wall = fabs(size[0] - then[0]) + fabs(size[1] - then[1]) + fabs(size[2] - then[2]) * fmax(size[1], then[1]);
    if (dem->box.corner_radius > 0)
        wall =
            fmax(wall, fabs(size[0] - then[0]) + fabs(size[1] - then[1]) + fabs(size[2] * size[1] - then[2] * then[1]));
    for (size_t k = 0; k < dem->count; k++) {
        double dx = dem->grains[k].x - dem->searched_at[k].x, dy = dem->grains[k].y - dem->searched_at[k].y;
        double square = dx * dx + dy * dy;
        if (!(square <= farthest))
            farthest = square;
    }
    farthest = sqrt(farthest);
    return !(2 * farthest < dem->skin && farthest + wall < dem->skin);
}

/* A new list; pairs that are in the old one keep their history (both are sorted alike). 0, or -1 without memory. */
static int search(struct dem *dem)
{
    struct cell_grid cells = {0};
    struct dem_pair *old = NULL;
    double largest;
    size_t old_count = dem->pair_count, old_walls = dem->first[dem->count];
    int status = -1;
    if (cells_fill(dem, &cells, &largest))
        goto done;
    old = malloc((old_count + 1) * sizeof *old);
    if (!old) {
        error_set(EXIT_FAILED, "out of memory: pairs of grains: use a machine with more memory");
        goto done;
    }
    if (old_count)
        memcpy(old, dem->pairs, old_count * sizeof *old);
    dem->pair_count = 0;
    for (size_t i = 0; i < dem->count; i++) {
        dem->first[i] = dem->pair_count;
        if (pairs_of_grain(dem, &cells, largest, (int)i))
            goto done;
    }
    dem->first[dem->count] = dem->pair_count;
    if (pairs_with_walls(dem) || pairs_back(dem) || pairs_complete(dem))
        goto done;
    keep_history(dem, old, old_count, old_walls);
    for (size_t k = 0; k < dem->count; k++)
        dem->searched_at[k] = vec(dem->grains[k].x, dem->grains[k].y);
    memcpy(dem->searched_size, dem->box.size, sizeof dem->searched_size);
    dem->searches++;
    status = 0;
done:
    free(old);
    cell_grid_free(&cells);
    return status;
}

int dem_find_pairs(struct dem *dem)
{
    if (!search_needed(dem))
        return 0;
    return search(dem) ? -1 : 1;
}
