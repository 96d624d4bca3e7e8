#include "calibration/friction.h"

#include <math.h>

#include "pipeline/error.h"

static const double degree = 0.017453292519943295;

static int is_positive(double value)
{
    return isfinite(value) && value > 0;
}

int friction_angle(const struct friction_test *test, double *phi)
{
    if (!is_positive(test->p1 + test->p2) || !(test->p1 >= 0) || !(test->p2 >= 0) || !is_positive(test->arm) ||
        !is_positive(test->radius))
        return error_input("weights, arm and radius must be positive numbers: check the row");
    if (!(test->alpha > 0) || !(test->alpha < 90 * degree))
        return error_input("alpha is %g deg: it lies between 0 and 90", test->alpha / degree);
    double sine = 2 * fabs(test->p2 - test->p1) / (test->p2 + test->p1) * test->arm / test->radius * cos(test->alpha);
    if (sine > 1)
        return error_input("sin 2 phi would be %g: check weights, arm and radius", sine);
    *phi = 0.5 * asin(sine);
    if (test->alpha <= *phi)
        return error_input("alpha = %g deg <= phi = %g deg: a contact opened before the rod slid: take a larger alpha",
                           test->alpha / degree, *phi / degree);
    return 0;
}

int friction_estimate(const struct friction_test *tests, size_t count, struct friction *friction)
{
    double sum = 0, squares = 0;
    if (count == 0)
        return error_input("no test: give at least one row");
    for (size_t k = 0; k < count; k++) {
        double phi;
        if (friction_angle(&tests[k], &phi))
            return error_context("test %zu", k + 1);
        sum += phi;
        squares += phi * phi;
    }
    double n = (double)count, mean = sum / n, variance = fmax(0, squares / n - mean * mean);
    friction->tests = count;
    friction->phi = mean;
    friction->s_phi = count > 1 ? sqrt(variance / (n - 1)) : NAN;
    friction->mu = tan(mean);
    friction->s_mu = (1 + friction->mu * friction->mu) * friction->s_phi;
    return 0;
}
