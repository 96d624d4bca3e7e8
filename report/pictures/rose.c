/* Directions of contacts, 0 to 2 pi in ROSE_BINS bins, the first one centred on 0. The radius is a share over that of
 * even directions: a circle of radius 1 is an isotropic packing; the area of a wedge grows with the square of it. Mean
 * normal forces by direction stand over the mean of all contacts, as outlines, one for each method. */
#include "report/pictures/rose.h"

#include <math.h>
#include <stdio.h>

#include "pipeline/draw/chart.h"
#include "pipeline/draw/legend.h"

static const struct pen FACE = {COLOUR_BLUE, .clear = 0.55}, EDGE = {COLOUR_BLUE, .width = 0.7};

static struct pen pen_of(const struct rose_outline *outline)
{
    return (struct pen){chart_colour(outline->style), .width = 1.8};
}

/* Wedges first, then a line for each method. */
static void key(struct canvas *canvas, double left, const struct rose_outline *outlines, size_t count)
{
    struct legend_entry entry = {LEGEND_PATCH, FACE, .length = 16, .gap = 5, .size = 12, .text = "contacts"};
    legend_draw(canvas, &entry, left, 31, 4);
    left += 95;
    for (size_t k = 0; k < count; k++, left += 90) {
        char text[32];
        snprintf(text, sizeof text, "fn by %s", outlines[k].name);
        entry.sample = LEGEND_LINE, entry.pen = pen_of(&outlines[k]), entry.text = text;
        legend_draw(canvas, &entry, left, 31, 4);
    }
}

/* Directions without contacts have no mean force: their radius is 0. */
static double known(double value)
{
    return isnan(value) ? 0 : value;
}

/* Over the bins that are known. */
static double largest(const double values[ROSE_BINS])
{
    double most = 0;
    for (int b = 0; b < ROSE_BINS; b++)
        most = fmax(most, known(values[b]));
    return most;
}

static void draw_outline(struct canvas *canvas, double x, double y, double unit, const struct rose_outline *outline)
{
    double radius[ROSE_BINS];
    const struct pen pen = pen_of(outline);
    for (int b = 0; b < ROSE_BINS; b++)
        radius[b] = fmax(unit * known(outline->mean_fn[b]), 1e-6);
    pen_arcs(canvas, &pen, x, y, radius, ROSE_BINS);
}

/* The largest radius, 1.5 at least, fills the space below the key. */
void rose_draw(struct canvas *canvas, double width, double height, const char *title, const double share[ROSE_BINS],
               const struct rose_outline *outlines, size_t count)
{
    double most = fmax(1.5, largest(share)), x = 0.5 * width, y = 45 + 0.5 * (height - 55);
    for (size_t k = 0; k < count; k++)
        most = fmax(most, largest(outlines[k].mean_fn));
    double unit = 0.48 * fmin(width, height - 60) / most;
    words_draw(canvas, 20, 18, 0, 14, 1, title);
    key(canvas, 20, outlines, count);
    for (int b = 0; b < ROSE_BINS; b++) {
        pen_sector(canvas, &FACE, x, y, unit * known(share[b]), b, ROSE_BINS);
        pen_sector(canvas, &EDGE, x, y, unit * known(share[b]), b, ROSE_BINS);
    }
    for (size_t k = 0; k < count; k++)
        draw_outline(canvas, x, y, unit, &outlines[k]);
    pen_circle(canvas, &(struct pen){COLOUR_INK, .width = 1}, x, y, unit);
    words_draw(canvas, 20, height - 12, 0, 12, 0, "circle: the mean of all directions");
}
