/* Left-looking: each panel of columns first gathers what earlier panels say about it, A(panel) - sum L D L', then it is
 * factorised by itself. An earlier panel knows by its rows which panel it changes next: it waits in that panel's list
 * (`head`, `next`), as in sparse left-looking Cholesky (Ng and Peyton 1993), but with D between both factors and with
 * any sign in D. Quasi-definite matrices have such a factor in every order of the unknowns (Vanderbei 1995). The inner
 * loop multiplies tiles of four rows with four columns, always in the same order of sums. */
#include "forces/algebra/supernodal.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "pipeline/numbers/simd.h"

enum { TILE = 4, MOST_COLUMNS = 48 /* of a panel: wider supernodes are cut, so that a panel stays in the cache */ };

/* Columns side by side with the same rows below: dense, column by column, `rows` apart. */
struct panel {
    int first, columns, rows;
    size_t row; /* where its rows begin in the list */
    size_t at;  /* where its values begin */
};

struct supernodal {
    size_t unknowns, panels, entries;
    struct panel *panel;
    int *row;        /* of all supernodes, ordered numbering */
    int *order;      /* unknown of each column */
    int *panel_of;   /* of each column */
    size_t *target;  /* of each entry of A: its place in x */
    double *x;       /* the panels: below the diagonal L, whose diagonal is 1 */
    double *pivot;   /* D */
    int *head;       /* per panel: first panel that still changes it, -1: none */
    int *next, *pos; /* per panel: next in that list; its first row that was not yet used */
    int *where;      /* per unknown: row in the present panel */
    int *relative;   /* per row of a panel: row in the present one */
    double *work;    /* one per unknown */
    double *below;   /* one per row of a panel */
};

/* ---- structure ---- */

static size_t count_panels(const struct supernodes *supernodes)
{
    size_t panels = 0;
    for (size_t s = 0; s < supernodes->count; s++)
        panels += (size_t)(supernodes->first[s + 1] - supernodes->first[s] + MOST_COLUMNS - 1) / MOST_COLUMNS;
    return panels;
}

/* Cut supernodes into panels; returns the number of values. */
static size_t fill_panels(struct supernodal *factor, const struct supernodes *supernodes)
{
    size_t p = 0, at = 0;
    for (size_t s = 0; s < supernodes->count; s++) {
        int first = supernodes->first[s], end = supernodes->first[s + 1];
        int rows = supernodes->begin[s + 1] - supernodes->begin[s];
        for (int c = first; c < end; c += MOST_COLUMNS, p++) {
            int columns = end - c < MOST_COLUMNS ? end - c : MOST_COLUMNS, passed = c - first;
            factor->panel[p] = (struct panel){.first = c,
                                              .columns = columns,
                                              .rows = rows - passed,
                                              .row = (size_t)supernodes->begin[s] + (size_t)passed,
                                              .at = at};
            at += (size_t)columns * (size_t)(rows - passed);
            for (int k = c; k < c + columns; k++)
                factor->panel_of[k] = (int)p;
        }
    }
    return at;
}

/* Where the entry (row, column) of the ordered matrix stands in x. */
static size_t place_of(const struct supernodal *factor, int column, int row)
{
    const struct panel *panel = &factor->panel[factor->panel_of[column]];
    int at = sorted_find(factor->row + panel->row, 0, panel->rows, row);
    return panel->at + (size_t)(column - panel->first) * (size_t)panel->rows + (size_t)at;
}

/* Entries of the given lower triangle go to the lower triangle of the ordered matrix. */
static void fill_targets(struct supernodal *factor, const int *start, const int *row)
{
    int *number = factor->where; /* ordered number of each unknown */
    for (size_t k = 0; k < factor->unknowns; k++)
        number[factor->order[k]] = (int)k;
    for (size_t c = 0; c < factor->unknowns; c++)
        for (int k = start[c]; k < start[c + 1]; k++) {
            int p = number[c], q = number[row[k]];
            factor->target[k] = place_of(factor, p < q ? p : q, p < q ? q : p);
        }
}

