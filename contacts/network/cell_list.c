#include "contacts/network/cell_list.h"

#include <math.h>
#include <stdlib.h>

#include "pipeline/speak/error.h"

enum { CLASSES = 24, MOST_NEAR_CELLS = 64 };
static const size_t NONE = (size_t)-1;
#define MAX_CELLS_ACROSS 1073741824.0 /* 2^30: cell numbers stay far inside int64 */
#define FARTHEST 1e150                /* further out squares of differences are no numbers */

struct cell {
    int level;
    int64_t column, row;
};

struct cell_list {
    const double *x, *y, *radius;
    size_t count;
    double margin, x0, y0;
    double largest[CLASSES]; /* radius of the largest disc of the class; 0: empty class */
    double width[CLASSES];   /* of its cells */
    signed char *level;      /* class of each disc; -1: left out */
    size_t *head, *next;     /* chains of discs whose cells share a bucket */
    size_t mask;             /* buckets - 1 */
};

static struct cell cell_at(const struct cell_list *list, int level, double x, double y)
{
    double width = list->width[level];
    return (struct cell){level, (int64_t)floor((x - list->x0) / width), (int64_t)floor((y - list->y0) / width)};
}

static size_t bucket_of(const struct cell_list *list, struct cell cell)
{
    uint64_t h = (uint64_t)cell.column * 0x9E3779B97F4A7C15u ^ (uint64_t)cell.row * 0xC2B2AE3D27D4EB4Fu ^
                 (uint64_t)cell.level * 0x165667B19E3779F9u;
    h ^= h >> 32;
    h *= 0xD6E8FEB86659FD93u;
    h ^= h >> 32;
    return (size_t)h & list->mask;
}

/* Sort the discs into classes and choose the cells. */
static void classify(struct cell_list *list, const unsigned char *skip)
{
    double smallest = INFINITY, x1 = -INFINITY, y1 = -INFINITY;
    list->x0 = list->y0 = INFINITY;
    for (size_t k = 0; k < list->count; k++) {
        int usable = fabs(list->x[k]) < FARTHEST && fabs(list->y[k]) < FARTHEST && list->radius[k] > 0 &&
                     list->radius[k] < FARTHEST;
        list->level[k] = usable && !(skip && skip[k]) ? 0 : -1;
        if (list->level[k] < 0)
            continue;
        smallest = fmin(smallest, list->radius[k]);
        list->x0 = fmin(list->x0, list->x[k]);
        list->y0 = fmin(list->y0, list->y[k]);
        x1 = fmax(x1, list->x[k]);
        y1 = fmax(y1, list->y[k]);
    }
    for (size_t k = 0; k < list->count; k++) {
        if (list->level[k] < 0)
            continue;
        int level = (int)fmin(log2(list->radius[k] / smallest), CLASSES - 1);
        list->level[k] = (signed char)level;
        list->largest[level] = fmax(list->largest[level], list->radius[k]);
    }
    double narrowest = fmax(x1 - list->x0, y1 - list->y0) / MAX_CELLS_ACROSS;
    for (int level = 0; level < CLASSES; level++)
        list->width[level] = fmax(2 * list->largest[level] + list->margin, narrowest);
}

static int fill(struct cell_list *list, const unsigned char *skip)
{
    size_t buckets = 16;
    while (buckets < list->count)
        buckets *= 2;
    list->mask = buckets - 1;
    list->level = malloc(list->count + 1);
    list->next = malloc((list->count + 1) * sizeof *list->next);
    list->head = malloc(buckets * sizeof *list->head);
    if (!list->level || !list->next || !list->head)
        return error_memory("cells");
    classify(list, skip);
    for (size_t b = 0; b < buckets; b++)
        list->head[b] = NONE;
    for (size_t k = list->count; k-- > 0;) {
        if (list->level[k] < 0)
            continue;
        size_t bucket = bucket_of(list, cell_at(list, list->level[k], list->x[k], list->y[k]));
        list->next[k] = list->head[bucket];
        list->head[bucket] = k;
    }
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

/* Is `other`, of class `level`, near disc k? In its own class only those of smaller number, so that a pair counts once.
 */
static int offer(const struct cell_list *list, size_t k, int level, size_t other, struct near_pairs *pairs,
                 size_t *room)
{
    if (list->level[other] != level || (level == list->level[k] && other >= k))
        return 0;
    double reach = list->radius[k] + list->radius[other] + list->margin;
    double dx = list->x[other] - list->x[k], dy = list->y[other] - list->y[k];
    return dx * dx + dy * dy <= reach * reach ? push(pairs, room, k, other) : 0;
}

static int search_cell(const struct cell_list *list, size_t k, struct cell cell, struct near_pairs *pairs, size_t *room)
{
    for (size_t other = list->head[bucket_of(list, cell)]; other != NONE; other = list->next[other]) {
        struct cell at = cell_at(list, cell.level, list->x[other], list->y[other]);
        if (at.column == cell.column && at.row == cell.row && offer(list, k, cell.level, other, pairs, room))
            return -1;
    }
    return 0;
}

/* Without the cells, which would be more than there are discs. */
static int search_class(const struct cell_list *list, size_t k, int level, struct near_pairs *pairs, size_t *room)
{
    for (size_t other = 0; other < list->count; other++)
        if (offer(list, k, level, other, pairs, room))
            return -1;
    return 0;
}

static int search_level(const struct cell_list *list, size_t k, int level, struct near_pairs *pairs, size_t *room)
{
    double reach = list->radius[k] + list->largest[level] + list->margin, across = 2 * reach / list->width[level] + 2;
    if (!(across * across <= (double)list->count + MOST_NEAR_CELLS))
        return search_class(list, k, level, pairs, room);
    struct cell low = cell_at(list, level, list->x[k] - reach, list->y[k] - reach);
    struct cell high = cell_at(list, level, list->x[k] + reach, list->y[k] + reach);
    for (int64_t row = low.row; row <= high.row; row++)
        for (int64_t column = low.column; column <= high.column; column++)
            if (search_cell(list, k, (struct cell){level, column, row}, pairs, room))
                return -1;
    return 0;
}

static int search_around(const struct cell_list *list, size_t k, struct near_pairs *pairs, size_t *room)
{
    for (int level = 0; level <= list->level[k]; level++)
        if (list->largest[level] > 0 && search_level(list, k, level, pairs, room))
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
    struct cell_list list = {.x = x, .y = y, .radius = radius, .count = count, .margin = margin};
    size_t room = 0;
    *pairs = (struct near_pairs){0};
    int status = fill(&list, skip);
    for (size_t k = 0; status == 0 && k < count; k++)
        if (list.level[k] >= 0)
            status = search_around(&list, k, pairs, &room);
    if (status == 0)
        status = sort_pairs(pairs, count);
    if (status)
        near_pairs_free(pairs);
    free(list.level);
    free(list.next);
    free(list.head);
    return status;
}

void near_pairs_free(struct near_pairs *pairs)
{
    free(pairs->i);
    free(pairs->j);
    *pairs = (struct near_pairs){0};
}
