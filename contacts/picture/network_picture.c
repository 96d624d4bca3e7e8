/* Grains that touch overlap by what squeezes them, others have gaps: with right radii the histogram rises steeply at
 * zero. Radii that are wrong by d move the edge by 2 d, errors of positions and radii blur it. The fitted density is
 * that of contacts/radii/pair_statistics.h: squeezed pairs above zero, gaps below it, each with its measured error. */
#include "contacts/picture/network_picture.h"

#include <stdio.h>

#include "pipeline/draw/chart.h"

/* Styles of the chart: orange, sky blue, blue, vermillion. */
enum { ORANGE = 3, SKY = 5, BLUE = 0, VERMILLION = 1 };

/* Bars stand on the axis, so that those of pairs that can be squeezed hide the lower part of those of all pairs. */
static int add_bars(struct chart *chart, const struct overlap_histogram *histogram)
{
    struct chart_line *all = chart_add(chart, "one is free", HISTOGRAM_BINS);
    struct chart_line *bearing = all ? chart_add(chart, "both grains can be squeezed", HISTOGRAM_BINS) : NULL;
    if (!bearing)
        return -1;
    all->style = ORANGE, bearing->style = SKY;
    all->bars = bearing->bars = histogram->width_px;
    for (int b = 0; b < HISTOGRAM_BINS; b++) {
        double x = histogram->low_px + (b + 0.5) * histogram->width_px;
        chart_put(all, x, histogram->bearing[b] + histogram->idle[b]);
        chart_put(bearing, x, histogram->bearing[b]);
    }
    return 0;
}

/* The density that was fitted, and a line at zero: contacts on its right, gaps on its left. */
static int add_lines(struct chart *chart, const struct overlap_histogram *histogram)
{
    struct chart_line *fit = chart_add(chart, "fitted density", HISTOGRAM_BINS);
    struct chart_line *zero = fit ? chart_add(chart, "touching", 2) : NULL;
    double most = 0;
    if (!zero)
        return -1;
    fit->style = BLUE, zero->style = VERMILLION;
    fit->unmarked = zero->unmarked = zero->dashed = 1;
    for (int b = 0; b < HISTOGRAM_BINS; b++) {
        double density = histogram->fit_bearing[b] + histogram->fit_idle[b];
        chart_put(fit, histogram->low_px + (b + 0.5) * histogram->width_px, density);
        most = fmax(most, fmax(density, histogram->bearing[b] + histogram->idle[b]));
    }
    chart_put(zero, 0, 0);
    chart_put(zero, 0, most);
    return 0;
}

static void describe_radii(const struct contact_summary *summary, char *text, size_t size)
{
    if (summary->undecided)
        snprintf(text, size, "Radii as given: %s", summary->undecided);
    else if (summary->doubt)
        snprintf(text, size, "Doubtful: %s", summary->doubt);
    else if (summary->s_radius_scale > 0)
        snprintf(text, size, "Radii times %.6f ± %.6f, found here", summary->radius_scale, summary->s_radius_scale);
    else if (summary->s_radius_offset_px > 0)
        snprintf(text, size, "Radii %+.4f ± %.4f px, found here", summary->radius_offset_px,
                 summary->s_radius_offset_px);
    else
        snprintf(text, size, "Radii times %.6g %+.4g px, as given", summary->radius_scale, summary->radius_offset_px);
}

int overlap_picture(const char *path, const struct contact_summary *summary)
{
    const struct overlap_histogram *histogram = &summary->histogram;
    char title[200], y_label[64];
    struct chart chart = {
        .title = title, .x_label = "overlap, px (below zero: gaps)", .y_label = y_label, .from_zero = 1};
    describe_radii(summary, title, sizeof title);
    snprintf(y_label, sizeof y_label, "pairs of grains per %.3g px", histogram->width_px);
    int status = histogram->width_px > 0 && (add_bars(&chart, histogram) || add_lines(&chart, histogram)) ? -1 : 0;
    if (!status)
        status = chart_write(path, &chart, 1, 720, 420);
    chart_free(&chart);
    return status;
}
