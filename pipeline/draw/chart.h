/* A chart: lines, points and bars over common axes, told apart by marker and colour; its title, its axes' names, and
 * above them a key. */
#ifndef DRAW_CHART_H
#define DRAW_CHART_H

#include <stddef.h>

#include "pipeline/draw/pen.h"

enum { CHART_LINES = 12 };

/* Drawn with a line from point to point and a marker on each where they are few (60), unless the flags say else. */
struct chart_line {
    char name[48];
    double *x, *y; /* owned; a point that is not finite, or not positive on a logarithmic axis, breaks the line */
    size_t count;
    size_t style; /* colour and marker; the number of the line unless set */
    int dashed, without_key;
    int scattered; /* a marker on every point, however many there are */
    int open;      /* open circles on a thin line, in ink: what lies under it can be seen */
    int unjoined;  /* points only */
    int unmarked;  /* line only */
    double bars;   /* > 0: bars from the lower axis to y, as wide as that on the x axis, instead of a line */
};

/* Zero, but for title and names, is a chart with linear axes as long as the points need. The texts are borrowed. */
struct chart {
    const char *title, *x_label, *y_label;
    int log_x, log_y;            /* points <= 0 are left out */
    int from_zero;               /* the upward axis */
    int whole_x;                 /* ticks at whole numbers */
    double x_from, x_to, x_step; /* x_step 0: chosen */
    struct chart_line lines[CHART_LINES];
    size_t count;
};

/* A new line with room for that many points, owned by the chart; NULL (error set) when out of memory or lines. */
struct chart_line *chart_add(struct chart *chart, const char *name, size_t capacity);
/* The next point, within the line's capacity. */
void chart_put(struct chart_line *line, double x, double y);
/* The colour of a style. */
enum colour chart_colour(size_t style);
/* Has no line a point that can be drawn? */
int chart_is_empty(const struct chart *chart);
/* Into (0, 0, width, height); 300 x 200 at least look well. Without points: axes from 0 to 1. */
void chart_draw(const struct chart *chart, struct canvas *canvas, double width, double height);
/* Charts side by side, each of that size and with axes of one height, as a picture file whose words stay words in an
 * SVG; canvas_begin() says what can go wrong. The charts stay the caller's. */
int chart_write(const char *path, const struct chart *charts, size_t count, double width, double height);
void chart_free(struct chart *chart); /* accepts a zeroed struct */

#endif
