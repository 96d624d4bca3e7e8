/* Small line charts as SVG: what a calibration shows beside its numbers. */
#ifndef CALIBRATION_CHART_H
#define CALIBRATION_CHART_H

#include <stddef.h>

enum chart_style { CHART_LINE, CHART_DOTS };

struct chart_curve {
    const char *name; /* NULL: not in the legend */
    const double *x, *y;
    size_t count; /* points that are not finite break the line */
    enum chart_style style;
};

struct chart_panel {
    const char *title, *x_label, *y_label;
    int log_x, log_y; /* decades; points that are not positive are left out */
    const struct chart_curve *curves;
    size_t curve_count;
};

/* Panels side by side, each with its axes and, above them, its key; written whole or not at all. */
int chart_write(const char *path, const struct chart_panel *panels, size_t count);

#endif
