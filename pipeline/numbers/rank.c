/* The rank of A is that of the positive semidefinite M = A A', whose elimination needs no exchange of rows: a pivot
 * that vanishes belongs to a row that depends on those before it, and all that is left of its column vanishes with it.
 *
 * Rows are eliminated by nested dissection (George, SIAM J. Numer. Anal. 10 (1973) 345) along lines in the plane: the
 * rows on both sides of a line are eliminated first, then those of one side that share a column with the other. What
 * elimination leaves of a part is a dense matrix over the rows around it (the front; Duff & Reid, ACM Trans. Math.
 * Softw. 9 (1983) 302). Only the number of pivots is wanted, so that nothing else is kept: N^1.5 operations and
 * N memory for N rows. */
#include "pipeline/numbers/rank.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "pipeline/numbers/quantiles.h"
#include "pipeline/speak/error.h"

enum { LEAF = 24 };       /* rows that are not parted further */
#define LEAST_PIVOT 1e-10 /* the square of 1e-5 in A, whose entries are of size 1 */
static const size_t NONE = (size_t)-1;

/* A dense symmetric matrix over some rows, those to be eliminated first. */
struct front {
    size_t count, *row;
    double *m; /* count x count, the lower triangle */
};

/* A part of the rows and the columns that belong to it. */
struct part {
    size_t *rows, count;
    size_t *columns, column_count;
};

struct elimination {
    const struct rank_column *columns;
    const struct vec *place;
    size_t *at;     /* of each row: where it stands in the front that is being assembled, or NONE */
    char *side;     /* of each row: in the part's near half, its far half, its dividing line; OUTSIDE else */
    double *values; /* room for one number per row */
    size_t *sorted; /* room for a list */
    char *kind;     /* of each entry of the list that is being sorted */
    size_t rank;
};
enum { OUTSIDE, NEAR, FAR, LINE };

static void front_free(struct front *front)
{
    free(front->row);
    free(front->m);
    *front = (struct front){0};
}

static void note_rows(struct elimination *e, const size_t *rows, size_t count, struct front *front)
{
    for (size_t k = 0; k < count; k++)
        if (e->at[rows[k]] == NONE) {
            e->at[rows[k]] = front->count;
            front->row[front->count++] = rows[k];
        }
}

/* The front of the rows to be eliminated (first) and all others that the columns and the parts' rests touch. */
static int front_open(struct elimination *e, const struct part *part, const struct front *rests, struct front *front)
{
    size_t most = part->count + RANK_WIDTH * part->column_count + rests[0].count + rests[1].count;
    *front = (struct front){.row = malloc((most + 1) * sizeof *front->row)};
    if (!front->row)
        return error_memory("the rank of the equations");
    note_rows(e, part->rows, part->count, front);
    for (int r = 0; r < 2; r++)
        note_rows(e, rests[r].row, rests[r].count, front);
    for (size_t c = 0; c < part->column_count; c++)
        note_rows(e, e->columns[part->columns[c]].row, (size_t)e->columns[part->columns[c]].count, front);
    front->m = calloc(front->count * front->count + 1, sizeof *front->m);
    return front->m ? 0 : error_memory("the rank of the equations");
}

static void add(const struct elimination *e, size_t row, size_t column, double value, struct front *front)
{
    size_t i = e->at[row], j = e->at[column];
    if (i < j) {
        size_t swap = i;
        i = j, j = swap;
    }
    front->m[i * front->count + j] += value;
}

static void front_assemble(struct elimination *e, const struct part *part, const struct front *rests,
                           struct front *front)
{
    for (size_t c = 0; c < part->column_count; c++) {
        const struct rank_column *column = &e->columns[part->columns[c]];
        for (int a = 0; a < column->count; a++)
            for (int b = 0; b <= a; b++)
                add(e, column->row[a], column->row[b], column->value[a] * column->value[b], front);
    }
    for (int r = 0; r < 2; r++)
        for (size_t i = 0; i < rests[r].count; i++)
            for (size_t j = 0; j <= i; j++)
                add(e, rests[r].row[i], rests[r].row[j], rests[r].m[i * rests[r].count + j], front);
    for (size_t k = 0; k < front->count; k++)
        e->at[front->row[k]] = NONE;
}

