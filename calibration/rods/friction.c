/* Two ways to mu. The three-rod test: at the moment when rod C begins to turn both its contacts slide; equilibrium of
 * forces and of moments then gives sin 2 phi as in the header. And the statistics of |ft| / fn in a sheared packing:
 * Coulomb's law ends that distribution at mu, where contacts pile up that are about to slide, blurred by the errors of
 * the forces. The end is found as the place where most ratios lie just below and fewest just above, judged in standard
 * deviations of counts (Poisson), over several widths. */
#include "calibration/rods/friction.h"

#include <math.h>
#include <stdlib.h>

#include "pipeline/speak/error.h"
#include "pipeline/numbers/quantiles.h"

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

/* ---- mobilised friction ---- */

/* Sorted |ft| / fn of the contacts that carry. */
static size_t ratios(const double *fn, const double *ft, size_t count, double *ratio)
{
    double mean = 0;
    size_t carrying = 0, n = 0;
    for (size_t k = 0; k < count; k++)
        if (isfinite(fn[k]) && fn[k] > 0) {
            mean += fn[k];
            carrying++;
        }
    mean /= (double)(carrying ? carrying : 1);
    for (size_t k = 0; k < count; k++)
        if (isfinite(fn[k]) && isfinite(ft[k]) && fn[k] > 0 && fn[k] >= MOBILISED_LEAST_FORCE * mean)
            ratio[n++] = fabs(ft[k]) / fn[k];
    sort_values(ratio, n);
    return n;
}

/* How many lie in [low, high). */
static size_t between(const double *sorted, size_t n, double low, double high)
{
    size_t ends[2];
    for (int e = 0; e < 2; e++) {
        size_t a = 0, b = n;
        double edge = e ? high : low;
        while (a < b) {
            size_t middle = (a + b) / 2;
            if (sorted[middle] < edge)
                a = middle + 1;
            else
                b = middle;
        }
        ends[e] = a;
    }
    return ends[1] - ends[0];
}

/* How sharply the distribution ends at m: what lies within w below against what lies within w above, in standard
 * deviations; nothing where more than a seventh goes on above. */
static double edge(const double *sorted, size_t n, double m, double w, size_t *below)
{
    double past = nextafter(m, INFINITY), above = (double)between(sorted, n, past, past + w);
    *below = between(sorted, n, past - w, past);
    double under = (double)*below;
    return above <= under / 7 ? (under - above) / sqrt(under + above + 1) : -INFINITY;
}

int friction_mobilised(const double *fn, const double *ft, size_t count, struct mobilised *mobilised)
{
    static const double WIDTHS[] = {0.01, 0.02, 0.03, 0.05}, SHARES[] = {0.1, 0.5, 0.9, 0.95, 0.99};
    enum { WIDTH_COUNT = 4 };
    double *ratio = malloc((count + 1) * sizeof *ratio);
    *mobilised = (struct mobilised){.mu = NAN, .significance = -INFINITY};
    if (!ratio)
        return error_memory("mobilised friction");
    size_t n = ratios(fn, ft, count, ratio), below;
    for (int w = 0; w < WIDTH_COUNT; w++)
        for (size_t k = 0; k < n; k++) {
            double here = edge(ratio, n, ratio[k], WIDTHS[w], &below);
            if (here <= mobilised->significance)
                continue;
            *mobilised = (struct mobilised){.mu = ratio[k], .width = WIDTHS[w], .sliding = below, .significance = here};
            mobilised->s_mu = WIDTHS[w] / (double)below;
        }
    mobilised->contacts = n;
    for (int q = 0; q < 5; q++)
        mobilised->quantile[q] = n ? ratio[(size_t)(SHARES[q] * (double)(n - 1))] : NAN;
    free(ratio);
    if (!(mobilised->significance >= MOBILISED_SIGNIFICANT))
        return error_input("%zu contacts, and |ft| / fn ends nowhere sharply: too few of them are near sliding: take "
                           "states that are sheared more, or more of them",
                           n);
    return 0;
}
