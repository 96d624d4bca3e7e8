/* Every function leaves an empty path behind, and sets all that decides how a line looks: what was drawn before does
 * not matter. */
#include "pipeline/draw/pen.h"

#include <cairo.h>
#include <math.h>

/* Red, green, blue. The eight of Okabe and Ito (2008, "Color universal design") but black, for which a dark grey
 * stands. */
static const double PALETTE[][3] = {
    [COLOUR_INK] = {0.133, 0.133, 0.133},    [COLOUR_BLUE] = {0.000, 0.447, 0.698},
    [COLOUR_GREEN] = {0.000, 0.620, 0.451},  [COLOUR_VERMILLION] = {0.835, 0.369, 0.000},
    [COLOUR_ORANGE] = {0.902, 0.624, 0.000}, [COLOUR_PURPLE] = {0.800, 0.475, 0.655},
    [COLOUR_SKY] = {0.337, 0.706, 0.914},    [COLOUR_YELLOW] = {0.941, 0.894, 0.259},
    [COLOUR_GREY] = {0.600, 0.600, 0.600},   [COLOUR_GRID] = {0.88, 0.88, 0.88},
    [COLOUR_GRAIN] = {0.925, 0.925, 0.915},  [COLOUR_WHITE] = {1, 1, 1},
};

void pen_set(struct canvas *canvas, const struct pen *pen)
{
    const double *c = PALETTE[pen->colour];
    cairo_t *cairo = canvas->cairo;
    cairo_set_source_rgba(cairo, c[0], c[1], c[2], 1 - pen->clear);
    cairo_set_line_width(cairo, pen->width);
    cairo_set_dash(cairo, pen->dash, pen->dash[0] > 0 ? 2 : 0, 0);
    cairo_set_line_cap(cairo, pen->round_ends ? CAIRO_LINE_CAP_ROUND : CAIRO_LINE_CAP_BUTT);
    cairo_set_line_join(cairo, pen->round_joins ? CAIRO_LINE_JOIN_ROUND : CAIRO_LINE_JOIN_MITER);
}

/* ---- paths ---- */

void pen_begin(struct canvas *canvas)
{
    cairo_new_path(canvas->cairo);
}

void pen_move(struct canvas *canvas, double x, double y)
{
    cairo_move_to(canvas->cairo, x, y);
}

void pen_go(struct canvas *canvas, double x, double y)
{
    cairo_line_to(canvas->cairo, x, y);
}

void pen_close(struct canvas *canvas)
{
    cairo_close_path(canvas->cairo);
}

void pen_draw(struct canvas *canvas, const struct pen *pen)
{
    pen_set(canvas, pen);
    if (pen->width > 0)
        cairo_stroke(canvas->cairo);
    else
        cairo_fill(canvas->cairo);
}

/* ---- shapes ---- */

void pen_segment(struct canvas *canvas, const struct pen *pen, double x0, double y0, double x1, double y1)
{
    pen_begin(canvas);
    pen_move(canvas, x0, y0);
    pen_go(canvas, x1, y1);
    pen_draw(canvas, pen);
}

void pen_circle(struct canvas *canvas, const struct pen *pen, double x, double y, double radius)
{
    pen_begin(canvas);
    cairo_arc(canvas->cairo, x, y, radius, 0, 2 * M_PI);
    pen_draw(canvas, pen);
}

void pen_rectangle(struct canvas *canvas, const struct pen *pen, double x, double y, double width, double height)
{
    pen_begin(canvas);
    cairo_rectangle(canvas->cairo, x, y, width, height);
    pen_draw(canvas, pen);
}

/* The shaft ends inside the head, 0.8 of it from the tip, so that no blunt end stands out of the tip. Head: as wide as
 * long, along the unit vector u and across it (-u_y, u_x). */
void pen_arrow(struct canvas *canvas, const struct pen *pen, double x0, double y0, double x1, double y1, double unit)
{
    double length = hypot(x1 - x0, y1 - y0), head = fmin(7 * unit, 0.5 * length);
    if (length < 0.5 * unit)
        return;
    double ux = (x1 - x0) / length, uy = (y1 - y0) / length;
    pen_segment(canvas, pen, x0, y0, x1 - 0.8 * head * ux, y1 - 0.8 * head * uy);
    pen_move(canvas, x1, y1);
    pen_go(canvas, x1 - head * ux - 0.5 * head * uy, y1 - head * uy + 0.5 * head * ux);
    pen_go(canvas, x1 - head * ux + 0.5 * head * uy, y1 - head * uy - 0.5 * head * ux);
    pen_close(canvas);
    pen_draw(canvas, &(struct pen){pen->colour, .clear = pen->clear});
}

/* cairo's angles run clockwise as seen, since y points down. */
static void arc(struct canvas *canvas, double x, double y, double radius, int k, int count)
{
    const double step = 2 * M_PI / count;
    cairo_arc_negative(canvas->cairo, x, y, radius, -(k - 0.5) * step, -(k + 0.5) * step);
}

void pen_sector(struct canvas *canvas, const struct pen *pen, double x, double y, double radius, int k, int count)
{
    pen_begin(canvas);
    pen_move(canvas, x, y);
    arc(canvas, x, y, radius, k, count);
    pen_close(canvas);
    pen_draw(canvas, pen);
}

void pen_arcs(struct canvas *canvas, const struct pen *pen, double x, double y, const double radius[], int count)
{
    pen_begin(canvas);
    for (int k = 0; k < count; k++)
        arc(canvas, x, y, radius[k], k, count);
    pen_close(canvas);
    pen_draw(canvas, pen);
}
