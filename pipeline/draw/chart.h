/* A small chart: lines with markers over common axes; told apart by marker and colour. */
#ifndef REPORT_CHART_H
#define REPORT_CHART_H

#include <cairo.h>
#include <stddef.h>

enum { CHART_LINES = 12 };

struct chart_line {
    char name[48];
    double *x, *y; /* owned; a point that is not finite breaks the line */
    size_t count;
    size_t style; /* colour and marker */
    int dashed, without_key;
    int scattered; /* a marker on every point, however many there are */
    int open;      /* open circles on a thin line, in ink: what lies under it can be seen */
    int unjoined;  /* points only */
};

struct chart {
    const char *title, *x_label, *y_label;
    int log_y;                   /* points <= 0 are left out */
    int from_zero;               /* the upward axis */
    int whole_x;                 /* ticks at whole numbers */
    double x_from, x_to, x_step; /* x_step 0: chosen */
    struct chart_line lines[CHART_LINES];
    size_t count;
};

/* A new line with room for that many points; NULL (error set) when out of memory or lines. */
struct chart_line *chart_add(struct chart *chart, const char *name, size_t capacity);
void chart_put(struct chart_line *line, double x, double y);
/* The colour of a style: red, green, blue. */
const double *chart_colour(size_t style);
int chart_is_empty(const struct chart *chart); /* no line with a finite point */
void chart_draw(const struct chart *chart, cairo_t *cairo, double width, double height);
void chart_free(struct chart *chart); /* accepts a zeroed struct */

#endif
