/* Forces between states, and the last state's contacts: distribution and directions. Persistence is Pearson's r between
 * the forces of two neighbouring states over the contacts that both have: near 1 while the network holds, low where it
 * was rearranged. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "report/compare/compare.h"
#include "report/page/page.h"
#include "report/pictures/page_picture.h"
#include "report/pictures/rose.h"
#include "pipeline/packing/packing_file.h"

/* ---- persistence (thesis Fig. 4.28) ---- */

/* Forces of that method in two files of neighbouring states: r of fn and of ft over the contacts that stay. */
static int persistence(const char *before_path, const char *now_path, const char *method, double r[2])
{
    struct packing before = {0}, now = {0};
    struct figures figures = {.count = 0};
    int result = packing_read(before_path, &before) || packing_read(now_path, &now) ? -1 : 0;
    r[0] = r[1] = NAN;
    if (result == 0 && packing_forces(&before, method) && packing_forces(&now, method)) {
        result = compare_packings(&now, &before, method, method, &figures);
        r[0] = figures_value(&figures, "r_fn");
        r[1] = figures_value(&figures, "r_ft");
    }
    packing_free(&before);
    packing_free(&now);
    return result;
}

/* Two lines of a chart for one method, r of fn and of ft against the number of the photo. Neighbours are the states
 * that have forces: one without is passed over. A state that lacks this method gives NaN, which a chart leaves out. */
static int persistence_lines(const struct series *series, struct chart *chart, const char *method, size_t style)
{
    const struct series_row *before = NULL;
    struct chart_line *fn = chart_add(chart, method, series->count);
    struct chart_line *ft = fn ? chart_add(chart, method, series->count) : NULL;
    if (!ft)
        return -1;
    fn->style = ft->style = style;
    ft->dashed = ft->without_key = 1;
    for (size_t k = 0; k < series->count; k++) {
        const struct series_row *row = &series->rows[k];
        double r[2];
        if (!row->packing.force_count)
            continue;
        if (before && persistence(before->packing.path, row->packing.path, method, r))
            return -1;
        if (before) {
            chart_put(fn, (double)row->index, r[0]);
            chart_put(ft, (double)row->index, r[1]);
        }
        before = row;
    }
    return 0;
}

int page_persistence(const struct series *series, struct html *html)
{
    struct chart chart = {.title = "Pearson r with the forces of the state before: fn solid, ft dashed",
                          .x_label = "photo",
                          .y_label = "r",
                          .whole_x = 1};
    int result = 0;
    for (size_t m = 0; m < series->methods.count && chart.count + 2 <= CHART_LINES && result == 0; m++)
        if (series->methods.list[m].states > 1)
            result = persistence_lines(series, &chart, series->methods.list[m].name, m + 1);
    if (result == 0)
        result = page_chart(&chart, html);
    chart_free(&chart);
    return result;
}

/* ---- the last state ---- */

/* Probability density of fn / <fn>, one line per method, at the middles of the bins. Logarithmic: an exponential
 * tail, the usual one of dense packings, is a straight line. */
static int distribution_chart(const struct series *series, const struct packing *packing, struct html *html)
{
    struct chart chart = {
        .title = "Distribution of normal forces", .x_label = "fn / ⟨fn⟩", .y_label = "probability density", .log_y = 1};
    int result = 0;
    for (size_t f = 0; f < packing->force_count && f < CHART_LINES && result == 0; f++) {
        double density[DISTRIBUTION_BINS];
        struct chart_line *line = chart_add(&chart, packing->forces[f].method, DISTRIBUTION_BINS);
        if (!line) {
            result = -1;
            break;
        }
        line->style = series_style(series, packing->forces[f].method);
        force_distribution(&packing->forces[f], density);
        for (int b = 0; b < DISTRIBUTION_BINS; b++)
            chart_put(line, DISTRIBUTION_STEP * (b + 0.5), density[b]);
    }
    if (result == 0)
        result = page_chart(&chart, html);
    chart_free(&chart);
    return result;
}

/* What draw_rose() draws: the share of contacts per direction, and over it one outline per method. */
struct rose {
    const char *title;
    double share[ROSE_BINS];
    struct rose_outline outlines[SERIES_METHODS];
    size_t count;
};

/* Points of the vector picture. */
static const double ROSE_WIDTH = 640, ROSE_HEIGHT = 420;

/* For struct picture: `what` is a struct rose. Never fails. */
static int draw_rose(struct canvas *canvas, const void *what)
{
    const struct rose *rose = what;
    rose_draw(canvas, ROSE_WIDTH, ROSE_HEIGHT, rose->title, rose->share, rose->outlines, rose->count);
    return 0;
}

/* The rose of one packing with the mean normal force of each direction, by every method that it has, at most
 * SERIES_METHODS; the shares are the same whichever method speaks. */
static int rose_picture(const struct series *series, const struct packing *packing, struct html *html)
{
    const char *title =
        packing->force_count ? "Contact directions, and mean normal force of each" : "Contact directions";
    struct rose rose = {.title = title};
    struct picture picture = {title, ROSE_WIDTH, ROSE_HEIGHT, draw_rose, &rose};
    contact_rose(packing, NULL, rose.share, NULL);
    for (size_t f = 0; f < packing->force_count && rose.count < SERIES_METHODS; f++) {
        struct rose_outline *outline = &rose.outlines[rose.count++];
        memcpy(outline->name, packing->forces[f].method, NAME_LENGTH);
        outline->style = series_style(series, outline->name);
        contact_rose(packing, &packing->forces[f], rose.share, outline->mean_fn);
    }
    return picture_put(&picture, CANVAS_SVG, html);
}

int page_last_state(const struct series *series, struct html *html)
{
    const struct series_row *last = NULL;
    struct packing packing;
    for (size_t k = 0; k < series->count; k++)
        if (series->rows[k].packing.path && series->rows[k].packing.fabric.contacts)
            last = &series->rows[k];
    if (!last)
        return 0;
    if (packing_read(last->packing.path, &packing))
        return -1;
    fputs("<h2>Contacts of ", html->stream);
    html_text(html, last->name);
    fputs("</h2>\n<div class=\"charts\">\n", html->stream);
    int result = distribution_chart(series, &packing, html) || page_balance(series, &packing, &last->packing, html) ||
                         rose_picture(series, &packing, html)
                     ? -1
                     : 0;
    fputs("</div>\n", html->stream);
    packing_free(&packing);
    return result;
}