/* Column by column, as in L D L': what is left stands in the last rows and columns. */
static void front_eliminate(struct elimination *e, size_t pivots, struct front *front)
{
    size_t n = front->count, left = n - pivots;
    for (size_t k = 0; k < pivots; k++) {
        double pivot = front->m[k * n + k], *column = front->m + k * n; /* row k is not read again: room for column k */
        if (!(pivot > LEAST_PIVOT))
            continue;
        e->rank++;
        for (size_t i = k + 1; i < n; i++)
            column[i] = front->m[i * n + k];
        for (size_t i = k + 1; i < n; i++) {
            double factor = column[i] / pivot, *row = front->m + i * n;
            for (size_t j = k + 1; j <= i && factor != 0; j++)
                row[j] -= factor * column[j];
        }
    }
    for (size_t i = 0; i < left; i++) {
        memmove(front->m + i * left, front->m + (i + pivots) * n + pivots, (i + 1) * sizeof *front->m);
        front->row[i] = front->row[i + pivots];
    }
    front->count = left;
}

/* ---- dissection ---- */

/* The half of each row by its place along the longer side of the part; 0 when all lie together. */
static int choose_sides(struct elimination *e, const struct part *part)
{
    struct vec low = vec(INFINITY, INFINITY), high = vec(-INFINITY, -INFINITY);
    for (size_t k = 0; k < part->count; k++) {
        struct vec at = e->place[part->rows[k]];
        low = vec(fmin(low.x, at.x), fmin(low.y, at.y));
        high = vec(fmax(high.x, at.x), fmax(high.y, at.y));
    }
    int along_y = high.y - low.y > high.x - low.x;
    for (size_t k = 0; k < part->count; k++)
        e->values[k] = along_y ? e->place[part->rows[k]].y : e->place[part->rows[k]].x;
    double middle = select_rank(e->values, part->count, part->count / 2);
    int parted = 0;
    for (size_t k = 0; k < part->count; k++) {
        int near = (along_y ? e->place[part->rows[k]].y : e->place[part->rows[k]].x) < middle;
        e->side[part->rows[k]] = near ? NEAR : FAR;
        parted |= near;
    }
    return parted;
}

static int touches(const struct elimination *e, size_t column, char side)
{
    for (int a = 0; a < e->columns[column].count; a++)
        if (e->side[e->columns[column].row[a]] == side)
            return 1;
    return 0;
}

/* Rows of the near half that share a column with the far one become the line between them. */
static void draw_line(struct elimination *e, const struct part *part)
{
    for (size_t c = 0; c < part->column_count; c++) {
        const struct rank_column *column = &e->columns[part->columns[c]];
        if (!touches(e, part->columns[c], FAR))
            continue;
        for (int a = 0; a < column->count; a++)
            if (e->side[column->row[a]] == NEAR)
                e->side[column->row[a]] = LINE;
    }
}

/* Sort list by kind, in place and otherwise in order; lists[k] is where kind k + 1 begins, counts[k] how many. */
static void sort_by_kind(struct elimination *e, size_t *list, size_t count, size_t *lists[3], size_t counts[3])
{
    size_t at = 0;
    for (char kind = NEAR; kind <= LINE; kind++) {
        lists[kind - NEAR] = list + at;
        for (size_t k = 0; k < count; k++)
            if (e->kind[k] == kind)
                e->sorted[at++] = list[k];
        counts[kind - NEAR] = (size_t)(list + at - lists[kind - NEAR]);
    }
    memcpy(list, e->sorted, count * sizeof *list);
}

