/* Long vectors, summed in their order: the result does not depend on threads or compilers. */
#ifndef FORCES_VECTORS_H
#define FORCES_VECTORS_H

#include <stddef.h>

/* a . b */
static inline double vector_dot(size_t n, const double *a, const double *b)
{
    double sum = 0;
    for (size_t k = 0; k < n; k++)
        sum += a[k] * b[k];
    return sum;
}

/* to += factor a */
static inline void vector_add(size_t n, double factor, const double *a, double *to)
{
    for (size_t k = 0; k < n; k++)
        to[k] += factor * a[k];
}

/* a *= factor */
static inline void vector_scale(size_t n, double factor, double *a)
{
    for (size_t k = 0; k < n; k++)
        a[k] *= factor;
}

#endif
