#include "contacts/network/cell_list.h"

#include <math.h>
#include <stdlib.h>

#include "pipeline/numbers/cell_grid.h"
#include "pipeline/speak/error.h"

enum { CLASSES = 24 };

struct discs {
    const double *x, *y, *radius;
    size_t count;
    double margin;
    double largest[CLASSES];        /* radius of the largest disc of the class; 0: empty class */
    struct cell_grid grid[CLASSES]; /* of each class, in cells as wide as two of its largest discs */
    signed char *level;             /* class of each disc; -1: left out */
};

/* Sort the discs into classes. */
static void classify(struct discs *discs, const unsigned char *skip, size_t members[CLASSES])
{
    double smallest = INFINITY;
    for (size_t k = 0; k < discs->count; k++) {
        int usable = fabs(discs->x[k]) < CELL_GRID_FARTHEST && fabs(discs->y[k]) < CELL_GRID_FARTHEST &&
                     discs->radius[k] > 0 && discs->radius[k] < CELL_GRID_FARTHEST;
        discs->level[k] = usable && !(skip && skip[k]) ? 0 : -1;
        if (discs->level[k] == 0)
            smallest = fmin(smallest, discs->radius[k]);
    }
    for (size_t k = 0; k < discs->count; k++) {
        if (discs->level[k] < 0)
            continue;
        int level = (int)fmin(log2(discs->radius[k] / smallest), CLASSES - 1);
        discs->level[k] = (signed char)level;
        discs->largest[level] = fmax(discs->largest[level], discs->radius[k]);
        members[level]++;
    }
}

static int fill(struct discs *discs, const unsigned char *skip)
{
    size_t members[CLASSES] = {0};
    discs->level = malloc(discs->count + 1);
    if (!discs->level)
        return error_memory("classes of discs");
    classify(discs, skip, members);
    for (int level = 0; level < CLASSES; level++)
        if (members[level] &&
            cell_grid_open(&discs->grid[level], members[level], 2 * discs->largest[level] + discs->margin))
            return -1;
    for (size_t k = 0; k < discs->count; k++)
        if (discs->level[k] >= 0)
            cell_grid_add(&discs->grid[discs->level[k]], k, discs->x[k], discs->y[k]);
    return 0;
}

static int push(struct near_pairs *pairs, size_t *room, size_t a, size_t b)
{
    if (pairs->count == *room) {
        size_t more = *room ? 2 * *room : 1024;
        int64_t *i = realloc(pairs->i, more * sizeof *i);
        pairs->i = i ? i : pairs->i;
        int64_t *j = realloc(pairs->j, more * sizeof *j);
        pairs->j = j ? j : pairs->j;
        if (!i || !j)
            return error_memory("near pairs");
        *room = more;
    }
    pairs->i[pairs->count] = (int64_t)(a < b ? a : b);
    pairs->j[pairs->count++] = (int64_t)(a < b ? b : a);
    return 0;
}

/* Those of class `level` that are near disc k; in its own class only those of smaller number, so that a pair counts
 * once. */
static int search_level(const struct discs *discs, size_t k, int level, struct near_pairs *pairs, size_t *room)
{
    struct cell_search search = cell_grid_near(&discs->grid[level], discs->x[k], discs->y[k],
                                               discs->radius[k] + discs->largest[level] + discs->margin);
    for (size_t other; (other = cell_grid_next(&search)) != CELL_GRID_END;) {
        if (level == discs->level[k] && other >= k)
            continue;
        double reach = discs->radius[k] + discs->radius[other] + discs->margin;
        double dx = discs->x[other] - discs->x[k], dy = discs->y[other] - discs->y[k];
        if (dx * dx + dy * dy <= reach * reach && push(pairs, room, k, other))
            return -1;
    }
    return 0;
}

static int search_around(const struct discs *discs, size_t k, struct near_pairs *pairs, size_t *room)
{
    for (int level = 0; level <= discs->level[k]; level++)
        if (discs->grid[level].count && search_level(discs, k, level, pairs, room))
            return -1;
    return 0;
}

/* Insertion sort of one short row. */
static void sort_row(int64_t *j, size_t begin, size_t end)
{
    for (size_t next = begin + 1; next < end; next++)
        for (size_t at = next; at > begin && j[at - 1] > j[at]; at--) {
            int64_t swap = j[at];
            j[at] = j[at - 1];
            j[at - 1] = swap;
        }
}

/* By i with a counting sort, then by j in each row. */
static int sort_pairs(struct near_pairs *pairs, size_t discs)
{
    size_t *start = calloc(discs + 2, sizeof *start);
    int64_t *i = malloc((pairs->count + 1) * sizeof *i), *j = malloc((pairs->count + 1) * sizeof *j);
    if (!start || !i || !j) {
        free(start);
        free(i);
        free(j);
        return error_memory("near pairs");
    }
    for (size_t p = 0; p < pairs->count; p++)
        start[pairs->i[p] + 2]++;
    for (size_t k = 2; k < discs + 2; k++)
        start[k] += start[k - 1];
    for (size_t p = 0; p < pairs->count; p++) {
        size_t at = start[pairs->i[p] + 1]++; /* in the end start[k] is where row k begins */
        i[at] = pairs->i[p];
        j[at] = pairs->j[p];
    }
    for (size_t k = 0; k < discs; k++)
        sort_row(j, start[k], start[k + 1]);
    free(start);
    free(pairs->i);
    free(pairs->j);
    pairs->i = i;
    pairs->j = j;
    return 0;
}

int near_pairs_find(const double *x, const double *y, const double *radius, const unsigned char *skip, size_t count,
                    double margin, struct near_pairs *pairs)
{
    struct discs discs = {.x = x, .y = y, .radius = radius, .count = count, .margin = margin};
    size_t room = 0;
    *pairs = (struct near_pairs){0};
    int status = fill(&discs, skip);
    for (size_t k = 0; status == 0 && k < count; k++)
        if (discs.level[k] >= 0)
            status = search_around(&discs, k, pairs, &room);
    if (status == 0)
        status = sort_pairs(pairs, count);
    if (status)
        near_pairs_free(pairs);
    for (int level = 0; level < CLASSES; level++)
        cell_grid_free(&discs.grid[level]);
    free(discs.level);
    return status;
}

void near_pairs_free(struct near_pairs *pairs)
{
    free(pairs->i);
    free(pairs->j);
    *pairs = (struct near_pairs){0};
}
