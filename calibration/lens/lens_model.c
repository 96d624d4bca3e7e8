/* Residuals and normal equations. Unknowns are scaled by R, half the diagonal, so that each moves the corner of the
 * photo by its own size times R: the matrix is then well scaled, and one prior in these units is a statement about any
 * photo.
 *
 * Some combinations cannot be told from photos of a plate (a shift of the centre from P1 and P2): the priors hold them
 * near zero, where the map that results is the same. */
#include "calibration/lens/lens_model.h"

#include <string.h>

/* Unknowns without units: centre offset / R, K1 R^2, K2 R^4, K3 R^6, P1 R, P2 R, P3 R^2 with R half the photo's
 * diagonal; and how large any of them can be. These weak priors (standard deviations) keep directions that no plate
 * shows (centre against P1 P2; P3 where P1 = P2 = 0) from running away. */
static const double prior[LENS_UNKNOWNS] = {0.1, 0.1, 0.1, 0.1, 0.1, 0.02, 0.02, 0.3};

struct lens lens_of(const struct problem *problem, const double *q)
{
    const double r = problem->half, r2 = r * r;
    return (struct lens){.centre = vec(problem->middle.x + r * q[0], problem->middle.y + r * q[1]),
                         .k = {q[2] / r2, q[3] / (r2 * r2), q[4] / (r2 * r2 * r2)},
                         .p = {q[5] / r, q[6] / r, q[7] / r2}};
}

/* Derivatives of the corrected position with respect to the eight unknowns, by central differences: all but P3 and
 * the centre enter linearly. */
void slopes_of(const struct problem *problem, const double *q, struct vec seen, struct vec slopes[LENS_UNKNOWNS])
{
    const double step = 1e-4;
    double shifted[LENS_UNKNOWNS];
    memcpy(shifted, q, sizeof shifted);
    for (int a = 0; a < LENS_UNKNOWNS; a++) {
        shifted[a] = q[a] + step;
        struct lens more = lens_of(problem, shifted);
        shifted[a] = q[a] - step;
        struct lens less = lens_of(problem, shifted);
        shifted[a] = q[a];
        slopes[a] = vec_scale(0.5 / step, vec_sub(lens_corrected(&more, seen), lens_corrected(&less, seen)));
    }
}

struct row row_of(const struct problem *problem, const double *q, size_t m, int slopes)
{
    const struct lens_points *points = problem->points;
    const double *motion = q + LENS_UNKNOWNS + MOTION * (m / points->count);
    const struct vec reference = points->reference[m % points->count], seen = points->seen[m];
    struct lens lens = lens_of(problem, q);
    struct vec arm = vec_sub(lens_corrected(&lens, reference), problem->middle);
    const double c = cos(motion[2]), s = sin(motion[2]);
    struct vec turned = vec(c * arm.x + s * arm.y, -s * arm.x + c * arm.y);
    struct vec there = vec_add(vec_add(problem->middle, vec(motion[0], motion[1])), turned);
    struct row row = {.residual = vec_sub(lens_corrected(&lens, seen), there)};
    if (!slopes)
        return row;
    struct vec at_seen[LENS_UNKNOWNS], at_reference[LENS_UNKNOWNS];
    slopes_of(problem, q, seen, at_seen);
    slopes_of(problem, q, reference, at_reference);
    for (int a = 0; a < LENS_UNKNOWNS; a++) {
        struct vec d = at_reference[a];
        row.lens[a] = vec_sub(at_seen[a], vec(c * d.x + s * d.y, -s * d.x + c * d.y));
    }
    row.motion[0] = vec(-1, 0);
    row.motion[1] = vec(0, -1);
    row.motion[2] = vec(-turned.y, turned.x);
    return row;
}

/* Normal equations: matrix (unknowns^2, row-major) and right-hand side; returns the weighted sum of squares. */
double normal_equations(const struct problem *problem, const double *q, double *matrix, double *right)
{
    const struct lens_points *points = problem->points;
    const size_t n = problem->unknowns;
    double square = 0;
    if (matrix) {
        memset(matrix, 0, n * n * sizeof *matrix);
        memset(right, 0, n * sizeof *right);
    }
    for (size_t m = 0; m < points->photos * points->count; m++) {
        if (!problem->inside[m])
            continue;
        size_t photo = m / points->count, first = LENS_UNKNOWNS + MOTION * photo;
        double weight = 1 / (points->sigma[m] * points->sigma[m]);
        struct row row = row_of(problem, q, m, matrix != NULL);
        square += weight * vec_dot(row.residual, row.residual);
        for (int a = 0; matrix && a < LENS_UNKNOWNS + MOTION; a++) {
            size_t ia = a < LENS_UNKNOWNS ? (size_t)a : first + (size_t)(a - LENS_UNKNOWNS);
            struct vec da = a < LENS_UNKNOWNS ? row.lens[a] : row.motion[a - LENS_UNKNOWNS];
            right[ia] -= weight * vec_dot(da, row.residual);
            for (int b = 0; b < LENS_UNKNOWNS + MOTION; b++) {
                size_t ib = b < LENS_UNKNOWNS ? (size_t)b : first + (size_t)(b - LENS_UNKNOWNS);
                struct vec db = b < LENS_UNKNOWNS ? row.lens[b] : row.motion[b - LENS_UNKNOWNS];
                matrix[ia * n + ib] += weight * vec_dot(da, db);
            }
        }
    }
    for (int a = 0; a < LENS_UNKNOWNS; a++) {
        double weight = 1 / (prior[a] * prior[a]);
        square += weight * q[a] * q[a];
        if (matrix) {
            matrix[(size_t)a * n + (size_t)a] += weight;
            right[a] -= weight * q[a];
        }
    }
    return square;
}
