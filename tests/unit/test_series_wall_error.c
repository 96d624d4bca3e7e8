/* The error of a wall in one photo is that of the grain in the middle: one lost grain does not move it. */
#include "tests/check.h"

#include <math.h>

#include "forces/series/series_state.h"

static double median_of_errors(double *s, size_t count)
{
    const struct grains grains = {.count = count, .s_x = s};
    double median;
    check_done(series_median_error(&grains, &median));
    return median;
}

static void one_bad_grain_moves_nothing(void **state)
{
    (void)state;
    double odd[] = {3, 1, 1000, NAN, 2, 0, 4}, even[] = {8, 1, 3, 5}, none[] = {NAN, 0};
    check_near(median_of_errors(odd, 7), 3, 0);
    check_near(median_of_errors(even, 4), 4, 0);
    check_near(median_of_errors(none, 2), 0, 0);
    check_near(median_of_errors(NULL, 2), 0, 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(one_bad_grain_moves_nothing)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
