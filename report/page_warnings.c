/* What a reader must know first. Limits are generous: a warning is worth a look, not a verdict. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "report/page.h"

static const double FLAGGED_SHARE = 0.05, ZNCC_LOW = 0.9, STRESS_MISFIT = 0.10, IMBALANCE = 0.05;

struct warnings {
    struct html *html;
    int count;
};

static void warn(struct warnings *warnings, const char *text)
{
    if (warnings->count++ == 0)
        fputs("<h2>Warnings</h2>\n<div class=\"warn\"><ul>\n", warnings->html->stream);
    fputs("<li>", warnings->html->stream);
    html_text(warnings->html, text);
    fputs("</li>\n", warnings->html->stream);
}

static void warn_photo(struct warnings *warnings, const struct series_row *row, const struct photo_summary *photo,
                       const char *what)
{
    char text[300];
    if (!photo->path)
        return;
    if ((double)photo->distrusted > FLAGGED_SHARE * (double)photo->grains) {
        snprintf(text, sizeof text, "%.100s, %s: %zu of %zu grains are flagged as not to be trusted", row->name, what,
                 photo->distrusted, photo->grains);
        warn(warnings, text);
    }
    if (photo->zncc_median < ZNCC_LOW) {
        snprintf(text, sizeof text, "%.100s: the photo looks little like the reference (median ZNCC %.3f)", row->name,
                 photo->zncc_median);
        warn(warnings, text);
    }
}

static void warn_stress(struct warnings *warnings, const struct series_row *row, const struct force_summary *forces,
                        int axis)
{
    char text[300];
    double applied = row->packing.applied[axis][axis], weber = forces->weber[axis][axis];
    if (!(fabs(weber - applied) > STRESS_MISFIT * fabs(applied)))
        return;
    snprintf(text, sizeof text, "%.100s, %.15s: Weber stress %s is %+.0f %% off the applied one", row->name,
             forces->method, axis ? "yy" : "xx", 100 * (weber / applied - 1));
    warn(warnings, text);
}

static void warn_forces(struct warnings *warnings, const struct series_row *row, const struct force_summary *forces)
{
    char text[300];
    if (!forces->converged) {
        snprintf(text, sizeof text, "%.100s, %.15s: not converged after %d iterations", row->name, forces->method,
                 forces->iterations);
        warn(warnings, text);
    }
    if (forces->imbalance > IMBALANCE) {
        snprintf(text, sizeof text,
                 "%.100s, %.15s: forces leave up to %.2g of the mean normal force unbalanced on a "
                 "grain",
                 row->name, forces->method, forces->imbalance);
        warn(warnings, text);
    }
    warn_stress(warnings, row, forces, 0);
    warn_stress(warnings, row, forces, 1);
}

static void warn_packing(struct warnings *warnings, const struct series_row *row)
{
    char text[300];
    if (!row->packing.path)
        return;
    if (row->packing.flags[19]) {
        snprintf(text, sizeof text, "%.100s: %zu grains float: a contact was missed there", row->name,
                 row->packing.flags[19]);
        warn(warnings, text);
    }
    for (size_t f = 0; f < row->packing.force_count; f++)
        warn_forces(warnings, row, &row->packing.forces[f]);
}

static void warn_gaps(struct warnings *warnings, const struct series *series)
{
    char text[300];
    for (size_t k = 1; k < series->count; k++) {
        int64_t before = series->rows[k - 1].index, now = series->rows[k].index;
        if (before < 0 || now <= before + 1)
            continue;
        snprintf(text, sizeof text, "photos %lld to %lld are missing in the series", (long long)before + 1,
                 (long long)now - 1);
        warn(warnings, text);
    }
}

void page_warnings(const struct series *series, struct html *html)
{
    struct warnings warnings = {html, 0};
    warn_gaps(&warnings, series);
    for (size_t k = 0; k < series->count; k++) {
        const struct series_row *row = &series->rows[k];
        warn_photo(&warnings, row, &row->grains, "found");
        warn_photo(&warnings, row, &row->tracks, "tracked");
        warn_packing(&warnings, row);
    }
    if (warnings.count)
        fputs("</ul></div>\n", html->stream);
    else
        fputs(
            "<div class=\"good\"><p>Nothing to warn of: no more than 5 % of the grains flagged in any photo, ZNCC "
            "above "
            "0.9, every method converged, Weber stress within 10 % of the applied one where that is known.</p></div>\n",
            html->stream);
}
