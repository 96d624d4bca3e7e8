/* One state's forces as a whole: what they leave unbalanced on the grains, and the stress that they make on planes. */
#include <math.h>
#include <stdlib.h>

#include "pipeline/speak/error.h"
#include "report/page/page.h"

/* Sizes of the unbalanced forces over <fn>, to be freed; NULL when the file has none. */
static int imbalances(const struct forces *forces, double **sizes)
{
    const struct residuals *r = &forces->residual;
    double sum = 0;
    size_t loaded = 0;
    *sizes = NULL;
    if (!r->residual_x || !r->residual_y)
        return 0;
    *sizes = malloc((r->count + 1) * sizeof **sizes);
    if (!*sizes)
        return error_memory("a chart");
    for (size_t c = 0; c < forces->contact.count; c++)
        if (forces->contact.fn[c] > 0) {
            sum += forces->contact.fn[c];
            loaded++;
        }
    for (size_t k = 0; k < r->count; k++)
        (*sizes)[k] = hypot(r->residual_x[k], r->residual_y[k]) / (sum / (double)loaded);
    return 0;
}

/* Thesis Fig. 4.41: how far the grains are from equilibrium. */
static int imbalance_chart(const struct series *series, const struct packing *packing, struct html *html)
{
    struct chart chart = {.title = "Unbalanced force on the grains",
                          .x_label = "grains below (%)",
                          .y_label = "unbalanced force / ⟨fn⟩",
                          .log_y = 1};
    int result = 0;
    for (size_t f = 0; f < packing->force_count && f < CHART_LINES && result == 0; f++) {
        const struct forces *forces = &packing->forces[f];
        double *sizes;
        size_t lines = chart.count;
        result = imbalances(forces, &sizes) ||
                         page_put_quantiles(&chart, forces->method, sizes, NULL, forces->residual.count, 1)
                     ? -1
                     : 0;
        free(sizes);
        if (chart.count > lines)
            chart.lines[lines].style = series_style(series, forces->method);
    }
    if (result == 0)
        result = page_chart(&chart, html);
    chart_free(&chart);
    return result;
}

/* Normal stress n.sigma.n on the plane whose normal has that angle (thesis eq. 4.2, Fig. 4.24), for 0 to 180 degrees.
 */
static int stress_line(struct chart *chart, const char *name, size_t style, const double sigma[2][2], double unit)
{
    enum { STEPS = 36 };
    struct chart_line *line = chart_add(chart, name, STEPS + 1);
    if (!line)
        return -1;
    line->style = style;
    for (int k = 0; k <= STEPS; k++) {
        double angle = M_PI * k / STEPS, x = cos(angle), y = sin(angle);
        chart_put(line, 180.0 * k / STEPS,
                  unit * (x * x * sigma[0][0] + x * y * (sigma[0][1] + sigma[1][0]) + y * y * sigma[1][1]));
    }
    return 0;
}

/* Loads on walls say the normal stresses; the shear stress depends on where along the walls they push. */
static int applied_points(struct chart *chart, const double sigma[2][2], double unit)
{
    struct chart_line *line = chart_add(chart, "applied", 2);
    if (!line)
        return -1;
    line->open = line->unjoined = 1;
    chart_put(line, 0, unit * sigma[0][0]);
    chart_put(line, 90, unit * sigma[1][1]);
    return 0;
}

/* Normal stress against the direction of the plane, one line per method and two points for what is applied. kPa
 * where the length of the rods is known, else N/m (force over length of an edge). */
static int plane_chart(const struct series *series, const struct packing_summary *summary, struct html *html)
{
    struct chart chart = {.title = "Normal stress by orientation of the plane",
                          .x_label = "angle of the plane's normal (degrees)",
                          .y_label = summary->in_pascal ? "normal stress (kPa)" : "normal stress (N/m)",
                          .from_zero = 1,
                          .x_to = 180,
                          .x_step = 30};
    double unit = summary->in_pascal ? 1e-3 : 1;
    int result = 0;
    for (size_t f = 0; f < summary->force_count && f + 1 < CHART_LINES && result == 0; f++)
        result = stress_line(&chart, summary->forces[f].method, series_style(series, summary->forces[f].method),
                             summary->forces[f].weber, unit);
    if (result == 0)
        result = applied_points(&chart, summary->applied, unit) || page_chart(&chart, html) ? -1 : 0;
    chart_free(&chart);
    return result;
}

int page_balance(const struct series *series, const struct packing *packing, const struct packing_summary *summary,
                 struct html *html)
{
    if (packing->force_count == 0)
        return 0;
    return imbalance_chart(series, packing, html) || plane_chart(series, summary, html) ? -1 : 0;
}
