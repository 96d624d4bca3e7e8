/* With images g_k = g(x_k) and residuals r_k = g_k - x_k, the columns of dG and dR are the differences of consecutive
 * images and residuals; the next point is
 *
 *     g - dG gamma,   gamma = argmin |r - dR gamma|,
 *
 * solved by the normal equations dR' dR gamma = dR' r, whose matrix (`gram`) changes by one row per step. Without
 * history, or when every column was left out, the next point is g itself. */
#include "forces/algebra/anderson.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "pipeline/speak/error.h"

#define SPANNED 1e-11 /* share of a column's square that the newer ones must leave: above rounding */

int anderson_begin(struct anderson *state, size_t n, int m)
{
    memset(state, 0, sizeof *state);
    state->n = n;
    state->m = m < ANDERSON_MOST ? m : ANDERSON_MOST;
    size_t columns = n * (size_t)(state->m > 0 ? state->m : 1);
    state->dg = calloc(2 * columns + 2 * n + 1, sizeof(double)); /* one block for all four */
    if (!state->dg)
        return error_memory("acceleration");
    state->dr = state->dg + columns;
    state->g = state->dr + columns;
    state->r = state->g + n;
    return 0;
}

void anderson_free(struct anderson *state)
{
    free(state->dg);
    memset(state, 0, sizeof *state);
}

void anderson_restart(struct anderson *state)
{
    state->count = state->next = state->primed = 0;
}

/* Four sums side by side, in a fixed order: fast, and the same on every machine. */
static double dot(size_t n, const double *a, const double *b)
{
    double sum[4] = {0};
    size_t k = 0;
    for (; k + 4 <= n; k += 4)
        for (size_t i = 0; i < 4; i++)
            sum[i] += a[k + i] * b[k + i];
    for (; k < n; k++)
        sum[0] += a[k] * b[k];
    return (sum[0] + sum[1]) + (sum[2] + sum[3]);
}

/* Column `next` of dG and dR from this image and the last one; its row of the products. */
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
        int here = state->next;
        state->next = (here + 1) % state->m;
        state->count += state->count < state->m;
        for (int c = 0; c < state->count; c++)
            state->gram[here][c] = state->gram[c][here] = dot(state->n, dr, state->dr + (size_t)c * state->n);
    }
    state->primed = 1;
}

/* Least squares |r - dR gamma| by the normal equations, newest column first. A column that the newer ones nearly span
 * would bring rounding only: it is left out, and with it all older ones. Cholesky: lower L' = dR' dR. */
static void mix(struct anderson *state, double *out)
{
    size_t n = state->n;
    double lower[ANDERSON_MOST][ANDERSON_MOST], gamma[ANDERSON_MOST];
    int used = 0, column[ANDERSON_MOST];
    for (int k = 0; k < state->count; k++) {
        int c = (state->next - 1 - k + 2 * state->m) % state->m;
        double left = state->gram[c][c], sum = dot(n, state->dr + (size_t)c * n, state->r);
        for (int p = 0; p < used; p++) {
            double entry = state->gram[c][column[p]];
            for (int q = 0; q < p; q++)
                entry -= lower[used][q] * lower[p][q];
            lower[used][p] = entry / lower[p][p];
            left -= lower[used][p] * lower[used][p];
            sum -= lower[used][p] * gamma[p];
        }
        if (!(left > SPANNED * state->gram[c][c]))
            break;
        lower[used][used] = sqrt(left);
        gamma[used] = sum / lower[used][used];
        column[used++] = c;
    }
    memcpy(out, state->g, n * sizeof *out);
    for (int p = used - 1; p >= 0; p--) {
        const double *dg = state->dg + (size_t)column[p] * n;
        for (int k = p + 1; k < used; k++)
            gamma[p] -= lower[k][p] * gamma[k];
        gamma[p] /= lower[p][p];
        for (size_t d = 0; d < n; d++)
            out[d] -= gamma[p] * dg[d];
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
