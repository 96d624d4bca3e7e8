#include "pipeline/draw/chart.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "pipeline/speak/error.h"
#include "pipeline/draw/canvas.h"

static const double COLOURS[][3] = {{COLOUR_BLUE},   {COLOUR_VERMILLION}, {COLOUR_GREEN},
                                    {COLOUR_ORANGE}, {COLOUR_PURPLE},     {COLOUR_SKY}};
enum { COLOUR_COUNT = 6, MARKERS = 4 };

/* Of an axis, over its largest value: what differs by less is alike but for rounding, and so small steps would not move
 * a number of that size. */
static const double LEAST_SPAN = 1e-9;

struct axis {
    double from, to, step; /* in decades when logarithmic */
    double begin, length;  /* px */
    int fine, first;       /* logarithmic with ticks at 1, 2, 5: the number of the first one, fine_tick() */
};

struct chart_line *chart_add(struct chart *chart, const char *name, size_t capacity)
{
    if (chart->count == CHART_LINES) {
        (void)error_failed("a chart of more than %d lines: report this as a defect", CHART_LINES);
        return NULL;
    }
    struct chart_line *line = &chart->lines[chart->count];
    line->style = chart->count++;
    snprintf(line->name, sizeof line->name, "%s", name);
    line->x = malloc((capacity + 1) * sizeof *line->x);
    line->y = malloc((capacity + 1) * sizeof *line->y);
    line->count = 0;
    line->dashed = line->without_key = line->scattered = line->open = line->unjoined = 0;
    if (line->x && line->y)
        return line;
    (void)error_memory("a chart");
    return NULL;
}

void chart_put(struct chart_line *line, double x, double y)
{
    line->x[line->count] = x;
    line->y[line->count++] = y;
}

void chart_free(struct chart *chart)
{
    for (size_t k = 0; k < chart->count; k++) {
        free(chart->lines[k].x);
        free(chart->lines[k].y);
    }
    memset(chart, 0, sizeof *chart);
}

/* The height of a point on the axis; NaN when it cannot be drawn. */
static double height_of(const struct chart *chart, const struct chart_line *line, size_t k)
{
    double y = line->y[k];
    if (!isfinite(line->x[k]) || !isfinite(y) || (chart->log_y && y <= 0))
        return NAN;
    return chart->log_y ? log10(y) : y;
}

int chart_is_empty(const struct chart *chart)
{
    for (size_t l = 0; l < chart->count; l++)
        for (size_t k = 0; k < chart->lines[l].count; k++)
            if (!isnan(height_of(chart, &chart->lines[l], k)))
                return 0;
    return 1;
}

/* ---- axes ---- */

/* The smallest of 1, 2, 5 times a power of ten that is not below the value. */
static double round_up(double value)
{
    double below = canvas_round_number(value), first = below / pow(10, floor(log10(below) + 1e-9));
    return below >= value * (1 - 1e-9) ? below : first > 1.5 && first < 3 ? 2.5 * below : 2 * below;
}

static struct axis make_axis(double from, double to, double begin, double length, double whole)
{
    if (!(to - from > LEAST_SPAN * fmax(fabs(from), fabs(to)))) {
        double room = fmax(fabs(from) * 0.1, 1e-12);
        from -= room;
        to += room;
    }
    struct axis axis = {.begin = begin, .length = length};
    axis.step = fmax(round_up((to - from) / 6), whole);
    axis.from = axis.step * floor(from / axis.step + 1e-9);
    axis.to = axis.step * ceil(to / axis.step - 1e-9);
    return axis;
}

/* The logarithms of ..., 1, 2, 5, 10, 20, ...: 0 is that of 1. */
static double fine_tick(int number)
{
    static const double digits[] = {1, 2, 5};
    int decade = (int)floor(number / 3.0);
    return decade + log10(digits[number - 3 * decade]);
}

/* Decades; below two of them 1, 2, 5 and so on, so that there is always more than one tick. */
static struct axis make_log_axis(double from, double to, double begin, double length)
{
    if (to - from >= 2)
        return make_axis(from, to, begin, length, 1);
    struct axis axis = {.begin = begin, .length = length, .fine = 1};
    axis.first = 3 * (int)floor(from);
    while (fine_tick(axis.first + 1) <= from + 1e-9)
        axis.first++;
    int last = axis.first + 1;
    while (fine_tick(last) < to - 1e-9)
        last++;
    axis.from = fine_tick(axis.first);
    axis.to = fine_tick(last);
    return axis;
}