/* Everything but `x`, whose size the panels tell, then `x`. -1: memory is gone; the caller frees. */
static int allocate(struct supernodal *factor, const struct supernodes *supernodes)
{
    size_t n = factor->unknowns, rows = (size_t)supernodes->begin[supernodes->count];
    factor->panel = calloc(factor->panels + 1, sizeof *factor->panel);
    factor->row = calloc(rows + 1, sizeof(int));
    factor->order = calloc(n + 1, sizeof(int)), factor->panel_of = calloc(n + 1, sizeof(int));
    factor->target = calloc(factor->entries + 1, sizeof *factor->target);
    factor->head = calloc(factor->panels + 1, sizeof(int));
    factor->next = calloc(factor->panels + 1, sizeof(int)), factor->pos = calloc(factor->panels + 1, sizeof(int));
    factor->where = calloc(n + 1, sizeof(int)), factor->relative = calloc(n + TILE, sizeof(int));
    factor->pivot = calloc(n + 1, sizeof(double)), factor->work = calloc(n + 1, sizeof(double));
    factor->below = calloc(n + TILE, sizeof(double));
    if (!factor->panel || !factor->row || !factor->order || !factor->panel_of || !factor->target || !factor->head ||
        !factor->next || !factor->pos || !factor->where || !factor->relative || !factor->pivot || !factor->work ||
        !factor->below)
        return -1;
    memcpy(factor->row, supernodes->row, rows * sizeof(int));
    memcpy(factor->order, supernodes->order, n * sizeof(int));
    factor->x = calloc(fill_panels(factor, supernodes) + TILE, sizeof(double)); /* a tile reads past the last column */
    return factor->x ? 0 : -1;
}

struct supernodal *supernodal_create(const struct supernodes *supernodes, const int *start, const int *row)
{
    struct supernodal *factor = calloc(1, sizeof *factor);
    if (!factor)
        return NULL;
    factor->unknowns = supernodes->unknowns;
    factor->panels = count_panels(supernodes);
    factor->entries = (size_t)start[supernodes->unknowns];
    if (allocate(factor, supernodes)) {
        supernodal_free(factor);
        return NULL;
    }
    fill_targets(factor, start, row);
    return factor;
}

void supernodal_free(struct supernodal *factor)
{
    if (!factor)
        return;
    free(factor->panel), free(factor->row), free(factor->order), free(factor->panel_of), free(factor->target);
    free(factor->x), free(factor->pivot), free(factor->head), free(factor->next), free(factor->pos);
    free(factor->where), free(factor->relative), free(factor->work), free(factor->below);
    free(factor);
}

/* ---- factorisation ---- */

/* Four rows of a column, wherever they begin; each element is summed in the same order on every machine. */
typedef double quad __attribute__((vector_size(TILE * sizeof(double)), aligned(sizeof(double)), may_alias));

/* c[j] = sum over k < depth of a[k * apart .. + 3] b[4 k + j]. */
static inline void tile(const double *a, size_t apart, const double *b, int depth, quad c[TILE])
{
    quad c0 = {0}, c1 = {0}, c2 = {0}, c3 = {0};
    for (int k = 0; k < depth; k++, a += apart, b += TILE) {
        quad rows = *(const quad *)a;
        c0 += rows * b[0];
        c1 += rows * b[1];
        c2 += rows * b[2];
        c3 += rows * b[3];
    }
    c[0] = c0, c[1] = c1, c[2] = c2, c[3] = c3;
}

/* Rows begin + j of the first `depth` columns of L, times D: b of tile(); zero from `end` on. */
static void pack(const struct supernodal *factor, const struct panel *from, int depth, int begin, int end, double *b)
{
    for (int k = 0; k < depth; k++) {
        const double *column = factor->x + from->at + (size_t)k * (size_t)from->rows;
        double pivot = factor->pivot[from->first + k];
        for (int j = 0; j < TILE; j++)
            b[k * TILE + j] = begin + j < end ? column[begin + j] * pivot : 0;
    }
}

