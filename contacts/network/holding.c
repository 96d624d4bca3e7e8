#include "contacts/network/holding.h"

#include <math.h>

#include "pipeline/numbers/dense.h"

enum { ROWS = 4, COLUMNS_MOST = 2 * HOLDS_MOST, MAX_EXCHANGES = 100 };
#define SLACK 0.02 /* directions are known no better, and a force may sit on its cone's edge */
#define TINY 1e-12

/* min |A x - b|, x >= 0. */
struct least_squares {
    double column[COLUMNS_MOST][ROWS], b[ROWS];
    int count;
    double x[COLUMNS_MOST], trial[COLUMNS_MOST];
    int passive[COLUMNS_MOST]; /* the columns that may be positive */
    int passive_count;
};

static double dot(const double *a, const double *b)
{
    double sum = 0;
    for (int r = 0; r < ROWS; r++)
        sum += a[r] * b[r];
    return sum;
}

static void residual(const struct least_squares *p, double left[ROWS])
{
    for (int r = 0; r < ROWS; r++) {
        left[r] = p->b[r];
        for (int c = 0; c < p->count; c++)
            left[r] -= p->x[c] * p->column[c][r];
    }
}

/* Unconstrained solution on the passive columns by their normal equations; the tiny diagonal makes columns that depend
 * on each other share. */
static void solve_passive(struct least_squares *p)
{
    double m[ROWS + 1][ROWS + 2];
    int n = p->passive_count;
    for (int i = 0; i < n; i++) {
        for (int j = 0; j < n; j++)
            m[i][j] = dot(p->column[p->passive[i]], p->column[p->passive[j]]) + (i == j ? TINY : 0);
        m[i][n] = dot(p->column[p->passive[i]], p->b);
    }
    (void)dense_solve(&m[0][0], (size_t)n, ROWS + 2, -INFINITY); /* with the tiny diagonal always a solution */
    for (int i = 0; i < n; i++)
        p->trial[p->passive[i]] = m[i][n];
}

/* Go from x towards the trial as far as all stay positive; what reaches zero leaves. Returns 1 when all the way. */
static int step_towards_trial(struct least_squares *p)
{
    double share = 1;
    for (int i = 0; i < p->passive_count; i++) {
        int c = p->passive[i];
        if (p->trial[c] <= 0)
            share = fmin(share, p->x[c] / fmax(p->x[c] - p->trial[c], TINY * TINY));
    }
    int kept = 0, whole = share >= 1;
    for (int i = 0; i < p->passive_count; i++) {
        int c = p->passive[i];
        p->x[c] += share * (p->trial[c] - p->x[c]);
        if (p->x[c] > TINY)
            p->passive[kept++] = c;
        else
            p->x[c] = 0;
    }
    p->passive_count = kept;
    return whole;
}

/* The column that would reduce the residual most; -1: none. */
static int best_column(const struct least_squares *p, const double left[ROWS])
{
    int best = -1;
    double steepest = 1e-9;
    for (int c = 0; c < p->count; c++) {
        double slope = p->x[c] > 0 ? 0 : dot(p->column[c], left) / sqrt(dot(p->column[c], p->column[c]));
        if (slope > steepest) {
            steepest = slope;
            best = c;
        }
    }
    return best;
}

/* Distance of b from the cone of the columns. */
static double distance_from_cone(struct least_squares *p)
{
    double left[ROWS];
    residual(p, left);
    for (int exchange = 0; exchange < MAX_EXCHANGES; exchange++) {
        int entering = best_column(p, left);
        if (entering < 0 || p->passive_count > ROWS || dot(left, left) < SLACK * SLACK)
            break;
        p->passive[p->passive_count++] = entering;
        do
            solve_passive(p);
        while (p->passive_count && !step_towards_trial(p) && ++exchange < MAX_EXCHANGES);
        residual(p, left);
    }
    return sqrt(dot(left, left));
}

int grain_is_held(const struct hold *holds, size_t count, struct vec load, double moment_over_radius)
{
    struct least_squares problem = {.count = 0};
    double weight = sqrt(load.x * load.x + load.y * load.y + moment_over_radius * moment_over_radius);
    if (count > HOLDS_MOST)
        return 1;
    for (size_t k = 0; k < count; k++)
        if (isnan(holds[k].mu))
            return count >= 2;
    for (size_t k = 0; k < count; k++)
        for (int side = -1; side <= 1; side += 2) {
            double mu = side * holds[k].mu;
            double length = sqrt(1 + 2 * mu * mu), *column = problem.column[problem.count++];
            struct vec t = vec_turn(holds[k].n);
            column[0] = (-holds[k].n.x + mu * t.x) / length;
            column[1] = (-holds[k].n.y + mu * t.y) / length;
            column[2] = mu / length;
            column[3] = weight > 0 ? 0 : 1; /* without a load: weights that add up to one */
        }
    if (weight > 0) {
        problem.b[0] = -load.x / weight;
        problem.b[1] = -load.y / weight;
        problem.b[2] = -moment_over_radius / weight;
    } else {
        problem.b[3] = 1;
    }
    return distance_from_cone(&problem) < SLACK;
}
