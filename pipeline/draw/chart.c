/* The chart is drawn from behind: grid and numbers, frame, names, then lines and bars in the order in which they were
 * added, each with its markers, then the key. */
#include "pipeline/draw/chart.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "pipeline/draw/axis.h"
#include "pipeline/draw/legend.h"
#include "pipeline/speak/error.h"

static const enum colour COLOURS[] = {COLOUR_BLUE,   COLOUR_VERMILLION, COLOUR_GREEN,
                                      COLOUR_ORANGE, COLOUR_PURPLE,     COLOUR_SKY};
enum { COLOUR_COUNT = 6, MARKERS = 4, FEW = 60 };

/* px: around the axes; from the picture's top to the first row of the key, and between its rows. */
enum { LEFT = 78, RIGHT = 20, ABOVE = 42, BELOW = 48, KEY = 31, KEY_ROW = 16 };

/* A chart as it lies on its canvas. */
struct layout {
    const struct chart *chart;
    struct canvas *canvas;
    struct axis x, y;
};

struct chart_line *chart_add(struct chart *chart, const char *name, size_t capacity)
{
    if (chart->count == CHART_LINES) {
        (void)error_failed("a chart of more than %d lines: report this as a defect", CHART_LINES);
        return NULL;
    }
    struct chart_line *line = &chart->lines[chart->count];
    *line = (struct chart_line){.style = chart->count++};
    snprintf(line->name, sizeof line->name, "%s", name);
    line->x = malloc((capacity + 1) * sizeof *line->x);
    line->y = malloc((capacity + 1) * sizeof *line->y);
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

/* Can the point be drawn? Then (*x, *y) is its place on the axes. */
static int point(const struct chart *chart, const struct chart_line *line, size_t k, double *x, double *y)
{
    *x = axis_value(chart->log_x, line->x[k]);
    *y = axis_value(chart->log_y, line->y[k]);
    return !isnan(*x) && !isnan(*y);
}

int chart_is_empty(const struct chart *chart)
{
    double x, y;
    for (size_t l = 0; l < chart->count; l++)
        for (size_t k = 0; k < chart->lines[l].count; k++)
            if (point(chart, &chart->lines[l], k, &x, &y))
                return 0;
    return 1;
}

/* ---- key ---- */

/* How the line of a chart is drawn, in the chart and in the key. */
static struct pen pen_of(const struct chart_line *line)
{
    struct pen pen = {.width = line->open ? 0.8 : 1.6, .colour = line->open ? COLOUR_INK : chart_colour(line->style)};
    if (line->dashed)
        pen.dash[0] = 5, pen.dash[1] = 4;
    return pen;
}

enum colour chart_colour(size_t style)
{
    return COLOURS[style % COLOUR_COUNT];
}

/* A marker tells lines apart without their colours: disc, square, triangle up, triangle down. */
static void mark(struct canvas *canvas, const struct chart_line *line, double x, double y)
{
    const double r = 3.5, up = line->style % MARKERS == 2 ? -1 : 1;
    const struct pen fill = {.colour = chart_colour(line->style)};
    if (line->open)
        pen_circle(canvas, &(struct pen){COLOUR_INK, .width = 1.4}, x, y, 5);
    else if (line->style % MARKERS == 0)
        pen_circle(canvas, &fill, x, y, r);
    else if (line->style % MARKERS == 1)
        pen_rectangle(canvas, &fill, x - r, y - r, 2 * r, 2 * r);
    else {
        pen_begin(canvas);
        pen_move(canvas, x, y + up * 1.2 * r);
        pen_go(canvas, x + 1.2 * r, y - up * r);
        pen_go(canvas, x - 1.2 * r, y - up * r);
        pen_close(canvas);
        pen_draw(canvas, &fill);
    }
}

/* With its middle at y. */
static void draw_key_entry(struct canvas *canvas, const struct chart_line *line, double left, double y)
{
    struct legend_entry entry = {.pen = pen_of(line), .length = line->unjoined ? 0 : 20};
    if (line->bars > 0) {
        entry.sample = LEGEND_PATCH;
        entry.pen.width = 0;
    }
    legend_sample(canvas, &entry, left, y);
    if (!line->unmarked && !(line->bars > 0))
        mark(canvas, line, left + 10, y);
    words_draw(canvas, left + 25, y + 4, 0, 12, 0, line->name);
}

/* In as many rows as the names need, the number of which is returned; nothing is drawn unless `drawn`. */
static int key(const struct chart *chart, struct canvas *canvas, double width, int drawn)
{
    double left = LEFT;
    int rows = 1;
    for (size_t l = 0; l < chart->count; l++) {
        if (chart->lines[l].without_key)
            continue;
        double wide = 25 + words_width(canvas, 12, 0, chart->lines[l].name);
        if (left > LEFT && left + wide > width) {
            left = LEFT;
            rows++;
        }
        if (drawn)
            draw_key_entry(canvas, &chart->lines[l], left, KEY + KEY_ROW * (rows - 1));
        left += 12 + wide;
    }
    return rows;
}

/* ---- axes ---- */

/* Both axes, long enough for every point that can be drawn and for whole bars. */
static void measure(struct layout *layout, double width, double height, int key_rows)
{
    const struct chart *chart = layout->chart;
    double x0 = INFINITY, x1 = -INFINITY, y0 = chart->from_zero ? 0 : INFINITY, y1 = chart->from_zero ? 0 : -INFINITY;
    double above = ABOVE + KEY_ROW * (key_rows - 1), x, y;
    for (size_t l = 0; l < chart->count; l++)
        for (size_t k = 0; k < chart->lines[l].count; k++)
            if (point(chart, &chart->lines[l], k, &x, &y)) {
                x0 = fmin(x0, x - 0.5 * chart->lines[l].bars);
                x1 = fmax(x1, x + 0.5 * chart->lines[l].bars);
                y0 = fmin(y0, y);
                y1 = fmax(y1, y);
            }
    if (x0 > x1)
        x0 = y0 = 0, x1 = y1 = 1;
    double across = width - LEFT - RIGHT, low = height - BELOW, up = -(height - BELOW - above);
    layout->x = chart->log_x ? axis_log(x0, x1, LEFT, across) : axis_linear(x0, x1, LEFT, across, chart->whole_x);
    layout->y = chart->log_y ? axis_log(y0, y1, low, up) : axis_linear(y0, y1, low, up, 0);
    if (chart->x_step > 0)
        layout->x.from = chart->x_from, layout->x.to = chart->x_to, layout->x.step = chart->x_step;
}

/* A grid line and a number at each tick. */
static void draw_ticks(const struct layout *layout)
{
    static const struct pen grid = {COLOUR_GRID, .width = 1}, frame = {COLOUR_INK, .width = 1};
    const struct axis *x = &layout->x, *y = &layout->y;
    struct canvas *canvas = layout->canvas;
    char text[32];
    double v;
    for (int k = 0; axis_tick(x, k, &v, text); k++) {
        pen_segment(canvas, &grid, axis_place(x, v), y->begin, axis_place(x, v), y->begin + y->length);
        words_draw(canvas, axis_place(x, v), y->begin + 17, 0.5, 12, 0, text);
    }
    for (int k = 0; axis_tick(y, k, &v, text); k++) {
        pen_segment(canvas, &grid, x->begin, axis_place(y, v), x->begin + x->length, axis_place(y, v));
        words_draw(canvas, x->begin - 7, axis_place(y, v) + 4, 1, 12, 0, text);
    }
    pen_rectangle(canvas, &frame, x->begin, y->begin, x->length, y->length);
}

/* Title, name of the x axis below it, name of the y axis upright on its left. */
static void draw_labels(const struct layout *layout)
{
    const struct chart *chart = layout->chart;
    const struct axis *x = &layout->x, *y = &layout->y;
    words_within(layout->canvas, x->begin, 18, x->length + RIGHT, 14, 1, chart->title);
    words_draw(layout->canvas, x->begin + 0.5 * x->length, y->begin + 38, 0.5, 13, 0, chart->x_label);
    canvas_move(layout->canvas, 18, y->begin + 0.5 * y->length, -M_PI / 2);
    words_draw(layout->canvas, 0, 0, 0.5, 13, 0, chart->y_label);
    canvas_restore(layout->canvas);
}

/* ---- lines ---- */

/* From the lower end of the upward axis to y, centred on x. */
static void draw_bars(const struct layout *layout, const struct chart_line *line)
{
    const struct pen fill = {.colour = chart_colour(line->style)};
    double width = fabs(layout->x.length) * line->bars / (layout->x.to - layout->x.from), x, y;
    for (size_t k = 0; k < line->count; k++)
        if (point(layout->chart, line, k, &x, &y)) {
            double top = axis_place(&layout->y, y);
            pen_rectangle(layout->canvas, &fill, axis_place(&layout->x, x) - 0.5 * width, top, width,
                          layout->y.begin - top);
        }
}

/* (A marker for each point of a long line would be a band.) Has the point no neighbour to draw a line to? A long line
 * would hide it: the one grey level at which a photo is saturated, every level of an 8-bit photo whose contrast was
 * stretched. */
static int is_alone(const struct chart *chart, const struct chart_line *line, size_t k)
{
    double x, y;
    return !(k > 0 && point(chart, line, k - 1, &x, &y)) && !(k + 1 < line->count && point(chart, line, k + 1, &x, &y));
}

/* The pen is lifted at points that cannot be drawn. Markers come last, over the line. */
static void draw_line(const struct layout *layout, const struct chart_line *line)
{
    const struct pen pen = pen_of(line);
    double x, y;
    int joined = 0, all = line->count <= FEW || line->scattered;
    pen_begin(layout->canvas);
    for (size_t k = 0; k < line->count; k++) {
        int drawn = point(layout->chart, line, k, &x, &y);
        if (drawn)
            (joined ? pen_go : pen_move)(layout->canvas, axis_place(&layout->x, x), axis_place(&layout->y, y));
        joined = drawn && !line->unjoined;
    }
    pen_draw(layout->canvas, &pen);
    for (size_t k = 0; k < line->count && !line->unmarked; k++)
        if (point(layout->chart, line, k, &x, &y) && (all || is_alone(layout->chart, line, k)))
            mark(layout->canvas, line, axis_place(&layout->x, x), axis_place(&layout->y, y));
}

/* With room for so many rows of the key. */
static void draw(const struct chart *chart, struct canvas *canvas, double width, double height, int key_rows)
{
    struct layout layout = {.chart = chart, .canvas = canvas};
    measure(&layout, width, height, key_rows);
    draw_ticks(&layout);
    draw_labels(&layout);
    for (size_t l = 0; l < chart->count; l++)
        if (chart->lines[l].bars > 0)
            draw_bars(&layout, &chart->lines[l]);
        else
            draw_line(&layout, &chart->lines[l]);
    key(chart, canvas, width, 1);
}

void chart_draw(const struct chart *chart, struct canvas *canvas, double width, double height)
{
    draw(chart, canvas, width, height, key(chart, canvas, width, 0));
}

int chart_write(const char *path, const struct chart *charts, size_t count, double width, double height)
{
    struct canvas canvas;
    if (canvas_begin(&canvas, path, width * (double)count, height))
        return -1;
    int failed = canvas_keep_words(&canvas), rows = 1;
    for (size_t k = 0; k < count; k++) {
        int needed = key(&charts[k], &canvas, width, 0);
        rows = needed > rows ? needed : rows;
    }
    for (size_t k = 0; k < count && !failed; k++) {
        canvas_move(&canvas, width * (double)k, 0, 0);
        draw(&charts[k], &canvas, width, height, rows);
        canvas_restore(&canvas);
    }
    return canvas_end(&canvas, failed);
}
