/* The charts of calibration: what their SVG says, where lines and dots stand, and what cannot be drawn. */
#include "tests/check.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "calibration/commands/law_chart.h"
#include "pipeline/speak/error.h"
#include "tests/commands.h"

static char *drawn(const struct chart_panel *panels, size_t count)
{
    check_done(chart_write("chart.svg", panels, count));
    return check_svg("chart.svg");
}

/* Nothing from outside becomes markup. */
static void words_stay_words(void **state)
{
    (void)state;
    const double x[] = {1, 2}, y[] = {3, 4};
    struct chart_curve curve = {"a <b> & c", x, y, 2, CHART_LINE};
    struct chart_panel panels[2] = {{"q < p", "x & y", "y", 0, 0, &curve, 1}, {"second", "x", "y", 0, 0, &curve, 1}};
    char *svg = drawn(panels, 2);
    assert_int_equal(text_count(svg, ">a &lt;b> &amp; c</text>"), 2);
    assert_int_equal(text_count(svg, ">q &lt; p</text>"), 1);
    assert_int_equal(text_count(svg, ">x &amp; y</text>"), 1);
    assert_null(strstr(svg, "<b>"));
    free(svg);
}

/* On logarithmic axes 1, 10, 100 stand at equal steps and what is not positive is left out: the line is broken there.
 */
static void decades_are_even(void **state)
{
    (void)state;
    const double x[] = {1, 10, 100, 50, 1000, 10000}, y[] = {1, 10, 100, -1, 1e3, 1e4};
    struct chart_curve curves[] = {{NULL, x, y, 6, CHART_LINE}, {NULL, x, y, 6, CHART_DOTS}};
    struct chart_panel panel = {"log", "x", "y", 1, 1, curves, 2};
    char *svg = drawn(&panel, 1), *line = strstr(svg, "<path fill=\"none\"");
    double at[5][2], cx, cy;
    assert_non_null(line);
    line = strstr(line, " d=\"");
    assert_int_equal(sscanf(line, " d=\"M%lf %lfL%lf %lfL%lf %lfM%lf %lfL%lf %lf\"", &at[0][0], &at[0][1], &at[1][0],
                            &at[1][1], &at[2][0], &at[2][1], &at[3][0], &at[3][1], &at[4][0], &at[4][1]),
                     10);
    for (int k = 1; k < 5; k++)
        for (int a = 0; a < 2; a++)
            check_near(at[k][a] - at[k - 1][a], (at[4][a] - at[0][a]) / 4, 0.02);
    assert_true(at[4][0] > at[0][0] && at[4][1] < at[0][1]);
    assert_int_equal(text_count(svg, "<circle "), 5);
    for (const char *dot = svg, *end = svg + strlen(svg); (dot = strstr(dot, "<circle ")) && dot < end; dot++) {
        assert_int_equal(sscanf(dot, "<circle cx=\"%lf\" cy=\"%lf\"", &cx, &cy), 2);
        int known = 0;
        for (int k = 0; k < 5; k++)
            known += fabs(cx - at[k][0]) < 0.01 && fabs(cy - at[k][1]) < 0.01;
        assert_int_equal(known, 1);
    }
    free(svg);
}

/* No point, one point, two that differ by rounding alone: axes of some length with a few ticks all the same. */
static void axes_have_a_length(void **state)
{
    (void)state;
    const double x[] = {1, 1 - 0x1p-53}, y[] = {5, 5}, zero[] = {0, 0};
    for (size_t count = 0; count <= 3; count++) {
        struct chart_curve curve = {NULL, count < 3 ? x : zero, count < 3 ? y : zero, count < 3 ? count : 2,
                                    CHART_DOTS};
        struct chart_panel panel = {"few", "x", "y", 0, 0, &curve, 1};
        char *svg = drawn(&panel, 1);
        assert_int_equal(text_count(svg, "<circle "), curve.count);
        assert_in_range(text_count(svg, "stroke=\"#ddd\""), 4, 24);
        assert_null(strstr(svg, "nan"));
        free(svg);
    }
}

static void what_cannot_be_written_is_a_failure(void **state)
{
    (void)state;
    struct chart_panel panel = {"nowhere", "x", "y", 0, 0, NULL, 0};
    assert_int_equal(chart_write("no/chart.svg", &panel, 1), -1);
    assert_int_equal(error_status(), EXIT_FAILED);
    assert_non_null(strstr(error_message(), "no/chart.svg"));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(words_stay_words),
        cmocka_unit_test(decades_are_even),
        cmocka_unit_test(axes_have_a_length),
        cmocka_unit_test(what_cannot_be_written_is_a_failure),
    };
    return cmocka_run_group_tests(tests, folder_enter, folder_leave);
}
