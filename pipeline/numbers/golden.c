#include "pipeline/numbers/golden.h"

/* (sqrt 5 - 1) / 2: the only share with which one of the two inner points is an inner point of the next interval. */
#define GOLDEN 0.6180339887498949

double golden_section(double (*f)(double x, void *user), void *user, double low, double high, double tolerance)
{
    double a = high - GOLDEN * (high - low), b = low + GOLDEN * (high - low), fa = f(a, user), fb = f(b, user);
    while (high - low > tolerance) {
        if (fa <= fb) {
            high = b;
            b = a, fb = fa;
            fa = f(a = high - GOLDEN * (high - low), user);
        } else {
            low = a;
            a = b, fa = fb;
            fb = f(b = low + GOLDEN * (high - low), user);
        }
    }
    return 0.5 * (low + high);
}