/* Near half, far half, and line of a part, each with its columns. */
static void part_in_three(struct elimination *e, struct part *part, struct part three[3])
{
    size_t *rows[3], *columns[3], row_counts[3], column_counts[3];
    draw_line(e, part);
    for (size_t c = 0; c < part->column_count; c++)
        e->kind[c] = touches(e, part->columns[c], NEAR) ? NEAR : touches(e, part->columns[c], FAR) ? FAR : LINE;
    sort_by_kind(e, part->columns, part->column_count, columns, column_counts);
    for (size_t k = 0; k < part->count; k++)
        e->kind[k] = e->side[part->rows[k]];
    sort_by_kind(e, part->rows, part->count, rows, row_counts);
    for (size_t k = 0; k < part->count; k++)
        e->side[part->rows[k]] = OUTSIDE;
    for (int k = 0; k < 3; k++)
        three[k] = (struct part){rows[k], row_counts[k], columns[k], column_counts[k]};
}

/* Eliminate the rows of a part; `rest` is what is left over the rows around it. */
static int dissect(struct elimination *e, struct part *part, struct front *rest)
{
    struct part three[3] = {{0}};
    struct front rests[2] = {{0}};
    int status = 0;
    *rest = (struct front){0};
    if (part->count <= LEAF || !choose_sides(e, part)) {
        three[2] = *part;
        for (size_t k = 0; k < part->count; k++)
            e->side[part->rows[k]] = OUTSIDE;
    } else {
        part_in_three(e, part, three);
        status = dissect(e, &three[0], &rests[0]) || dissect(e, &three[1], &rests[1]) ? -1 : 0;
    }
    if (status == 0)
        status = front_open(e, &three[2], rests, rest);
    if (status == 0) {
        front_assemble(e, &three[2], rests, rest);
        front_eliminate(e, three[2].count, rest);
    }
    front_free(&rests[0]);
    front_free(&rests[1]);
    return status;
}

/* The rows that lie anywhere come last, when all others are eliminated. */
static int eliminate(struct elimination *e, size_t count, size_t rows, size_t *lists)
{
    struct part part = {.rows = lists, .columns = lists + rows, .column_count = count};
    struct part anywhere = {0};
    struct front rests[2] = {{0}}, last = {0};
    for (size_t r = 0; r < rows; r++)
        if (isfinite(e->place[r].x) && isfinite(e->place[r].y))
            part.rows[part.count++] = r;
    anywhere.rows = part.rows + part.count;
    for (size_t r = 0; r < rows; r++)
        if (!(isfinite(e->place[r].x) && isfinite(e->place[r].y)))
            anywhere.rows[anywhere.count++] = r;
    for (size_t c = 0; c < count; c++)
        part.columns[c] = c;
    int status = dissect(e, &part, &rests[0]);
    if (status == 0)
        status = front_open(e, &anywhere, rests, &last);
    if (status == 0) {
        front_assemble(e, &anywhere, rests, &last);
        front_eliminate(e, anywhere.count, &last);
    }
    front_free(&rests[0]);
    front_free(&last);
    return status;
}

int rank_of(const struct rank_column *columns, size_t count, const struct vec *place, size_t rows, size_t *rank)
{
    size_t most = rows + count + 1;
    struct elimination e = {.columns = columns, .place = place};
    size_t *lists = malloc(most * sizeof *lists);
    e.values = malloc((rows + 1) * sizeof *e.values);
    e.at = malloc((rows + 1) * sizeof *e.at);
    e.sorted = malloc(most * sizeof *e.sorted);
    e.side = calloc(rows + 1, 1);
    e.kind = malloc(most);
    int good = lists && e.values && e.at && e.sorted && e.side && e.kind;
    int status = good ? 0 : error_memory("the rank of the equations");
    if (good) {
        for (size_t r = 0; r < rows; r++)
            e.at[r] = NONE;
        status = eliminate(&e, count, rows, lists);
    }
    *rank = e.rank;
    free(lists), free(e.values), free(e.at), free(e.sorted), free(e.side), free(e.kind);
    return status;
}
