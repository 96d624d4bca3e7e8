/* Charts as files, as calibration and contacts draw them: what their SVG says, where lines, markers and bars stand,
 * what cannot be drawn, and that PNG and PDF are there as well. */
#include "tests/check.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "pipeline/draw/axis.h"
#include "pipeline/draw/chart.h"
#include "pipeline/speak/error.h"
#include "tests/commands.h"

static const char BLUE[] = "rgb(0%,44.7", VERMILLION[] = "rgb(83.5%,36.9", GRID[] = "rgb(88%";

static char *drawn(const struct chart *charts, size_t count)
{
    check_done(chart_write("chart.svg", charts, count, 400, 300));
    return check_svg("chart.svg");
}

static struct chart_line *add(struct chart *chart, const char *name, const double *x, const double *y, size_t count)
{
    struct chart_line *line = chart_add(chart, name, count);
    assert_non_null(line);
    for (size_t k = 0; k < count; k++)
        chart_put(line, x[k], y[k]);
    return line;
}

/* Nothing from outside becomes markup. */
static void words_stay_words(void **state)
{
    (void)state;
    static const char second[] = "\n<text x=\"478.00\" y=\"18.00\"";
    const double x[] = {1, 2}, y[] = {3, 4};
    struct chart charts[2] = {{.title = "q < p", .x_label = "x & y", .y_label = "up"},
                              {.title = "second", .x_label = "x", .y_label = "y"}};
    for (int k = 0; k < 2; k++)
        add(&charts[k], "a <b> & c", x, y, 2);
    char *svg = drawn(charts, 2);
    assert_int_equal(text_count(svg, ">a &lt;b> &amp; c</text>"), 2);
    assert_int_equal(text_count(svg, ">q &lt; p</text>"), 1);
    assert_int_equal(text_count(svg, ">x &amp; y</text>"), 1);
    assert_null(strstr(svg, "<b>"));
    const char *title = strstr(svg, ">second<"), *up = strstr(svg, ">up<"), *begin; /* in the second chart; upright */
    assert_true(title && up);
    for (begin = title; *begin != '\n'; begin--)
        ;
    assert_int_equal(strncmp(begin, second, strlen(second)), 0);
    for (begin = up; *begin != '\n'; begin--)
        ;
    assert_true(strstr(begin, "rotate(-90 18.00 ") && strstr(begin, "rotate(-90 18.00 ") < up);
    free(svg);
    chart_free(&charts[0]), chart_free(&charts[1]);
}

/* On logarithmic axes 1, 10, 100 stand at equal steps and what is not positive is left out: the line is broken there.
 */
static void decades_are_even(void **state)
{
    (void)state;
    const double x[] = {1, 10, 100, 50, 1000, 10000}, y[] = {1, 1e3, 10, -1, 100, 1e4};
    const double decade[5][2] = {{0, 0}, {1, 3}, {2, 1}, {3, 2}, {4, 4}};
    struct chart chart = {.title = "log", .x_label = "x", .y_label = "y", .log_x = 1, .log_y = 1};
    struct svg_point dots[10];
    double at[5][2];
    add(&chart, "", x, y, 6)->unmarked = 1;
    struct chart_line *points = add(&chart, "", x, y, 6);
    points->scattered = points->unjoined = 1;
    char *svg = drawn(&chart, 1), *line = strstr(svg, "stroke-width:1.6;");
    assert_non_null(line);
    line = strstr(line, " d=\"");
    assert_int_equal(sscanf(line, " d=\"M %lf %lf L %lf %lf L %lf %lf M %lf %lf L %lf %lf \"", &at[0][0], &at[0][1],
                            &at[1][0], &at[1][1], &at[2][0], &at[2][1], &at[3][0], &at[3][1], &at[4][0], &at[4][1]),
                     10);
    for (int k = 1; k < 5; k++)
        for (int a = 0; a < 2; a++)
            check_near(at[k][a] - at[0][a], decade[k][a] * (at[4][a] - at[0][a]) / 4, 0.02);
    assert_true(at[4][0] > at[0][0] && at[4][1] < at[0][1]);
    assert_int_equal(svg_fills(svg, VERMILLION, dots, 10), 5 + 1); /* squares, and the key's */
    for (int k = 0; k < 5; k++) {
        check_near(dots[k].x + 3.5, at[k][0], 0.01);
        check_near(dots[k].y + 3.5, at[k][1], 0.01);
    }
    free(svg);
    chart_free(&chart);
}

/* No point, one point, two that differ by rounding alone: axes of some length with a few ticks all the same. */
static void axes_have_a_length(void **state)
{
    (void)state;
    enum { MOST = 40 };
    const double x[] = {1, 1 - 0x1p-53}, y[] = {5, 5}, zero[] = {0, 0};
    for (size_t count = 0; count <= 3; count++) {
        struct chart chart = {.title = "few", .x_label = "x", .y_label = "y"};
        struct svg_point dots[MOST];
        struct svg_stroke grid[MOST];
        size_t points = count < 3 ? count : 2;
        struct chart_line *line = add(&chart, "", count < 3 ? x : zero, count < 3 ? y : zero, points);
        line->scattered = line->unjoined = 1;
        assert_int_equal(chart_is_empty(&chart), count == 0);
        char *svg = drawn(&chart, 1);
        assert_int_equal(svg_fills(svg, BLUE, dots, MOST), points + 1);
        assert_in_range(svg_strokes(svg, GRID, grid, MOST), 4, 24);
        assert_null(strstr(svg, "nan"));
        free(svg);
        chart_free(&chart);
    }
}