/* Is there a tick of that number, from 0 on? Then *value is its place. */
static int tick(const struct axis *axis, int number, double *value)
{
    double v = axis->fine ? fine_tick(axis->first + number) : axis->from + number * axis->step;
    *value = !axis->fine && fabs(v) < 1e-9 * axis->step ? 0 : v;
    return v <= axis->to + (axis->fine ? 1e-9 : 0.01 * axis->step);
}

static void measure(const struct chart *chart, double width, double height, struct axis *x, struct axis *y)
{
    double x0 = INFINITY, x1 = -INFINITY, y0 = chart->from_zero ? 0 : INFINITY, y1 = chart->from_zero ? 0 : -INFINITY;
    for (size_t l = 0; l < chart->count; l++)
        for (size_t k = 0; k < chart->lines[l].count; k++) {
            double up = height_of(chart, &chart->lines[l], k);
            if (isnan(up))
                continue;
            x0 = fmin(x0, chart->lines[l].x[k]);
            x1 = fmax(x1, chart->lines[l].x[k]);
            y0 = fmin(y0, up);
            y1 = fmax(y1, up);
        }
    *x = make_axis(x0, x1, 78, width - 98, chart->whole_x ? 1 : 0);
    if (chart->x_step > 0)
        x->from = chart->x_from, x->to = chart->x_to, x->step = chart->x_step;
    *y = chart->log_y ? make_log_axis(y0, y1, height - 48, -(height - 90))
                      : make_axis(y0, y1, height - 48, -(height - 90), 0);
}

static double on(const struct axis *axis, double value)
{
    return axis->begin + axis->length * (value - axis->from) / (axis->to - axis->from);
}

static void number_text(double value, int log, char text[32])
{
    if (log)
        snprintf(text, 32, "%g", pow(10, value));
    else
        snprintf(text, 32, "%.6g", fabs(value) < 1e-12 ? 0 : value);
}

static void draw_ticks(const struct chart *chart, cairo_t *cairo, const struct axis *x, const struct axis *y)
{
    char text[32];
    cairo_set_line_width(cairo, 1);
    double v;
    for (int k = 0; tick(x, k, &v); k++) {
        number_text(v, 0, text);
        cairo_set_source_rgb(cairo, 0.88, 0.88, 0.88);
        cairo_move_to(cairo, on(x, v), y->begin);
        cairo_line_to(cairo, on(x, v), y->begin + y->length);
        cairo_stroke(cairo);
        cairo_set_source_rgb(cairo, COLOUR_INK);
        canvas_text(cairo, on(x, v), y->begin + 17, 0.5, 12, 0, text);
    }
    for (int k = 0; tick(y, k, &v); k++) {
        number_text(v, chart->log_y, text);
        cairo_set_source_rgb(cairo, 0.88, 0.88, 0.88);
        cairo_move_to(cairo, x->begin, on(y, v));
        cairo_line_to(cairo, x->begin + x->length, on(y, v));
        cairo_stroke(cairo);
        cairo_set_source_rgb(cairo, COLOUR_INK);
        canvas_text(cairo, x->begin - 7, on(y, v) + 4, 1, 12, 0, text);
    }
    cairo_rectangle(cairo, x->begin, y->begin, x->length, y->length);
    cairo_stroke(cairo);
}

static void draw_labels(const struct chart *chart, cairo_t *cairo, const struct axis *x, const struct axis *y)
{
    cairo_set_source_rgb(cairo, COLOUR_INK);
    canvas_text(cairo, x->begin, 18, 0, 14, 1, chart->title);
    canvas_text(cairo, x->begin + 0.5 * x->length, y->begin + 38, 0.5, 13, 0, chart->x_label);
    cairo_save(cairo);
    cairo_translate(cairo, 18, y->begin + 0.5 * y->length);
    cairo_rotate(cairo, -M_PI / 2);
    canvas_text(cairo, 0, 0, 0.5, 13, 0, chart->y_label);
    cairo_restore(cairo);
}

/* ---- lines ---- */