/* Take what the first `depth` columns of `from` say about its rows begin .. end - 1, which are columns of `to`, from
 * `to`. relative: row in `to` of each row of `from`. Above the diagonal the panel holds nothing of use. */
SIMD_CLONES static void take_away(struct supernodal *factor, const struct panel *from, int depth, int begin, int end,
                                  const int *relative, const struct panel *to)
{
    double b[MOST_COLUMNS * TILE];
    size_t apart = (size_t)to->rows;
    for (int j = begin; j < end; j += TILE) {
        int columns = end - j < TILE ? end - j : TILE;
        pack(factor, from, depth, j, end, b);
        for (int i = j; i < from->rows; i += TILE) {
            quad c[TILE];
            int rows = from->rows - i < TILE ? from->rows - i : TILE;
            tile(factor->x + from->at + i, (size_t)from->rows, b, depth, c);
            int together = rows == TILE && relative[i + TILE - 1] - relative[i] == TILE - 1;
            for (int k = 0; k < columns; k++) {
                double *column = factor->x + to->at + (size_t)relative[j + k] * apart;
                if (together)
                    *(quad *)(column + relative[i]) -= c[k];
                else
                    for (int r = 0; r < rows; r++)
                        column[relative[i + r]] -= c[k][r];
            }
        }
    }
}

/* Columns begin .. end - 1 of a panel, up to date but for each other. */
SIMD_CLONES static int eliminate(struct supernodal *factor, const struct panel *panel, int begin, int end, int definite)
{
    size_t apart = (size_t)panel->rows;
    for (int c = begin; c < end; c++) {
        double *column = factor->x + panel->at + (size_t)c * apart, pivot = column[c];
        if (!isfinite(pivot) || pivot == 0 || (definite && pivot < 0))
            return 1;
        factor->pivot[panel->first + c] = pivot;
        double inverse = 1 / pivot;
        for (int k = c + 1; k < end; k++) {
            double *other = factor->x + panel->at + (size_t)k * apart, share = column[k] * inverse;
            for (int i = k; i < panel->rows; i++)
                other[i] -= column[i] * share;
        }
        for (int i = c + 1; i < panel->rows; i++)
            column[i] *= inverse;
    }
    return 0;
}

/* Its own columns, four at a time: take away what the columns before say about them, then eliminate. */
static int factorise_panel(struct supernodal *factor, const struct panel *panel, int definite)
{
    for (int i = 0; i < panel->rows; i++)
        factor->relative[i] = i;
    for (int c = 0; c < panel->columns; c += TILE) {
        int end = c + TILE < panel->columns ? c + TILE : panel->columns;
        if (c > 0)
            take_away(factor, panel, c, c, end, factor->relative, panel);
        if (eliminate(factor, panel, c, end, definite))
            return 1;
    }
    return 0;
}

/* Panel p next changes the panel to which its row `pos` belongs. */
static void enlist(struct supernodal *factor, int p, int pos)
{
    const struct panel *panel = &factor->panel[p];
    factor->pos[p] = pos;
    if (pos >= panel->rows)
        return;
    int target = factor->panel_of[factor->row[panel->row + (size_t)pos]];
    factor->next[p] = factor->head[target];
    factor->head[target] = p;
}

/* Take what all waiting panels say about panel p from it, and let them wait for the next one that they change. */
static void gather_changes(struct supernodal *factor, int p)
{
    const struct panel *to = &factor->panel[p];
    for (int i = 0; i < to->rows; i++)
        factor->where[factor->row[to->row + (size_t)i]] = i;
    for (int k = factor->head[p], following; k >= 0; k = following) {
        const struct panel *from = &factor->panel[k];
        const int *row = factor->row + from->row;
        int begin = factor->pos[k], end = begin;
        following = factor->next[k];
        while (end < from->rows && row[end] < to->first + to->columns)
            end++;
        for (int i = begin; i < from->rows; i++)
            factor->relative[i] = factor->where[row[i]];
        take_away(factor, from, from->columns, begin, end, factor->relative, to);
        enlist(factor, k, end);
    }
}