/* Bars stand side by side on the axis, as high as they count: twice the height for twice the number. */
static void bars_stand_on_the_axis(void **state)
{
    (void)state;
    enum { MOST = 40 };
    const double x[] = {1, 2, 3}, y[] = {2, 4, 0};
    struct chart chart = {.title = "bars", .x_label = "x", .y_label = "y", .from_zero = 1};
    add(&chart, "bars", x, y, 3)->bars = 1;
    char *svg = drawn(&chart, 1), *bar = svg;
    double left[2], top[2], right[2], base[2];
    for (int k = 0; k < 2; k++, bar++) {
        bar = strstr(bar, "stroke:none;fill-rule:nonzero;fill:rgb(0%,44.7");
        assert_non_null(bar);
        assert_int_equal(
            sscanf(strstr(bar, " d=\""), " d=\"M %lf %lf L %lf %*f L %*f %lf", &left[k], &top[k], &right[k], &base[k]),
            4);
    }
    check_near(left[1], right[0], 0.01);
    check_near(base[0], 300 - 48, 0.01);
    check_near(base[1], base[0], 0.01);
    check_near((base[1] - top[1]) / (base[0] - top[0]), 2, 1e-3);
    free(svg);
    chart_free(&chart);
}

/* Names that are wider than the chart go on in another row, and the axes make room. */
static void keys_have_rows(void **state)
{
    (void)state;
    const double x[] = {1, 2}, y[] = {3, 4};
    double rows[2] = {0}, tops[2] = {0};
    for (int many = 0; many < 2; many++) {
        struct chart chart = {.title = "", .x_label = "x", .y_label = "y"};
        struct svg_stroke grid[40];
        for (int k = 0; k < (many ? 8 : 1); k++)
            add(&chart, "a rather long name", x, y, 2);
        char *svg = drawn(&chart, 1);
        for (const char *at = svg; (at = strstr(at, "\n<text ")); at++) {
            double left, down;
            assert_int_equal(sscanf(at, "\n<text x=\"%lf\" y=\"%lf\"", &left, &down), 2);
            const char *name = strstr(at, "long name"), *end = strchr(at, '/');
            if (name && name < end) {
                assert_true(left < 400);
                rows[many] = fmax(rows[many], down);
            }
        }
        assert_true(svg_strokes(svg, GRID, grid, 40) > 0);
        tops[many] = grid[0].y1;
        free(svg);
        chart_free(&chart);
    }
    check_near(tops[1] - tops[0], rows[1] - rows[0], 0.01);
    assert_true(rows[1] > rows[0] + 30);
}

static void round_numbers_are_1_2_5(void **state)
{
    (void)state;
    const double cases[][3] = {{1, 1, 1}, {3, 2, 5}, {7, 5, 10}, {0.03, 0.02, 0.05}, {5, 5, 5}, {1.2e7, 1e7, 2e7}};
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        check_near(axis_round_down(cases[k][0]) / cases[k][1], 1, 1e-12);
        check_near(axis_round_up(cases[k][0]) / cases[k][2], 1, 1e-12);
    }
}

/* PNG and PDF by the ending; another one is refused before anything is drawn. */
static void endings_choose_the_format(void **state)
{
    (void)state;
    struct chart charts[2] = {{.title = "a", .x_label = "x", .y_label = "y"},
                              {.title = "b", .x_label = "x", .y_label = "y"}};
    check_done(chart_write("chart.png", charts, 2, 400, 300));
    check_png("chart.png", 800, 300);
    check_done(chart_write("chart.PDF", charts, 2, 400, 300));
    char *pdf = file_text("chart.PDF");
    assert_int_equal(strncmp(pdf, "%PDF-", 5), 0);
    free(pdf);
    check_done(canvas_check_path(NULL));
    check_done(canvas_check_path("a.b/c.Svg"));
    assert_int_equal(canvas_check_path("chart.gif"), -1);
    assert_int_equal(chart_write("chart.gif", charts, 2, 400, 300), -1);
    assert_int_equal(error_status(), EXIT_INPUT);
    assert_non_null(strstr(error_message(), "chart.gif"));
}

static void what_cannot_be_written_is_a_failure(void **state)
{
    (void)state;
    struct chart chart = {.title = "nowhere", .x_label = "x", .y_label = "y"};
    assert_int_equal(chart_write("no/chart.svg", &chart, 1, 400, 300), -1);
    assert_int_equal(error_status(), EXIT_FAILED);
    assert_non_null(strstr(error_message(), "no/chart.svg"));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(words_stay_words),
        cmocka_unit_test(decades_are_even),
        cmocka_unit_test(axes_have_a_length),
        cmocka_unit_test(bars_stand_on_the_axis),
        cmocka_unit_test(keys_have_rows),
        cmocka_unit_test(round_numbers_are_1_2_5),
        cmocka_unit_test(endings_choose_the_format),
        cmocka_unit_test(what_cannot_be_written_is_a_failure),
    };
    int failed = cmocka_run_group_tests(tests, folder_enter, folder_leave);
    canvas_forget_fonts();
    return failed;
}
