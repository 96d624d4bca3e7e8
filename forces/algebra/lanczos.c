/* Lanczos steps on (K + shift)^-1 build an orthonormal basis Q, in which that inverse is the small matrix T = Q' (K +
 * shift)^-1 Q; the eigenvector of T's largest eigenvalue gives the best motion within the basis, from which the next
 * cycle starts. The basis is kept orthogonal in full, twice, as Lanczos vectors lose it in rounding.
 * T is diagonalised by Jacobi's rotations: 40 columns are few, and nothing can go wrong. The first motion is made of
 * random numbers with a fixed key, so that every run gives the same bytes. */
#include "forces/algebra/lanczos.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "forces/algebra/vectors.h"
#include "pipeline/speak/error.h"
#include "pipeline/numbers/random.h"

enum {
    STEPS = 40,  /* vectors of a basis */
    CYCLES = 30, /* bases */
    SWEEPS = 30  /* of rotations: Jacobi's method needs some 8 */
};

/* One rotation of Jacobi's method, which makes t[p][q] zero; v gathers the rotations. tan(angle) is the smaller root,
 * so that the rotation is at most 45 degrees. */
static void rotate(int m, double t[STEPS][STEPS], double v[STEPS][STEPS], int p, int q)
{
    double theta = (t[q][q] - t[p][p]) / (2 * t[p][q]);
    double tangent = (theta < 0 ? -1 : 1) / (fabs(theta) + sqrt(theta * theta + 1));
    double c = 1 / sqrt(tangent * tangent + 1), s = tangent * c;
    for (int k = 0; k < m; k++) {
        double a = t[k][p], b = t[k][q];
        t[k][p] = c * a - s * b, t[k][q] = s * a + c * b;
        a = v[k][p], b = v[k][q];
        v[k][p] = c * a - s * b, v[k][q] = s * a + c * b;
    }
    for (int k = 0; k < m; k++) {
        double a = t[p][k], b = t[q][k];
        t[p][k] = c * a - s * b, t[q][k] = s * a + c * b;
    }
}

/* Eigenvector of the largest eigenvalue of the small matrix t, which is destroyed. */
static void largest_of(int m, double t[STEPS][STEPS], double y[STEPS])
{
    double v[STEPS][STEPS] = {{0}}, size = 0;
    int best = 0;
    for (int k = 0; k < m; k++)
        v[k][k] = 1, size = fmax(size, fabs(t[k][k]));
    for (int sweep = 0, moved = 1; moved && sweep < SWEEPS; sweep++) {
        moved = 0;
        for (int p = 0; p < m; p++)
            for (int q = p + 1; q < m; q++)
                if (fabs(t[p][q]) > 1e-16 * size)
                    rotate(m, t, v, p, q), moved = 1;
    }
    for (int k = 1; k < m; k++)
        if (t[k][k] > t[best][best])
            best = k;
    for (int k = 0; k < m; k++)
        y[k] = v[k][best];
}

/* Steps from basis[0] on; the basis is kept orthogonal in full. Returns how many there were, or -1. */
static int steps(const struct lanczos *problem, double *basis, double *next, double t[STEPS][STEPS])
{
    size_t n = problem->n;
    int most = n < STEPS ? (int)n : STEPS;
    memset(t, 0, sizeof(double[STEPS][STEPS]));
    for (int j = 0; j < most; j++) {
        double *q = basis + (size_t)j * n;
        if (problem->solve(problem->user, q, next))
            return -1;
        t[j][j] = vector_dot(n, q, next);
        for (int again = 0; again < 2; again++)
            for (int k = 0; k <= j; k++)
                vector_add(n, -vector_dot(n, basis + (size_t)k * n, next), basis + (size_t)k * n, next);
        double beta = sqrt(vector_dot(n, next, next));
        if (j + 1 == most || beta < 1e-13 * fabs(t[0][0]))
            return j + 1;
        t[j][j + 1] = t[j + 1][j] = beta;
        memcpy(q + n, next, n * sizeof *q);
        vector_scale(n, 1 / beta, q + n);
    }
    return most;
}

/* The best motion within the basis goes to basis[0]. */
static void combine(size_t n, int m, const double y[STEPS], double *basis)
{
    vector_scale(n, y[0], basis);
    for (int k = 1; k < m; k++)
        vector_add(n, y[k], basis + (size_t)k * n, basis);
    vector_scale(n, 1 / sqrt(vector_dot(n, basis, basis)), basis);
}

int lanczos_smallest(const struct lanczos *problem, double *value, double *x, double *defect)
{
    size_t n = problem->n;
    double *basis = malloc((STEPS * n + 1) * sizeof *basis), *work = malloc((n + 1) * sizeof *work);
    double t[STEPS][STEPS], y[STEPS];
    int status = basis && work ? 0 : error_memory("eigenvalue");
    *value = *defect = NAN;
    if (!status)
        for (size_t k = 0; k < n; k++)
            basis[k] = random_normal(1, k);
    if (!status && n > 0)
        vector_scale(n, 1 / sqrt(vector_dot(n, basis, basis)), basis);
    for (int cycle = 0; !status && n > 0 && cycle < CYCLES && !(*defect <= problem->tolerance); cycle++) {
        int m = steps(problem, basis, work, t);
        if (m < 0) {
            status = -1;
            break;
        }
        largest_of(m, t, y);
        combine(n, m, y, basis);
        status = problem->multiply(problem->user, basis, work);
        *value = vector_dot(n, basis, work);
        vector_add(n, -*value, basis, work);
        *defect = sqrt(vector_dot(n, work, work));
    }
    if (!status)
        memcpy(x, basis, n * sizeof *x);
    free(basis), free(work);
    return status;
}
