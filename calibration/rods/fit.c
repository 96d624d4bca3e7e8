/* Normal equations, A' W A a = A' W y: the unknowns are few and scaled by the caller, so that their squared condition
 * does no harm. */
#include "calibration/rods/fit.h"

#include <string.h>

#include "pipeline/numbers/dense.h"

int fit_solve(double matrix[FIT_MOST][FIT_MOST], int n, double *x, double inverse[FIT_MOST][FIT_MOST])
{
    if (dense_factorise(&matrix[0][0], (size_t)n, FIT_MOST, 1e-14))
        return -1;
    dense_substitute(&matrix[0][0], (size_t)n, FIT_MOST, x);
    for (int c = 0; inverse && c < n; c++) {
        double column[FIT_MOST] = {0};
        column[c] = 1;
        dense_substitute(&matrix[0][0], (size_t)n, FIT_MOST, column);
        for (int i = 0; i < n; i++)
            inverse[i][c] = column[i];
    }
    return 0;
}

int fit_linear(const double *rows, const double *y, const double *w, size_t count, int unknowns, double *solution,
               double covariance[FIT_MOST][FIT_MOST], double *chi2)
{
    double normal[FIT_MOST][FIT_MOST] = {{0}}, right[FIT_MOST] = {0}, sum = 0;
    for (size_t k = 0; k < count; k++)
        for (int i = 0; i < unknowns; i++) {
            const double *row = rows + k * (size_t)unknowns;
            right[i] += w[k] * row[i] * y[k];
            for (int j = 0; j < unknowns; j++)
                normal[i][j] += w[k] * row[i] * row[j];
        }
    memcpy(solution, right, (size_t)unknowns * sizeof *solution);
    if (fit_solve(normal, unknowns, solution, covariance))
        return -1;
    for (size_t k = 0; k < count; k++) {
        double rest = y[k];
        for (int i = 0; i < unknowns; i++)
            rest -= solution[i] * rows[k * (size_t)unknowns + (size_t)i];
        sum += w[k] * rest * rest;
    }
    if (chi2)
        *chi2 = sum;
    return 0;
}
