#include "report/rose.h"

#include <math.h>

#include "report/canvas.h"

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

static void key(cairo_t *cairo, double left, const double mean_fn[ROSE_BINS])
{
    cairo_set_source_rgba(cairo, COLOUR_BLUE, 0.45);
    cairo_rectangle(cairo, left, 26, 16, 10);
    cairo_fill(cairo);
    cairo_set_source_rgb(cairo, COLOUR_INK);
    canvas_text(cairo, left + 21, 35, 0, 12, 0, "contacts");
    if (!mean_fn)
        return;
    cairo_set_source_rgb(cairo, COLOUR_VERMILLION);
    cairo_rectangle(cairo, left + 100, 26, 16, 10);
    cairo_stroke(cairo);
    cairo_set_source_rgb(cairo, COLOUR_INK);
    canvas_text(cairo, left + 121, 35, 0, 12, 0, "mean fn");
}

void rose_draw(cairo_t *cairo, double width, double height, const char *title, const double share[ROSE_BINS],
               const double mean_fn[ROSE_BINS])
{
    double most = 1.5, x = 0.5 * width, y = 45 + 0.5 * (height - 55);
    for (int b = 0; b < ROSE_BINS; b++)
        most = fmax(most, fmax(isnan(share[b]) ? 0 : share[b], mean_fn && !isnan(mean_fn[b]) ? mean_fn[b] : 0));
    double unit = 0.48 * fmin(width, height - 60) / most;
    cairo_set_source_rgb(cairo, COLOUR_INK);
    canvas_text(cairo, 20, 18, 0, 14, 1, title);
    key(cairo, 20, mean_fn);
    for (int b = 0; b < ROSE_BINS; b++) {
        wedge(cairo, x, y, unit * (isnan(share[b]) ? 0 : share[b]), b);
        cairo_set_source_rgba(cairo, COLOUR_BLUE, 0.45);
        cairo_fill_preserve(cairo);
        cairo_set_source_rgb(cairo, COLOUR_BLUE);
        cairo_set_line_width(cairo, 0.7);
        cairo_stroke(cairo);
    }
    if (mean_fn) {
        cairo_set_source_rgb(cairo, COLOUR_VERMILLION);
        cairo_set_line_width(cairo, 1.8);
        outline(cairo, x, y, unit, mean_fn);
    }
    cairo_set_source_rgb(cairo, COLOUR_GREY);
    cairo_set_line_width(cairo, 1);
    cairo_new_path(cairo);
    cairo_arc(cairo, x, y, unit, 0, 2 * M_PI);
    cairo_stroke(cairo);
    canvas_text(cairo, x + unit + 4, y - 4, 0, 11, 0, "1");
}
