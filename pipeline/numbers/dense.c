/* Cholesky's factorisation and Gauss-Jordan elimination (Golub & Van Loan, Matrix Computations, 4.2 and 3.2): neither
 * exchanges rows, since the matrices are those of least squares, whose pivots are positive in any order. */
#include "pipeline/numbers/dense.h"

#include <math.h>

int dense_factorise(double *m, size_t n, size_t apart, double least)
{
    for (size_t i = 0; i < n; i++)
        for (size_t j = 0; j <= i; j++) {
            double sum = m[i * apart + j], whole = m[i * apart + i];
            for (size_t k = 0; k < j; k++)
                sum -= m[i * apart + k] * m[j * apart + k];
            if (i == j && !(sum > least * fabs(whole)))
                return -1;
            m[i * apart + j] = i == j ? sqrt(sum) : sum / m[j * apart + j];
        }
    return 0;
}

void dense_substitute(const double *m, size_t n, size_t apart, double *x)
{
    for (size_t i = 0; i < n; i++) {
        for (size_t k = 0; k < i; k++)
            x[i] -= m[i * apart + k] * x[k];
        x[i] /= m[i * apart + i];
    }
    for (size_t i = n; i-- > 0;) {
        for (size_t k = i + 1; k < n; k++)
            x[i] -= m[k * apart + i] * x[k];
        x[i] /= m[i * apart + i];
    }
}

/* Step k replaces column k, which would become a unit vector, by column k of the inverse. */
int dense_invert(double *m, size_t n, size_t apart, double least)
{
    double whole[DENSE_MOST];
    for (size_t k = 0; k < n; k++)
        whole[k] = m[k * apart + k];
    for (size_t k = 0; k < n; k++) {
        double *from = m + k * apart, pivot = from[k];
        if (!(pivot > least * whole[k]))
            return -1;
        from[k] = 1;
        for (size_t j = 0; j < n; j++)
            from[j] /= pivot;
        for (size_t i = 0; i < n; i++) {
            double *row = m + i * apart, factor = row[k];
            if (i == k)
                continue;
            row[k] = 0;
            for (size_t j = 0; j < n; j++)
                row[j] -= factor * from[j];
        }
    }
    return 0;
}

int dense_solve(double *m, size_t n, size_t apart, double least)
{
    for (size_t i = 0; i < n; i++) {
        if (!(m[i * apart + i] > least))
            return -1;
        for (size_t k = 0; k < n; k++) {
            double factor = m[k * apart + i] / m[i * apart + i];
            for (size_t j = i; j <= n && k != i; j++)
                m[k * apart + j] -= factor * m[i * apart + j];
        }
    }
    for (size_t i = 0; i < n; i++)
        m[i * apart + n] /= m[i * apart + i];
    return 0;
}
