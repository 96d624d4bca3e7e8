/* The series against a truth, where there is one: virtual tests. Photo-side files are compared with
 * NAME.photo-truth.hdf (what the photo shows), packings with NAME.truth.hdf (what the simulation knows). Motions are
 * compared since the photo in which the grains were found, whose truth gives the positions from which both began. */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "pipeline/speak/error.h"
#include "pipeline/packing/packing_file.h"
#include "report/compare/compare.h"
#include "report/page/page.h"

/* FOLDER/NAME.KIND.hdf, the names that simulate and render give; to be freed; NULL with an error. */
static char *truth_path(const struct page *page, const struct series_row *row, const char *kind)
{
    char *path = NULL;
    if (asprintf(&path, "%s/%s.%s.hdf", page->truth_folder, row->name, kind) < 0) {
        (void)error_memory("a path");
        return NULL;
    }
    return path;
}

/* Compare one photo-side file with its truth; b0: the truth of the reference, or NULL. */
static int compare_one(const struct page *page, const struct series_row *row, const char *path, const char *b0_path,
                       struct figures *figures)
{
    struct loaded a = {0}, b = {0}, b0 = {0};
    char *truth = truth_path(page, row, "photo-truth");
    int result =
        !truth || loaded_read(path, &a) || loaded_read(truth, &b) || (b0_path && loaded_read(b0_path, &b0)) ? -1 : 0;
    if (result == 0) {
        struct compare_photo pair = {.a = &a.grains, .b = &b.grains, .a_is_seen = !strcmp(a.info.coordinates, "seen")};
        pair.b0 = b0_path ? &b0.grains : NULL;
        result = compare_photo(&pair, figures);
    }
    free(truth);
    loaded_free(&a);
    loaded_free(&b);
    loaded_free(&b0);
    return result;
}

/* A cell for each of the NULL-terminated names, a dash where the comparison has no such figure. */
static void cells(struct html *html, const struct figures *figures, const char *const names[], int digits)
{
    for (; *names; names++)
        html_number(html, figures_value(figures, *names), digits);
}

/* A row of figures per photo that has a file of findgrains (b0_path NULL) or of the tracker. */
static int photo_table(const struct page *page, const struct series *series, const char *heading,
                       const char *const names[], const char *b0_path, struct html *html)
{
    fprintf(html->stream, "<div class=\"table\"><table><tr><th class=\"left\">photo</th>%s</tr>\n", heading);
    for (size_t k = 0; k < series->count; k++) {
        const struct series_row *row = &series->rows[k];
        const char *path = b0_path ? row->tracks.path : row->grains.path;
        struct figures figures = {.count = 0};
        if (!path)
            continue;
        if (compare_one(page, row, path, b0_path, &figures))
            return -1;
        fputs("<tr>", html->stream);
        html_cell(html, row->name);
        cells(html, &figures, names, 3);
        fputs("</tr>\n", html->stream);
    }
    fputs("</table></div>\n", html->stream);
    return 0;
}

/* What findgrains found against what each photo shows: grains found, missed and invented, errors of centres and
 * radii, and those errors over their standard errors. */
static int found_table(const struct page *page, const struct series *series, struct html *html)
{
    static const char *const names[] = {"found",         "missed",      "false",         "flagged",
                                        "centre_rms_px", "centre_pull", "radius_rms_px", "radius_bias_px",
                                        "radius_pull",   NULL};
    return photo_table(page, series,
                       "<th>found</th><th>missed</th><th>false</th><th>flagged</th><th>centre RMS<br>px</th>"
                       "<th>error / s</th><th>radius RMS<br>px</th><th>radius bias<br>px</th><th>error / s</th>",
                       names, NULL, html);
}

/* The truth of the photo in which grains were found: there the tracks began. */
static char *reference_truth(const struct page *page, const struct series *series)
{
    for (size_t k = 0; k < series->count; k++)
        if (series->rows[k].grains.path)
            return truth_path(page, &series->rows[k], "photo-truth");
    (void)error_input("no file of findgrains is given: the truth of the reference photo is not known");
    return NULL;
}

/* What the tracker followed against where the grains are: displacements in px, rotations in degrees, and both over
 * their standard errors. -1 with an error also when the truth of the reference is not known. */
static int motion_table(const struct page *page, const struct series *series, struct html *html)
{
    static const char *const names[] = {"motion_compared",     "motion_flagged",    "displacement_rms_px",
                                        "displacement_max_px", "displacement_pull", "rotation_rms_deg",
                                        "rotation_max_deg",    "rotation_pull",     NULL};
    char *b0 = reference_truth(page, series);
    int result =
        b0 ? photo_table(page, series,
                         "<th>tracked</th><th>flagged</th><th>displacement RMS<br>px</th><th>largest<br>px</th>"
                         "<th>error / s</th><th>rotation RMS<br>deg</th><th>largest<br>deg</th>"
                         "<th>error / s</th>",
                         names, b0, html)
           : -1;
    free(b0);
    return result;
}

