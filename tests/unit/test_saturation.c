/* A grain is saturated when its face stands at the end of the grey range, which is 2^bits - 1. */
#include "tests/check.h"

#include <stdlib.h>

#include "findgrains/rims/rim_looks.h"

static int saturated(int bits, uint16_t level)
{
    struct photo photo = {.width = 100, .height = 100, .bits = bits, .pixels = calloc(100 * 100, sizeof(uint16_t))};
    const struct rim rim = {.x = 50, .y = 50, .radius = 30};
    assert_non_null(photo.pixels);
    for (int k = 0; k < 100 * 100; k++)
        photo.pixels[k] = level;
    int found = rim_is_saturated(&photo, &rim, 1);
    free(photo.pixels);
    return found;
}

static void the_end_of_the_range_is_saturated(void **state)
{
    (void)state;
    static const struct {
        int bits;
        uint16_t end;
    } cases[] = {{8, 255}, {10, 1023}, {12, 4095}, {14, 16383}, {16, 65535}};
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        assert_int_equal(saturated(cases[k].bits, cases[k].end), 1);
        assert_int_equal(saturated(cases[k].bits, (uint16_t)(cases[k].end - 1)), 0);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(the_end_of_the_range_is_saturated)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
