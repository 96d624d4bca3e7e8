/* Curves over a series: stress, structure, tracking. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "pipeline/draw/chart.h"
#include "report/page/page.h"
#include "report/pictures/page_picture.h"

/* What a curve runs along: the vertical strain where it is known and changes, else time, else the number. */
struct abscissa {
    enum { ALONG_STRAIN, ALONG_TIME, ALONG_INDEX } kind;
    const char *label;
};

/* The same for all curves of a page, so that they can be laid over each other: the strain as soon as one state has
 * one other than 0, time only when every row knows its time. */
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

/* Where a row stands along the abscissa; NaN (left out of charts): a row without packing has no strain. */
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

/* The first of the rows with most methods: it tells whether the stresses are Pa. The series has a row. */
static const struct series_row *row_with_most_methods(const struct series *series)
{
    const struct series_row *most = &series->rows[0];
    for (size_t k = 1; k < series->count; k++)
        if (series->rows[k].packing.force_count > most->packing.force_count)
            most = &series->rows[k];
    return most;
}

/* Points of every chart of the page. */
static const double WIDTH = 640, HEIGHT = 400;

/* For struct picture: `chart` is a struct chart. Never fails. */
static int draw_chart(struct canvas *canvas, const void *chart)
{
    chart_draw(chart, canvas, WIDTH, HEIGHT);
    return 0;
}

int page_chart(const struct chart *chart, struct html *html)
{
    struct picture picture = {chart->title, WIDTH, HEIGHT, draw_chart, chart};
    return chart_is_empty(chart) ? 0 : picture_put(&picture, CANVAS_SVG, html);
}

/* Lines of a chart have room for so many methods, twice each, and the applied stress. */
enum { CURVES_MOST = 5 };