/* x = the values of A, plus the shift on the diagonal. */
static void scatter(struct supernodal *factor, const double *values, double shift)
{
    const struct panel *last = &factor->panel[factor->panels - 1];
    memset(factor->x, 0, (last->at + (size_t)last->columns * (size_t)last->rows) * sizeof(double));
    for (size_t k = 0; k < factor->entries; k++)
        factor->x[factor->target[k]] += values[k];
    for (size_t p = 0; p < factor->panels && shift != 0; p++)
        for (int c = 0; c < factor->panel[p].columns; c++)
            factor->x[factor->panel[p].at + (size_t)c * (size_t)(factor->panel[p].rows + 1)] += shift;
}

int supernodal_factorise(struct supernodal *factor, const double *values, double shift, int definite)
{
    if (factor->panels == 0)
        return 0;
    scatter(factor, values, shift);
    for (size_t p = 0; p < factor->panels; p++)
        factor->head[p] = -1;
    for (size_t p = 0; p < factor->panels; p++) {
        gather_changes(factor, (int)p);
        if (factorise_panel(factor, &factor->panel[p], definite))
            return 1;
        enlist(factor, (int)p, factor->panel[p].columns);
    }
    return 0;
}

double supernodal_rcond(const struct supernodal *factor)
{
    double least = INFINITY, most = 0;
    for (size_t k = 0; k < factor->unknowns; k++) {
        least = fmin(least, fabs(factor->pivot[k]));
        most = fmax(most, fabs(factor->pivot[k]));
    }
    return most > 0 ? least / most : 1;
}

/* ---- solution ---- */

/* L x = work, panel by panel. */
SIMD_CLONES static void solve_down(struct supernodal *factor, const struct panel *panel)
{
    double *x = factor->work + panel->first, *below = factor->below;
    const int *row = factor->row + panel->row;
    memset(below, 0, (size_t)panel->rows * sizeof *below);
    for (int c = 0; c < panel->columns; c++) {
        const double *column = factor->x + panel->at + (size_t)c * (size_t)panel->rows;
        double value = x[c] -= below[c];
        for (int i = c + 1; i < panel->rows; i++)
            below[i] += column[i] * value;
    }
    for (int i = panel->columns; i < panel->rows; i++)
        factor->work[row[i]] -= below[i];
}

/* Four sums side by side. */
static double dot(const double *a, const double *b, int count)
{
    quad sum = {0};
    int k = 0;
    for (; k + TILE <= count; k += TILE)
        sum += *(const quad *)(a + k) * *(const quad *)(b + k);
    double rest = 0;
    for (; k < count; k++)
        rest += a[k] * b[k];
    return (sum[0] + sum[1]) + (sum[2] + sum[3]) + rest;
}

/* L' x = work. */
SIMD_CLONES static void solve_up(struct supernodal *factor, const struct panel *panel)
{
    double *x = factor->work + panel->first, *below = factor->below;
    const int *row = factor->row + panel->row;
    for (int i = 0; i < panel->rows; i++)
        below[i] = factor->work[row[i]];
    for (int c = panel->columns - 1; c >= 0; c--) {
        const double *column = factor->x + panel->at + (size_t)c * (size_t)panel->rows;
        below[c] -= dot(column + c + 1, below + c + 1, panel->rows - c - 1);
        x[c] = below[c];
    }
}

void supernodal_solve(struct supernodal *factor, const double *right, double *solution)
{
    for (size_t k = 0; k < factor->unknowns; k++)
        factor->work[k] = right[factor->order[k]];
    for (size_t p = 0; p < factor->panels; p++)
        solve_down(factor, &factor->panel[p]);
    for (size_t k = 0; k < factor->unknowns; k++)
        factor->work[k] /= factor->pivot[k];
    for (size_t p = factor->panels; p > 0; p--)
        solve_up(factor, &factor->panel[p - 1]);
    for (size_t k = 0; k < factor->unknowns; k++)
        solution[factor->order[k]] = factor->work[k];
}