/* A row of the table of forces: one method in one state. */
static void force_row(const struct series_row *row, const char *method, const struct figures *figures,
                      struct html *html)
{
    static const char *const names[] = {"contact_precision", "contact_recall", "contact_f1",  "r_fn",        "r_ft",
                                        "r_fn_all",          "dist_over_fn",   "mean_fn_a_N", "mean_fn_b_N", NULL};
    fputs("<tr>", html->stream);
    html_cell(html, row->name);
    html_cell(html, method);
    cells(html, figures, names, 3);
    fputs("</tr>\n", html->stream);
}

/* The forces of one state by every method that it has. The truth's forces are those of the simulation, "dem"; a
 * truth from elsewhere speaks by its default method. */
static int compare_state(const struct page *page, const struct series_row *row, struct html *html)
{
    struct packing a = {0}, b = {0};
    char *truth = truth_path(page, row, "truth");
    int result = !truth || packing_read(row->packing.path, &a) || packing_read(truth, &b) ? -1 : 0;
    for (size_t f = 0; f < a.force_count && result == 0; f++) {
        struct figures figures = {.count = 0};
        result = compare_packings(&a, &b, a.forces[f].method, packing_forces(&b, "dem") ? "dem" : NULL, &figures);
        if (result == 0)
            force_row(row, a.forces[f].method, &figures, html);
    }
    free(truth);
    packing_free(&a);
    packing_free(&b);
    return result;
}

/* All states that have a packing, each by every method. */
static int force_table(const struct page *page, const struct series *series, struct html *html)
{
    fputs("<div class=\"table\"><table><tr><th class=\"left\">state</th><th class=\"left\">method</th>"
          "<th>precision</th><th>recall</th><th>F1</th><th>r(fn)</th><th>r(ft)</th><th>r(fn)<br>all contacts</th>"
          "<th>dist / ⟨fn⟩</th><th>⟨fn⟩<br>N</th><th>true ⟨fn⟩<br>N</th></tr>\n",
          html->stream);
    for (size_t k = 0; k < series->count; k++)
        if (series->rows[k].packing.path && compare_state(page, &series->rows[k], html))
            return -1;
    fputs("</table></div>\n", html->stream);
    return 0;
}

/* Errors of fn of the last state: the value below which so many contacts lie. */
static int error_chart(const struct series *series, const struct packing *a, const struct packing *b, struct html *html)
{
    struct chart chart = {.title = "Last state: error of the normal forces",
                          .x_label = "contacts below (%)",
                          .y_label = "|fn - true fn| / ⟨fn⟩",
                          .log_y = 1};
    int result = 0;
    for (size_t f = 0; f < a->force_count && f < CHART_LINES && result == 0; f++) {
        double *errors;
        size_t count, lines = chart.count;
        result =
            compare_force_errors(a, b, a->forces[f].method, packing_forces(b, "dem") ? "dem" : NULL, &errors, &count) ||
                    page_put_quantiles(&chart, a->forces[f].method, errors, NULL, count, 1)
                ? -1
                : 0;
        free(errors);
        if (chart.count > lines)
            chart.lines[lines].style = series_style(series, a->forces[f].method);
    }
    if (result == 0)
        result = page_chart(&chart, html);
    chart_free(&chart);
    return result;
}

/* The chart of errors for the last state that has forces; nothing when none has. */
static int last_errors(const struct page *page, const struct series *series, struct html *html)
{
    const struct series_row *last = NULL;
    struct packing a = {0}, b = {0};
    for (size_t k = 0; k < series->count; k++)
        if (series->rows[k].packing.force_count)
            last = &series->rows[k];
    if (!last)
        return 0;
    char *truth = truth_path(page, last, "truth");
    int result = !truth || packing_read(last->packing.path, &a) || packing_read(truth, &b) ? -1 : 0;
    if (result == 0) {
        fputs("<div class=\"charts\">\n", html->stream);
        result = error_chart(series, &a, &b, html);
        fputs("</div>\n", html->stream);
    }
    free(truth);
    packing_free(&a);
    packing_free(&b);
    return result;
}

int page_truth(const struct page *page, const struct series *series, struct html *html)
{
    int found = 0, tracked = 0, forces = 0;
    for (size_t k = 0; k < series->count; k++) {
        found |= series->rows[k].grains.path != NULL;
        tracked |= series->rows[k].tracks.path != NULL;
        forces |= series->rows[k].packing.path != NULL;
    }
    fputs("<h2>Against the truth</h2>\n<p class=\"small\">Error / s: root mean square of the error over its standard "
          "error; 1 when standard errors are honest.</p>\n",
          html->stream);
    if ((found && found_table(page, series, html)) || (found && tracked && motion_table(page, series, html)) ||
        (forces && (force_table(page, series, html) || last_errors(page, series, html))))
        return -1;
    return 0;
}
