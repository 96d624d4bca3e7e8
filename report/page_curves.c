/* Curves over a series: stress, structure, tracking. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "report/canvas.h"
#include "report/chart.h"
#include "report/page.h"

/* What a curve runs along: the vertical strain where it is known and changes, else time, else the number. */
struct abscissa {
    enum { ALONG_STRAIN, ALONG_TIME, ALONG_INDEX } kind;
    const char *label;
};

static struct abscissa choose_abscissa(const struct series *series)
{
    int strains = 0, times = 1;
    for (size_t k = 0; k < series->count; k++) {
        const struct series_row *row = &series->rows[k];
        strains += row->packing.path && isfinite(row->packing.strain[1]) && row->packing.strain[1] != 0;
        times &= isfinite(row->time_s);
    }
    if (strains > 0)
        return (struct abscissa){ALONG_STRAIN, "vertical strain (compression positive)"};
    return times ? (struct abscissa){ALONG_TIME, "time (s)"} : (struct abscissa){ALONG_INDEX, "photo"};
}

static double along(const struct abscissa *abscissa, const struct series_row *row)
{
    if (abscissa->kind == ALONG_STRAIN)
        return row->packing.path ? row->packing.strain[1] : NAN;
    return abscissa->kind == ALONG_TIME ? row->time_s : (double)row->index;
}

/* The forces of that method in that row, or NULL. */
static const struct force_summary *forces_of(const struct series_row *row, const char *method)
{
    for (size_t f = 0; f < row->packing.force_count; f++)
        if (!strncmp(row->packing.forces[f].method, method, NAME_LENGTH))
            return &row->packing.forces[f];
    return NULL;
}

static const struct series_row *row_with_most_methods(const struct series *series)
{
    const struct series_row *most = &series->rows[0];
    for (size_t k = 1; k < series->count; k++)
        if (series->rows[k].packing.force_count > most->packing.force_count)
            most = &series->rows[k];
    return most;
}

int page_chart(const struct chart *chart, struct html *html)
{
    const double width = 640, height = 400;
    struct canvas canvas;
    unsigned char *svg = NULL;
    size_t length = 0;
    if (chart_is_empty(chart))
        return 0;
    if (canvas_begin_memory(&canvas, CANVAS_SVG, width, height))
        return -1;
    chart_draw(chart, canvas.cairo, width, height);
    if (canvas_take(&canvas, &svg, &length))
        return -1;
    html_picture(html, "image/svg+xml", svg, length, chart->title);
    free(svg);
    return 0;
}

/* One line for yy; for xx the same style, dashed. method: NULL: the applied stress. */
static int stress_line(const struct series *series, const struct abscissa *abscissa, struct chart *chart,
                       const char *method, size_t style, int axis)
{
    struct chart_line *line = chart_add(chart, method ? method : "applied", series->count);
    if (!line)
        return -1;
    line->style = style;
    line->dashed = line->without_key = axis == 0;
    for (size_t k = 0; k < series->count; k++) {
        const struct series_row *row = &series->rows[k];
        const struct force_summary *forces = method ? forces_of(row, method) : NULL;
        double unit = row->packing.in_pascal ? 1e-3 : 1;
        if (!row->packing.path || (method && !forces))
            continue;
        chart_put(line, along(abscissa, row), unit * (method ? forces->weber : row->packing.applied)[axis][axis]);
    }
    return 0;
}

static int stress_chart(const struct series *series, const struct abscissa *abscissa, struct html *html)
{
    const struct series_row *most = row_with_most_methods(series);
    struct chart chart = {.title = "Stress, applied and from forces (Weber): yy solid, xx dashed",
                          .x_label = abscissa->label,
                          .y_label = most->packing.in_pascal ? "stress (kPa)" : "stress (N/m)",
                          .from_zero = 1,
                          .whole_x = abscissa->kind == ALONG_INDEX};
    int result = 0;
    for (int axis = 1; axis >= 0 && result == 0; axis--) {
        result = stress_line(series, abscissa, &chart, NULL, 0, axis);
        for (size_t f = 0; f < most->packing.force_count && f < 4 && result == 0; f++)
            result = stress_line(series, abscissa, &chart, most->packing.forces[f].method, f + 1, axis);
    }
    if (result == 0)
        result = page_chart(&chart, html);
    chart_free(&chart);
    return result;
}

typedef double (*quantity)(const struct series_row *row);

static double void_ratio(const struct series_row *row)
{
    return row->packing.path ? row->packing.fabric.void_ratio : NAN;
}

static double coordination(const struct series_row *row)
{
    return row->packing.path ? row->packing.fabric.z : NAN;
}

/* Anisotropy of the contact directions: the difference of the eigenvalues of <n n>. */
static double anisotropy(const struct series_row *row)
{
    const double(*t)[2] = row->packing.fabric.tensor;
    return row->packing.path ? hypot(t[0][0] - t[1][1], 2 * t[0][1]) : NAN;
}

static double zncc(const struct series_row *row)
{
    return row->tracks.path ? row->tracks.zncc_median : NAN;
}

static double least_zncc(const struct series_row *row)
{
    return row->tracks.path ? row->tracks.zncc_least : NAN;
}

static int quantity_chart(const struct series *series, const struct abscissa *abscissa, const char *title,
                          const char *label, const quantity quantities[2], const char *const names[2],
                          struct html *html)
{
    struct chart chart = {
        .title = title, .x_label = abscissa->label, .y_label = label, .whole_x = abscissa->kind == ALONG_INDEX};
    int result = 0;
    for (int q = 0; q < 2 && quantities[q] && result == 0; q++) {
        struct chart_line *line = chart_add(&chart, names[q], series->count);
        if (!line)
            result = -1;
        for (size_t k = 0; k < series->count && line; k++)
            chart_put(line, along(abscissa, &series->rows[k]), quantities[q](&series->rows[k]));
    }
    if (result == 0)
        result = page_chart(&chart, html);
    chart_free(&chart);
    return result;
}

int page_curves(const struct series *series, struct html *html)
{
    struct abscissa abscissa = choose_abscissa(series), photos = {ALONG_INDEX, "photo"};
    static const quantity voids[2] = {void_ratio, NULL}, contacts[2] = {coordination, NULL},
                          fabric[2] = {anisotropy, NULL}, tracking[2] = {zncc, least_zncc};
    static const char *const e[2] = {"void ratio"}, *const z[2] = {"z"}, *const a[2] = {"anisotropy"},
                             *const c[2] = {"median", "least of the trusted grains"};
    if (series->count < 2)
        return 0;
    fputs("<h2>Curves</h2>\n<div class=\"charts\">\n", html->stream);
    if (stress_chart(series, &abscissa, html) || page_persistence(series, html) ||
        quantity_chart(series, &abscissa, "Void ratio", "e", voids, e, html) ||
        quantity_chart(series, &abscissa, "Coordination number", "z", contacts, z, html) ||
        quantity_chart(series, &abscissa, "Anisotropy of contact directions", "|F1 - F2| of ⟨n n⟩", fabric, a, html) ||
        quantity_chart(series, &photos, "Likeness to the reference (ZNCC)", "ZNCC", tracking, c, html))
        return -1;
    fputs("</div>\n", html->stream);
    return 0;
}
