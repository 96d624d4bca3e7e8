#include "tests/check.h"

#include <math.h>
#include <stdio.h>

#include "pipeline/speak/error.h"

void check_near_at(double value, double expected, double tolerance, const char *text, const char *file, int line)
{
    if (fabs(value - expected) <= tolerance)
        return;
    print_error("%s = %.17g, expected %.17g within %g\n", text, value, expected, tolerance);
    _fail(file, line);
}

void check_at_most_at(double value, double limit, const char *text, const char *file, int line)
{
    if (value <= limit)
        return;
    print_error("%s = %.17g, expected at most %.17g\n", text, value, limit);
    _fail(file, line);
}

void check_done_at(int status, const char *text, const char *file, int line)
{
    if (status == 0)
        return;
    print_error("%s failed: %s\n", text, error_message());
    _fail(file, line);
}

/* splitmix64 (Steele, Lea and Flood 2014). */
static uint64_t next_bits(uint64_t *state)
{
    uint64_t z = (*state += 0x9E3779B97F4A7C15u);
    z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9u;
    z = (z ^ (z >> 27)) * 0x94D049BB133111EBu;
    return z ^ (z >> 31);
}

double check_uniform(uint64_t *state)
{
    return (double)(next_bits(state) >> 11) * 0x1p-53;
}

double check_normal(uint64_t *state)
{
    const double two_pi = 6.283185307179586;
    double u = 1.0 - check_uniform(state);
    return sqrt(-2.0 * log(u)) * cos(two_pi * check_uniform(state));
}
