/* The degree of force indeterminacy from its definition: unknown forces less the rank of the matrix of equilibrium,
 * which stands here in full and is eliminated with full pivoting. Cost: unknowns x equations^2. */
#ifndef TESTS_RANK_BY_HAND_H
#define TESTS_RANK_BY_HAND_H

#include "tests/check.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "pipeline/packing/packing.h"

static inline size_t rank_by_elimination(double *m, size_t rows, size_t columns)
{
    for (size_t k = 0; k < rows && k < columns; k++) {
        size_t row = k, column = k;
        for (size_t i = k; i < rows; i++)
            for (size_t j = k; j < columns; j++)
                if (fabs(m[i * columns + j]) > fabs(m[row * columns + column]))
                    row = i, column = j;
        if (fabs(m[row * columns + column]) < 1e-9) /* entries are of size 1 */
            return k;
        for (size_t j = 0; j < columns; j++) {
            double swap = m[k * columns + j];
            m[k * columns + j] = m[row * columns + j], m[row * columns + j] = swap;
        }
        for (size_t i = 0; i < rows; i++) {
            double swap = m[i * columns + k];
            m[i * columns + k] = m[i * columns + column], m[i * columns + column] = swap;
        }
        for (size_t i = k + 1; i < rows; i++) {
            double factor = m[i * columns + k] / m[k * columns + k];
            for (size_t j = k; j < columns && factor != 0; j++)
                m[i * columns + j] -= factor * m[k * columns + j];
        }
    }
    return rows < columns ? rows : columns;
}

static inline int carries_by_hand(const struct packing *p, size_t k)
{
    return !(p->grains.flags[k] & (GRAIN_RATTLER | GRAIN_NOT_FINITE));
}

/* Unknown loads: NaN. Of two loaded walls that face each other, left and bottom react. Upright walls. */
static inline int moves_by_hand(const struct packing *p, const char *name, const char *opposite, const double *load)
{
    long w = walls_find(&p->walls, name), other = walls_find(&p->walls, opposite);
    return w >= 0 && isfinite(load[w]) && !(other >= 0 && isfinite(load[other]));
}

/* Rows: (x, y, moment over radius) of every grain, then right, top, left, bottom. Upright walls. */
static inline double h_by_hand(const struct packing *p, double mu, double mu_wall, double *equations)
{
    const struct contacts *c = &p->contacts;
    const struct walls *walls = &p->walls;
    size_t n = p->grains.count, rows = 3 * n + 4, columns = 2 * c->count, unknowns = 0;
    double *m = calloc(rows * columns + 1, sizeof *m);
    assert_non_null(m);
    const int moves[4] = {walls_find(walls, "right") >= 0 && isfinite(walls->fx[walls_find(walls, "right")]),
                          walls_find(walls, "top") >= 0 && isfinite(walls->fy[walls_find(walls, "top")]),
                          moves_by_hand(p, "left", "right", walls->fx), moves_by_hand(p, "bottom", "top", walls->fy)};
    *equations = moves[0] + moves[1] + moves[2] + moves[3];
    for (size_t k = 0; k < n; k++)
        *equations += carries_by_hand(p, k) && !(p->grains.flags[k] & GRAIN_FIXED) ? 3 : 0;
    for (size_t q = 0; q < c->count; q++) {
        size_t body[2] = {(size_t)c->i[q], (size_t)c->j[q]};
        int wall = body[1] >= n;
        if (c->flags[q] & (CONTACT_CANDIDATE | CONTACT_NOT_FINITE) || !carries_by_hand(p, body[0]) ||
            (!wall && !carries_by_hand(p, body[1])))
            continue;
        for (int tangent = 0; tangent < ((wall ? mu_wall : mu) == 0 ? 1 : 2); tangent++) {
            double fx = tangent ? -c->ny[q] : c->nx[q], fy = tangent ? c->nx[q] : c->ny[q];
            for (int side = 0; side < 2; side++) {
                double sign = side ? 1 : -1;
                size_t k = body[side];
                if (k < n && !(p->grains.flags[k] & GRAIN_FIXED)) {
                    double ax = c->x[q] - p->grains.x[k], ay = c->y[q] - p->grains.y[k];
                    m[(3 * k) * columns + unknowns] += sign * fx;
                    m[(3 * k + 1) * columns + unknowns] += sign * fy;
                    m[(3 * k + 2) * columns + unknowns] += sign * (ax * fy - ay * fx) / p->grains.radius[k];
                } else if (k >= n) {
                    const char *name = walls->name[k - n];
                    const char *const parts[4] = {"right", "top", "left", "bottom"};
                    for (int w = 0; w < 4; w++)
                        if (moves[w] && strstr(name, parts[w]))
                            m[(3 * n + (size_t)w) * columns + unknowns] += w % 2 ? fy : fx;
                }
            }
            unknowns++;
        }
    }
    double *packed = calloc(rows * unknowns + 1, sizeof *packed);
    assert_non_null(packed);
    for (size_t i = 0; i < rows; i++)
        memcpy(packed + i * unknowns, m + i * columns, unknowns * sizeof *m);
    double h = (double)unknowns - (double)rank_by_elimination(packed, rows, unknowns);
    free(m);
    free(packed);
    return h;
}

#endif
