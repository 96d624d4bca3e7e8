#include "forces/anderson.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "pipeline/error.h"

enum { MOST_COLUMNS = 32 };

int anderson_begin(struct anderson *state, size_t n, int m)
{
    memset(state, 0, sizeof *state);
    state->n = n;
    state->m = m < MOST_COLUMNS ? m : MOST_COLUMNS;
    size_t size = (n + 1) * (size_t)(state->m > 0 ? state->m : 1);
    state->dg = calloc(size, sizeof(double));
    state->dr = calloc(size, sizeof(double));
    state->q = calloc(size, sizeof(double));
    state->g = calloc(n + 1, sizeof(double));
    state->r = calloc(n + 1, sizeof(double));
    if (state->dg && state->dr && state->q && state->g && state->r)
        return 0;
    anderson_free(state);
    return error_memory("acceleration");
}

void anderson_free(struct anderson *state)
{
    free(state->dg), free(state->dr), free(state->q), free(state->g), free(state->r);
    memset(state, 0, sizeof *state);
}

void anderson_restart(struct anderson *state)
{
    state->count = state->next = state->primed = 0;
}

static double dot(size_t n, const double *a, const double *b)
{
    double sum = 0;
    for (size_t k = 0; k < n; k++)
        sum += a[k] * b[k];
    return sum;
}

static void subtract(size_t n, double s, const double *a, double *from)
{
    for (size_t k = 0; k < n; k++)
        from[k] -= s * a[k];
}

static void remember(struct anderson *state, const double *x, const double *g)
{
    double *dg = state->dg + (size_t)state->next * state->n, *dr = state->dr + (size_t)state->next * state->n;
    for (size_t k = 0; k < state->n; k++) {
        double r = g[k] - x[k];
        dg[k] = g[k] - state->g[k];
        dr[k] = r - state->r[k];
        state->g[k] = g[k];
        state->r[k] = r;
    }
    if (state->primed) {
        state->next = (state->next + 1) % state->m;
        state->count += state->count < state->m;
    }
    state->primed = 1;
}

/* Least squares |r - dR gamma| by modified Gram-Schmidt, newest column first; a column that the newer ones nearly span
 * is left out, and with it all older ones. */
static void mix(struct anderson *state, double *out)
{
    size_t n = state->n;
    double upper[MOST_COLUMNS][MOST_COLUMNS], right[MOST_COLUMNS], gamma[MOST_COLUMNS];
    int used = 0, column[MOST_COLUMNS];
    for (int k = 0; k < state->count; k++) {
        int c = (state->next - 1 - k + 2 * state->m) % state->m;
        double *q = state->q + (size_t)used * n;
        memcpy(q, state->dr + (size_t)c * n, n * sizeof *q);
        double before = sqrt(dot(n, q, q));
        for (int p = 0; p < used; p++) {
            upper[p][used] = dot(n, state->q + (size_t)p * n, q);
            subtract(n, upper[p][used], state->q + (size_t)p * n, q);
        }
        double norm = sqrt(dot(n, q, q));
        if (!(norm > 1e-7 * before) || !(before > 0))
            break;
        for (size_t d = 0; d < n; d++)
            q[d] /= norm;
        upper[used][used] = norm;
        right[used] = dot(n, q, state->r);
        column[used++] = c;
    }
    memcpy(out, state->g, n * sizeof *out);
    for (int p = used - 1; p >= 0; p--) {
        gamma[p] = right[p];
        for (int k = p + 1; k < used; k++)
            gamma[p] -= upper[p][k] * gamma[k];
        gamma[p] /= upper[p][p];
        subtract(n, gamma[p], state->dg + (size_t)column[p] * n, out);
    }
}

void anderson_step(struct anderson *state, const double *x, const double *g, double *out)
{
    if (state->m <= 0) {
        memcpy(out, g, state->n * sizeof *out);
        return;
    }
    remember(state, x, g);
    mix(state, out);
}
