#include "calibration/rods/fit.h"

#include <math.h>
#include <string.h>

/* matrix = L L^T, the lower triangle in place. */
static int decompose(double m[FIT_MOST][FIT_MOST], int n)
{
    for (int i = 0; i < n; i++)
        for (int j = 0; j <= i; j++) {
            double sum = m[i][j], whole = m[i][i];
            for (int k = 0; k < j; k++)
                sum -= m[i][k] * m[j][k];
            if (i != j)
                m[i][j] = sum / m[j][j];
            else if (!(sum > 1e-14 * fabs(whole)))
                return -1;
            else
                m[i][i] = sqrt(sum);
        }
    return 0;
}

static void substitute(double m[FIT_MOST][FIT_MOST], int n, double *x)
{
    for (int i = 0; i < n; i++) {
        for (int k = 0; k < i; k++)
            x[i] -= m[i][k] * x[k];
        x[i] /= m[i][i];
    }
    for (int i = n - 1; i >= 0; i--) {
        for (int k = i + 1; k < n; k++)
            x[i] -= m[k][i] * x[k];
        x[i] /= m[i][i];
    }
}

int fit_solve(double matrix[FIT_MOST][FIT_MOST], int n, double *x, double inverse[FIT_MOST][FIT_MOST])
{
    if (decompose(matrix, n))
        return -1;
    substitute(matrix, n, x);
    for (int c = 0; inverse && c < n; c++) {
        double column[FIT_MOST] = {0};
        column[c] = 1;
        substitute(matrix, n, column);
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

double fit_golden(double (*f)(double x, void *user), void *user, double low, double high, double tolerance)
{
    const double golden = 0.6180339887498949;
    double a = high - golden * (high - low), b = low + golden * (high - low), fa = f(a, user), fb = f(b, user);
    while (high - low > tolerance) {
        if (fa <= fb) {
            high = b;
            b = a, fb = fa;
            fa = f(a = high - golden * (high - low), user);
        } else {
            low = a;
            a = b, fa = fb;
            fb = f(b = low + golden * (high - low), user);
        }
    }
    return 0.5 * (low + high);
}
