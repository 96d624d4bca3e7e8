/* Weighted linear least squares with a few unknowns. */
#ifndef CALIBRATION_FIT_H
#define CALIBRATION_FIT_H

#include <stddef.h>

enum { FIT_MOST = 6 };

/* Minimise sum w_k (y_k - sum_m a_m rows[k][m])^2 over `unknowns` <= FIT_MOST unknowns; rows is count x unknowns, row
 * by row. covariance = (A^T W A)^-1: that of the unknowns when w = 1/variance. -1 without an error line: the columns
 * depend on each other. */
int fit_linear(const double *rows, const double *y, const double *w, size_t count, int unknowns, double *solution,
               double covariance[FIT_MOST][FIT_MOST], double *chi2);
/* Solve the symmetric positive system in place (Cholesky): x, and the inverse when it is not NULL. */
int fit_solve(double matrix[FIT_MOST][FIT_MOST], int unknowns, double *x, double inverse[FIT_MOST][FIT_MOST]);

#endif