/* One line for yy; for xx the same style, dashed. method: NULL: the applied stress. */
static int stress_line(const struct series *series, const struct abscissa *abscissa, struct chart *chart,
                       const char *method, size_t style, int axis)
{
    struct chart_line *line = chart_add(chart, method ? method : "applied", series->count);
    if (!line)
        return -1;
    line->style = style;
    line->open = !method;
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

/* Applied stress and Weber's by every method along the abscissa. yy is drawn first, xx over it in the same style,
 * dashed: one entry of the key for both. */
static int stress_chart(const struct series *series, const struct abscissa *abscissa, struct html *html)
{
    const struct series_row *most = row_with_most_methods(series);
    struct chart chart = {.title = "Stress, applied and from forces (Weber): yy solid, xx dashed",
                          .x_label = abscissa->label,
                          .y_label = most->packing.in_pascal ? "stress (kPa)" : "stress (N/m)",
                          .from_zero = 1,
                          .whole_x = abscissa->kind == ALONG_INDEX};
    int result = 0;
    for (int axis = 1; axis >= 0 && result == 0; axis--)
        for (size_t m = 0; m < series->methods.count && m < CURVES_MOST && result == 0; m++)
            result = stress_line(series, abscissa, &chart, series->methods.list[m].name, m + 1, axis);
    for (int axis = 1; axis >= 0 && result == 0; axis--) /* last: on top of what may be the same */
        result = stress_line(series, abscissa, &chart, NULL, 0, axis);
    if (result == 0)
        result = page_chart(&chart, html);
    chart_free(&chart);
    return result;
}

/* One number of a row; NaN, which a chart leaves out, where the row has no packing. */
typedef double (*quantity)(const struct series_row *row);

/* Area of voids over area of grains. */
static double void_ratio(const struct series_row *row)
{
    return row->packing.path ? row->packing.fabric.void_ratio : NAN;
}

/* Mean number of contacts per grain (pipeline/packing/structure.h). */
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

/* h: how many contact forces equilibrium leaves open. */
static double freedom(const struct series_row *row)
{
    return row->packing.path ? row->packing.h : NAN;
}

/* A chart of up to two quantities; the second is NULL when there is one only, and so is its name. */
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

/* ---- oedometer: compressed along y, held along x ---- */

/* Whether the series looks like an oedometer test: compressed along y by more than 1e-5, everything else (xx and the
 * shear) below a tenth of that. Strains that are not known do not speak against it. */
static int is_oedometer(const struct series *series)
{
    double across = 0, along_y = 0;
    for (size_t k = 0; k < series->count; k++) {
        const double *strain = series->rows[k].packing.strain;
        if (!series->rows[k].packing.path || !isfinite(strain[0]) || !isfinite(strain[1]))
            continue;
        across = fmax(across, fmax(fabs(strain[0]), isfinite(strain[2]) ? fabs(strain[2]) : 0));
        along_y = fmax(along_y, fabs(strain[1]));
    }
    return along_y > 1e-5 && across < 0.1 * along_y;
}

/* Stresses of a row: of that method, or applied (method NULL); NULL: not there. */
static const double (*stress_of(const struct series_row *row, const char *method))[2]
{
    const struct force_summary *forces = method ? forces_of(row, method) : NULL;
    return !row->packing.path || (method && !forces) ? NULL : method ? forces->weber : row->packing.applied;
}

/* Coefficient of earth pressure at rest k0 = sigma_xx / sigma_yy (thesis Fig. 4.14), and the oedometric curve, void
 * ratio against the logarithm of sigma_yy (Fig. 4.15). */
static int oedometer_lines(const struct series *series, const struct abscissa *abscissa, const char *method,
                           size_t style, struct chart *k0, struct chart *curve)
{
    struct chart_line *ratio = chart_add(k0, method ? method : "applied", series->count),
                      *voids = ratio ? chart_add(curve, method ? method : "applied", series->count) : NULL;
    if (!voids)
        return -1;
    ratio->style = voids->style = style;
    ratio->open = voids->open = !method;
    for (size_t k = 0; k < series->count; k++) {
        const struct series_row *row = &series->rows[k];
        const double(*sigma)[2] = stress_of(row, method);
        if (!sigma)
            continue;
        chart_put(ratio, along(abscissa, row), sigma[0][0] / sigma[1][1]);
        chart_put(voids, log10(sigma[1][1] * (row->packing.in_pascal ? 1e-3 : 1)), row->packing.fabric.void_ratio);
    }
    return 0;
}

/* k0 along the abscissa and the oedometric curve, by every method (at most CURVES_MOST) and as applied. */
static int oedometer_charts(const struct series *series, const struct abscissa *abscissa, struct html *html)
{
    const struct series_row *most = row_with_most_methods(series);
    struct chart k0 = {.title = "Earth pressure at rest, k0",
                       .x_label = abscissa->label,
                       .y_label = "σxx / σyy",
                       .from_zero = 1,
                       .whole_x = abscissa->kind == ALONG_INDEX},
                 curve = {.title = "Oedometric curve",
                          .y_label = "void ratio",
                          .x_label = most->packing.in_pascal ? "log10 of σyy in kPa" : "log10 of σyy in N/m"};
    int result = 0;
    for (size_t m = 0; m < series->methods.count && m < CURVES_MOST && result == 0; m++)
        result = oedometer_lines(series, abscissa, series->methods.list[m].name, m + 1, &k0, &curve);
    if (result == 0)
        result = oedometer_lines(series, abscissa, NULL, 0, &k0, &curve);
    if (result == 0)
        result = page_chart(&k0, html) || page_chart(&curve, html) ? -1 : 0;
    chart_free(&k0);
    chart_free(&curve);
    return result;
}

int page_curves(const struct series *series, struct html *html)
{
    struct abscissa abscissa = choose_abscissa(series);
    static const quantity voids[2] = {void_ratio, NULL}, contacts[2] = {coordination, NULL},
                          fabric[2] = {anisotropy, NULL}, open[2] = {freedom, NULL};
    static const char *const e[2] = {"void ratio"}, *const z[2] = {"z"}, *const a[2] = {"anisotropy"},
                             *const h[2] = {"h"};
    if (series->count < 2)
        return 0;
    fputs("<h2>Curves</h2>\n<div class=\"charts\">\n", html->stream);
    if (stress_chart(series, &abscissa, html) || page_persistence(series, html) ||
        quantity_chart(series, &abscissa, "Void ratio", "e", voids, e, html) ||
        quantity_chart(series, &abscissa, "Coordination number", "z", contacts, z, html) ||
        quantity_chart(series, &abscissa, "Anisotropy of contact directions", "|F1 - F2| of ⟨n n⟩", fabric, a, html) ||
        quantity_chart(series, &abscissa, "Degree of indeterminacy", "h", open, h, html) ||
        (is_oedometer(series) && oedometer_charts(series, &abscissa, html)))
        return -1;
    fputs("</div>\n", html->stream);
    return 0;
}
