#include "calibration/chart.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "pipeline/error.h"
#include "pipeline/new_file.h"

enum { LEFT = 78, TOP = 34, WIDTH = 330, HEIGHT = 250, PANEL = 450, BOTTOM = 52, TICKS = 5 };

/* Colours that are told apart with any colour vision (Okabe and Ito 2008). */
static const char *const COLOURS[] = {"#0072b2", "#d55e00", "#009e73", "#cc79a7", "#000000", "#e69f00", "#56b4e9"};
enum { COLOUR_COUNT = 7 };

struct axis {
    double low, high;
    int log;
};

static double scaled(const struct axis *axis, double value)
{
    if (axis->log)
        return value > 0 ? log10(value) : NAN;
    return value;
}

static struct axis axis_of(const struct chart_panel *panel, int vertical)
{
    struct axis axis = {INFINITY, -INFINITY, vertical ? panel->log_y : panel->log_x};
    for (size_t c = 0; c < panel->curve_count; c++)
        for (size_t k = 0; k < panel->curves[c].count; k++) {
            double value = scaled(&axis, vertical ? panel->curves[c].y[k] : panel->curves[c].x[k]);
            if (isfinite(value)) {
                axis.low = fmin(axis.low, value);
                axis.high = fmax(axis.high, value);
            }
        }
    if (!(axis.low <= axis.high))
        axis.low = 0, axis.high = 1;
    if (axis.high - axis.low < 1e-12 * fmax(1e-300, fabs(axis.high)))
        axis.low -= 0.5 * fmax(1e-9, fabs(axis.low)), axis.high += 0.5 * fmax(1e-9, fabs(axis.high));
    double margin = 0.04 * (axis.high - axis.low);
    axis.low -= margin, axis.high += margin;
    return axis;
}

static double place(const struct axis *axis, double value, double from, double length)
{
    return from + length * (scaled(axis, value) - axis->low) / (axis->high - axis->low);
}

/* 1, 2 or 5 times a power of ten; whole decades on a logarithmic axis. */
static double tick_step(const struct axis *axis)
{
    double rough = (axis->high - axis->low) / TICKS, power = pow(10, floor(log10(rough))), share = rough / power;
    double step = power * (share < 1.5 ? 1 : share < 3.5 ? 2 : share < 7.5 ? 5 : 10);
    return axis->log ? fmax(1, round(step)) : step;
}

static void write_text(FILE *file, double x, double y, const char *anchor, const char *more, const char *text)
{
    fprintf(file, "<text x=\"%.1f\" y=\"%.1f\" text-anchor=\"%s\"%s>", x, y, anchor, more);
    for (; *text; text++)
        switch (*text) {
        case '<':
            fputs("&lt;", file);
            break;
        case '&':
            fputs("&amp;", file);
            break;
        default:
            fputc(*text, file);
        }
    fputs("</text>\n", file);
}

static void write_ticks(FILE *file, const struct axis *axis, double left, int vertical)
{
    double step = tick_step(axis);
    for (double t = ceil(axis->low / step) * step; t <= axis->high; t += step) {
        char text[32];
        double share = (t - axis->low) / (axis->high - axis->low);
        double value = axis->log ? pow(10, t) : fabs(t) < 1e-9 * step ? 0 : t;
        snprintf(text, sizeof text, "%.4g", value);
        if (vertical) {
            double y = TOP + HEIGHT * (1 - share);
            fprintf(file, "<path d=\"M%.1f %.1fh%d\" stroke=\"#ddd\"/>\n", left, y, WIDTH);
            write_text(file, left - 5, y + 4, "end", "", text);
        } else {
            double x = left + WIDTH * share;
            fprintf(file, "<path d=\"M%.1f %dv%d\" stroke=\"#ddd\"/>\n", x, TOP, HEIGHT);
            write_text(file, x, TOP + HEIGHT + 16, "middle", "", text);
        }
    }
}

static void write_curve(FILE *file, const struct chart_curve *curve, const struct axis axes[2], double left,
                        const char *colour)
{
    int down = 0;
    if (curve->style == CHART_LINE)
        fprintf(file, "<path fill=\"none\" stroke=\"%s\" stroke-width=\"1.5\" d=\"", colour);
    for (size_t k = 0; k < curve->count; k++) {
        double x = place(&axes[0], curve->x[k], left, WIDTH), y = place(&axes[1], curve->y[k], TOP + HEIGHT, -HEIGHT);
        int there = isfinite(x) && isfinite(y);
        if (there && curve->style == CHART_LINE)
            fprintf(file, "%c%.2f %.2f", down ? 'L' : 'M', x, y);
        else if (there)
            fprintf(file, "<circle cx=\"%.2f\" cy=\"%.2f\" r=\"2.6\" fill=\"%s\" fill-opacity=\"0.75\"/>\n", x, y,
                    colour);
        down = there;
    }
    if (curve->style == CHART_LINE)
        fputs("\"/>\n", file);
}

static void write_panel(FILE *file, const struct chart_panel *panel, double left)
{
    struct axis axes[2] = {axis_of(panel, 0), axis_of(panel, 1)};
    char turned[96];
    write_ticks(file, &axes[0], left, 0);
    write_ticks(file, &axes[1], left, 1);
    fprintf(file, "<rect x=\"%.1f\" y=\"%d\" width=\"%d\" height=\"%d\" fill=\"none\" stroke=\"#888\"/>\n", left, TOP,
            WIDTH, HEIGHT);
    write_text(file, left, TOP - 12, "start", " font-weight=\"bold\"", panel->title);
    write_text(file, left + WIDTH / 2, TOP + HEIGHT + 36, "middle", "", panel->x_label);
    snprintf(turned, sizeof turned, " transform=\"rotate(-90 %.1f %d)\"", left - 62, TOP + HEIGHT / 2);
    write_text(file, left - 62, TOP + HEIGHT / 2, "middle", turned, panel->y_label);
    int named = 0;
    for (size_t c = 0; c < panel->curve_count; c++) {
        const char *colour = COLOURS[c % COLOUR_COUNT];
        write_curve(file, &panel->curves[c], axes, left, colour);
        if (!panel->curves[c].name)
            continue;
        double y = TOP + 14 + 15 * named++;
        fprintf(file, "<rect x=\"%.1f\" y=\"%.1f\" width=\"12\" height=\"4\" fill=\"%s\"/>\n", left + 8, y - 6, colour);
        write_text(file, left + 24, y, "start", "", panel->curves[c].name);
    }
}

static int write_chart(FILE *file, const struct chart_panel *panels, size_t count)
{
    fprintf(file,
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"%zu\" height=\"%d\" font-family=\"sans-serif\" "
            "font-size=\"12\">\n<rect width=\"100%%\" height=\"100%%\" fill=\"white\"/>\n",
            PANEL * count, TOP + HEIGHT + BOTTOM);
    for (size_t p = 0; p < count; p++)
        write_panel(file, &panels[p], LEFT + (double)(PANEL * p));
    fputs("</svg>\n", file);
    return ferror(file) ? -1 : 0;
}

int chart_write(const char *path, const struct chart_panel *panels, size_t count)
{
    struct new_file target = {0};
    if (new_file_begin(&target, path))
        return -1;
    FILE *file = fopen(target.temporary, "w");
    int failed = !file || write_chart(file, panels, count);
    if (file)
        failed |= fclose(file) != 0;
    if (failed) {
        error_set(EXIT_FAILED, "%s: %s: is the disk full?", path, strerror(errno));
        new_file_discard(&target);
        return -1;
    }
    return new_file_commit(&target);
}
