/* Assertions that cmocka lacks: doubles with a stated tolerance. Include this instead of cmocka.h. */
#ifndef TESTS_CHECK_H
#define TESTS_CHECK_H

#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>

/* |value - expected| <= tolerance, NaN fails; prints both numbers when it does not hold. */
#define check_near(value, expected, tolerance)                                                                         \
    check_near_at((value), (expected), (tolerance), #value, __FILE__, __LINE__)
/* value <= limit, NaN fails. */
#define check_at_most(value, limit) check_at_most_at((value), (limit), #value, __FILE__, __LINE__)
/* The call returned 0; prints the library's error line when it did not. */
#define check_done(call) check_done_at((call), #call, __FILE__, __LINE__)

void check_near_at(double value, double expected, double tolerance, const char *text, const char *file, int line);
void check_at_most_at(double value, double limit, const char *text, const char *file, int line);
void check_done_at(int status, const char *text, const char *file, int line);

/* Deterministic random numbers for tests, independent of the code under test. */
double check_uniform(uint64_t *state); /* in [0, 1) */
double check_normal(uint64_t *state);  /* mean 0, variance 1 */

#endif
