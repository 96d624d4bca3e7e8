#include "report/pictures/rose.h"

#include <math.h>
#include <stdio.h>

#include "pipeline/draw/canvas.h"
#include "pipeline/draw/chart.h"

static const double STEP = 2 * M_PI / ROSE_BINS;

static void wedge(cairo_t *cairo, double x, double y, double r, int bin)
{
    cairo_new_path(cairo);
    cairo_move_to(cairo, x, y); /* angles run counter-clockwise, y is down on the picture */
    cairo_arc_negative(cairo, x, y, r, -(bin - 0.5) * STEP, -(bin + 0.5) * STEP);
    cairo_close_path(cairo);
}

static void outline(cairo_t *cairo, double x, double y, double unit, const double values[ROSE_BINS])
{
    cairo_new_path(cairo);
    for (int b = 0; b < ROSE_BINS; b++) {
        double r = unit * (isnan(values[b]) ? 0 : values[b]);
        cairo_arc_negative(cairo, x, y, fmax(r, 1e-6), -(b - 0.5) * STEP, -(b + 0.5) * STEP);
    }
    cairo_close_path(cairo);
    cairo_stroke(cairo);
}

static void set_colour(cairo_t *cairo, const struct rose_outline *outline)
{
    const double *colour = chart_colour(outline->style);
    cairo_set_source_rgb(cairo, colour[0], colour[1], colour[2]);
}

static void key(cairo_t *cairo, double left, const struct rose_outline *outlines, size_t count)
{
    cairo_set_source_rgba(cairo, COLOUR_BLUE, 0.45);
    cairo_rectangle(cairo, left, 26, 16, 10);
    cairo_fill(cairo);
    cairo_set_source_rgb(cairo, COLOUR_INK);
    canvas_text(cairo, left + 21, 35, 0, 12, 0, "contacts");
    left += 95;
    for (size_t k = 0; k < count; k++, left += 90) {
        char text[32];
        set_colour(cairo, &outlines[k]);
        cairo_set_line_width(cairo, 1.8);
        cairo_move_to(cairo, left, 31);
        cairo_line_to(cairo, left + 16, 31);
        cairo_stroke(cairo);
        cairo_set_source_rgb(cairo, COLOUR_INK);
        snprintf(text, sizeof text, "fn by %s", outlines[k].name);
        canvas_text(cairo, left + 21, 35, 0, 12, 0, text);
    }
}

static double largest(const double values[ROSE_BINS])
{
    double most = 0;
    for (int b = 0; b < ROSE_BINS; b++)
        most = fmax(most, isnan(values[b]) ? 0 : values[b]);
    return most;
}

static void draw_wedges(cairo_t *cairo, double x, double y, double unit, const double share[ROSE_BINS])
{
    for (int b = 0; b < ROSE_BINS; b++) {
        wedge(cairo, x, y, unit * (isnan(share[b]) ? 0 : share[b]), b);
        cairo_set_source_rgba(cairo, COLOUR_BLUE, 0.45);
        cairo_fill_preserve(cairo);
        cairo_set_source_rgb(cairo, COLOUR_BLUE);
        cairo_set_line_width(cairo, 0.7);
        cairo_stroke(cairo);
    }
}

void rose_draw(cairo_t *cairo, double width, double height, const char *title, const double share[ROSE_BINS],
               const struct rose_outline *outlines, size_t count)
{
    double most = fmax(1.5, largest(share)), x = 0.5 * width, y = 45 + 0.5 * (height - 55);
    for (size_t k = 0; k < count; k++)
        most = fmax(most, largest(outlines[k].mean_fn));
    double unit = 0.48 * fmin(width, height - 60) / most;
    cairo_set_source_rgb(cairo, COLOUR_INK);
    canvas_text(cairo, 20, 18, 0, 14, 1, title);
    key(cairo, 20, outlines, count);
    draw_wedges(cairo, x, y, unit, share);
    for (size_t k = 0; k < count; k++) {
        set_colour(cairo, &outlines[k]);
        cairo_set_line_width(cairo, 1.8);
        outline(cairo, x, y, unit, outlines[k].mean_fn);
    }
    cairo_set_source_rgb(cairo, COLOUR_INK);
    cairo_set_line_width(cairo, 1);
    cairo_new_path(cairo);
    cairo_arc(cairo, x, y, unit, 0, 2 * M_PI);
    cairo_stroke(cairo);
    canvas_text(cairo, 20, height - 12, 0, 12, 0, "circle: the mean of all directions");
}
