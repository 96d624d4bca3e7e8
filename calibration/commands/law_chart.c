#include "calibration/commands/law_chart.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "pipeline/speak/error.h"
#include "pipeline/files/new_file.h"

enum { LEFT = 78, TITLE = 22, WIDTH = 330, HEIGHT = 250, PANEL = 450, BOTTOM = 52, TICKS = 5, KEY_ROW = 16 };

/* Upper left corner of the axes, px. */
struct corner {
    double left, top;
};

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

static void write_ticks(FILE *file, const struct axis *axis, const struct corner *at, int vertical)
{
    double step = tick_step(axis);
    for (double t = ceil(axis->low / step) * step; t <= axis->high; t += step) {
        char text[32];
        double share = (t - axis->low) / (axis->high - axis->low);
        double value = axis->log ? pow(10, t) : fabs(t) < 1e-9 * step ? 0 : t;
        snprintf(text, sizeof text, "%.4g", value);
        if (vertical) {
            double y = at->top + HEIGHT * (1 - share);
            fprintf(file, "<path d=\"M%.1f %.1fh%d\" stroke=\"#ddd\"/>\n", at->left, y, WIDTH);
            write_text(file, at->left - 5, y + 4, "end", "", text);
        } else {
            double x = at->left + WIDTH * share;
            fprintf(file, "<path d=\"M%.1f %.1fv%d\" stroke=\"#ddd\"/>\n", x, at->top, HEIGHT);
            write_text(file, x, at->top + HEIGHT + 16, "middle", "", text);
        }
    }
}

static void write_curve(FILE *file, const struct chart_curve *curve, const struct axis axes[2], const struct corner *at,
                        const char *colour)
{
    int down = 0;
    if (curve->style == CHART_LINE)
        fprintf(file, "<path fill=\"none\" stroke=\"%s\" stroke-width=\"1.5\" d=\"", colour);
    for (size_t k = 0; k < curve->count; k++) {
        double x = place(&axes[0], curve->x[k], at->left, WIDTH),
               y = place(&axes[1], curve->y[k], at->top + HEIGHT, -HEIGHT);
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

/* The names between title and axes, in as many rows as they need; the width of letters is taken from above. Returns
 * the number of rows; writes when there is a file. */
static int key(FILE *file, const struct chart_panel *panel, double left)
{
    const double LETTER = 7, SWATCH = 18, GAP = 14;
    double x = 0;
    int rows = 0;
    for (size_t c = 0; c < panel->curve_count; c++) {
        const char *name = panel->curves[c].name;
        if (!name)
            continue;
        double width = SWATCH + LETTER * (double)strlen(name);
        if (rows == 0 || x + width > WIDTH)
            rows++, x = 0;
        double y = TITLE + KEY_ROW * rows;
        if (file) {
            fprintf(file, "<rect x=\"%.1f\" y=\"%.1f\" width=\"12\" height=\"4\" fill=\"%s\"/>\n", left + x, y - 6,
                    COLOURS[c % COLOUR_COUNT]);
            write_text(file, left + x + SWATCH, y, "start", "", name);
        }
        x += width + GAP;
    }
    return rows;
}

static void write_panel(FILE *file, const struct chart_panel *panel, const struct corner *at)
{
    struct axis axes[2] = {axis_of(panel, 0), axis_of(panel, 1)};
    char turned[96];
    write_ticks(file, &axes[0], at, 0);
    write_ticks(file, &axes[1], at, 1);
    fprintf(file, "<rect x=\"%.1f\" y=\"%.1f\" width=\"%d\" height=\"%d\" fill=\"none\" stroke=\"#888\"/>\n", at->left,
            at->top, WIDTH, HEIGHT);
    write_text(file, at->left, TITLE, "start", " font-weight=\"bold\"", panel->title);
    write_text(file, at->left + WIDTH / 2, at->top + HEIGHT + 36, "middle", "", panel->x_label);
    double middle = at->top + HEIGHT / 2;
    snprintf(turned, sizeof turned, " transform=\"rotate(-90 %.1f %.1f)\"", at->left - 62, middle);
    write_text(file, at->left - 62, middle, "middle", turned, panel->y_label);
    for (size_t c = 0; c < panel->curve_count; c++)
        write_curve(file, &panel->curves[c], axes, at, COLOURS[c % COLOUR_COUNT]);
    key(file, panel, at->left);
}

static int write_chart(FILE *file, const struct chart_panel *panels, size_t count)
{
    int rows = 0;
    for (size_t p = 0; p < count; p++) {
        int needed = key(NULL, &panels[p], 0);
        rows = needed > rows ? needed : rows;
    }
    struct corner at = {LEFT, TITLE + 12 + KEY_ROW * rows};
    fprintf(file,
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"%zu\" height=\"%.0f\" font-family=\"sans-serif\" "
            "font-size=\"12\">\n<rect width=\"100%%\" height=\"100%%\" fill=\"white\"/>\n",
            PANEL * count, at.top + HEIGHT + BOTTOM);
    for (size_t p = 0; p < count; p++, at.left += PANEL)
        write_panel(file, &panels[p], &at);
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
