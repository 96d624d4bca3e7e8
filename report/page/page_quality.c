/* How well the photos were read: ZNCC and standard errors through the series, and over the grains of its last photo.
 * The reference compared with itself (no error, ZNCC 1) is left out: it would set the scale of the charts. */
#include <math.h>
#include <stdlib.h>

#include "pipeline/speak/error.h"
#include "report/page/page.h"

/* rad per degree. */
static const double DEGREE = 0.017453292519943295;

/* Points of a line over the share of the grains: one per cent. */
enum { PLOT_POINTS = 101 };

/* ---- through the series ---- */

/* One chart of struct photo_summary's quantiles through the series. */
struct measure {
    const char *title, *label;
    size_t offset; /* of its quantiles in a photo's summary */
    double unit;
    int low; /* the bad end: 5 % and the least, instead of 95 % and the largest */
};

static const struct measure measures[] = {
    {"Likeness to the reference (ZNCC)", "ZNCC", offsetof(struct photo_summary, zncc), 1, 1},
    {"Standard error of the motion", "s_x (px)", offsetof(struct photo_summary, s_place), 1, 0},
    {"Standard error of the rotation", "s_angle (degrees)", offsetof(struct photo_summary, s_angle),
     1 / 0.017453292519943295, 0},
};

/* Three lines through the series: the median, the 5 % (or 95 %) quantile on the bad side, and the worst grain. The
 * least and the largest alone would say little: one lost grain makes them. */
static int series_chart(const struct series *series, const struct measure *measure, struct html *html)
{
    struct chart chart = {.title = measure->title, .x_label = "photo", .y_label = measure->label, .whole_x = 1};
    const char *const names[3] = {"median", measure->low ? "5 %" : "95 %", measure->low ? "least" : "largest"};
    int result = 0;
    for (int l = 0; l < 3 && result == 0; l++) {
        struct chart_line *line = chart_add(&chart, names[l], series->count);
        if (!line)
            result = -1;
        for (size_t k = 0; k < series->count && line; k++) {
            const struct photo_summary *photo = &series->rows[k].tracks;
            const struct quantiles *q = (const void *)((const char *)photo + measure->offset);
            double value = l == 0         ? q->middle
                           : l == 1       ? (measure->low ? q->low : q->high)
                           : measure->low ? q->least
                                          : q->most;
            if (photo->path && !(photo->s_place.most == 0 && photo->zncc.least == 1)) /* the reference against itself */
                chart_put(line, (double)series->rows[k].index, measure->unit * value);
        }
    }
    if (result == 0)
        result = page_chart(&chart, html);
    chart_free(&chart);
    return result;
}

/* ---- over the grains of one photo ---- */

int page_put_quantiles(struct chart *chart, const char *name, const double *values, const uint32_t *flags, size_t rows,
                       double unit)
{
    size_t count;
    if (!values)
        return 0;
    struct chart_line *line = chart_add(chart, name, PLOT_POINTS);
    double *sorted = line ? sorted_values(values, flags, GRAIN_DISTRUST, rows, &count) : NULL;
    if (!sorted)
        return -1;
    for (int k = 0; k < PLOT_POINTS && count; k++) {
        double share = (double)k / (PLOT_POINTS - 1);
        chart_put(line, 100 * share, unit * quantile(sorted, count, share));
    }
    free(sorted);
    return 0;
}

/* 1 - ZNCC, to be freed; NULL without that column. */
static int unlikeness(const struct photo_grains *grains, double **values)
{
    *values = NULL;
    if (!grains->zncc)
        return 0;
    *values = malloc((grains->count + 1) * sizeof **values);
    if (!*values)
        return error_memory("a chart");
    for (size_t k = 0; k < grains->count; k++)
        (*values)[k] = 1 - grains->zncc[k];
    return 0;
}

/* Standard errors and 1 - ZNCC over the grains of one photo, trusted rows only. 1 - ZNCC because good values crowd
 * below 1, where only a logarithm parts them. */
static int photo_charts(const struct photo_grains *grains, struct html *html)
{
    struct chart zncc = {.title = "Last photo: 1 - ZNCC of the grains",
                         .x_label = "grains below (%)",
                         .y_label = "1 - ZNCC",
                         .log_y = 1},
                 errors = {.title = "Last photo: standard errors of the grains",
                           .x_label = "grains below (%)",
                           .y_label = "standard error",
                           .log_y = 1};
    double *unlike;
    int result = unlikeness(grains, &unlike) ||
                         page_put_quantiles(&zncc, "1 - ZNCC", unlike, grains->flags, grains->count, 1) ||
                         page_put_quantiles(&errors, "motion, px", grains->s_x, grains->flags, grains->count, 1) ||
                         page_put_quantiles(&errors, "rotation, degrees", grains->s_angle, grains->flags, grains->count,
                                            1 / DEGREE) ||
                         page_put_quantiles(&errors, "radius, px", grains->s_radius, grains->flags, grains->count, 1) ||
                         page_chart(&zncc, html) || page_chart(&errors, html)
                     ? -1
                     : 0;
    free(unlike);
    chart_free(&zncc);
    chart_free(&errors);
    return result;
}

int page_quality(const struct series *series, struct html *html)
{
    const struct series_row *last = NULL;
    struct loaded loaded;
    for (size_t k = 0; k < series->count; k++)
        if (series->rows[k].tracks.path)
            last = &series->rows[k];
    if (!last)
        return 0;
    fputs("<h2>Tracking</h2>\n<div class=\"charts\">\n", html->stream);
    for (size_t m = 0; m < sizeof measures / sizeof *measures && series->count > 1; m++)
        if (series_chart(series, &measures[m], html))
            return -1;
    if (loaded_read(last->tracks.path, &loaded))
        return -1;
    int result = photo_charts(&loaded.grains, html);
    loaded_free(&loaded);
    fputs("</div>\n", html->stream);
    return result;
}