static void draw_marker(cairo_t *cairo, double x, double y, size_t kind)
{
    const double r = 3.5;
    cairo_new_path(cairo);
    if (kind % MARKERS == 0)
        cairo_arc(cairo, x, y, r, 0, 2 * M_PI);
    else if (kind % MARKERS == 1)
        cairo_rectangle(cairo, x - r, y - r, 2 * r, 2 * r);
    else {
        double up = kind % MARKERS == 2 ? -1 : 1;
        cairo_move_to(cairo, x, y + up * 1.2 * r);
        cairo_line_to(cairo, x + 1.2 * r, y - up * r);
        cairo_line_to(cairo, x - 1.2 * r, y - up * r);
        cairo_close_path(cairo);
    }
    cairo_fill(cairo);
}

const double *chart_colour(size_t style)
{
    return COLOURS[style % COLOUR_COUNT];
}

static void set_style(cairo_t *cairo, const struct chart_line *line)
{
    static const double dashes[] = {5, 4};
    const double *colour = chart_colour(line->style);
    if (line->open)
        cairo_set_source_rgb(cairo, COLOUR_INK);
    else
        cairo_set_source_rgb(cairo, colour[0], colour[1], colour[2]);
    cairo_set_dash(cairo, dashes, line->dashed ? 2 : 0, 0);
    cairo_set_line_width(cairo, line->open ? 0.8 : 1.6);
}

/* In the style that is set. */
static void mark(cairo_t *cairo, const struct chart_line *line, double x, double y)
{
    if (!line->open) {
        draw_marker(cairo, x, y, line->style);
        return;
    }
    cairo_new_path(cairo);
    cairo_arc(cairo, x, y, 5, 0, 2 * M_PI);
    cairo_set_line_width(cairo, 1.4);
    cairo_stroke(cairo);
}

/* Has the point no neighbour to draw a line to? A long line would hide it: the one grey level at which a photo is
 * saturated, every level of an 8-bit photo whose contrast was stretched. */
static int is_alone(const struct chart *chart, const struct chart_line *line, size_t k)
{
    int before = k > 0 && !isnan(height_of(chart, line, k - 1));
    int after = k + 1 < line->count && !isnan(height_of(chart, line, k + 1));
    return !before && !after;
}

static void draw_line(const struct chart *chart, cairo_t *cairo, size_t l, const struct axis *x, const struct axis *y)
{
    const struct chart_line *line = &chart->lines[l];
    int pen_down = 0;
    set_style(cairo, line);
    cairo_new_path(cairo);
    for (size_t k = 0; k < line->count; k++) {
        double up = height_of(chart, line, k);
        if (!isnan(up) && pen_down && !line->unjoined)
            cairo_line_to(cairo, on(x, line->x[k]), on(y, up));
        else if (!isnan(up))
            cairo_move_to(cairo, on(x, line->x[k]), on(y, up));
        pen_down = !isnan(up);
    }
    cairo_stroke(cairo);
    cairo_set_dash(cairo, NULL, 0, 0);
    int all = line->count <= 60 || line->scattered;
    for (size_t k = 0; k < line->count; k++) {
        double up = height_of(chart, line, k);
        if (!isnan(up) && (all || is_alone(chart, line, k)))
            mark(cairo, line, on(x, line->x[k]), on(y, up));
    }
}

static void draw_key(const struct chart *chart, cairo_t *cairo, double left)
{
    for (size_t l = 0; l < chart->count; l++) {
        if (chart->lines[l].without_key)
            continue;
        set_style(cairo, &chart->lines[l]);
        cairo_move_to(cairo, left, 31);
        cairo_line_to(cairo, left + (chart->lines[l].unjoined ? 0 : 20), 31);
        cairo_stroke(cairo);
        cairo_set_dash(cairo, NULL, 0, 0);
        mark(cairo, &chart->lines[l], left + 10, 31);
        cairo_set_source_rgb(cairo, COLOUR_INK);
        canvas_text(cairo, left + 25, 35, 0, 12, 0, chart->lines[l].name);
        left += 37 + canvas_text_width(cairo, 12, 0, chart->lines[l].name);
    }
}

void chart_draw(const struct chart *chart, cairo_t *cairo, double width, double height)
{
    struct axis x, y;
    if (chart_is_empty(chart))
        return;
    measure(chart, width, height, &x, &y);
    draw_ticks(chart, cairo, &x, &y);
    draw_labels(chart, cairo, &x, &y);
    for (size_t l = 0; l < chart->count; l++)
        draw_line(chart, cairo, l, &x, &y);
    draw_key(chart, cairo, x.begin);
}
