/* What a reader must know first. Limits are generous: a warning is worth a look, not a verdict. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "pipeline/scene/scene.h"
#include "pipeline/packing/limits.h"
#include "pipeline/speak/error.h"
#include "report/page/page.h"

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

/* How often something is beyond its limit, and where it is worst. */
struct tally {
    size_t seen, beyond;
    double worst;
    const char *where;
};

static void tally_add(struct tally *tally, double size, double limit, const char *where)
{
    if (isnan(size))
        return;
    tally->seen++;
    if (!(size > limit))
        return;
    if (tally->beyond++ == 0 || size > tally->worst) {
        tally->worst = size;
        tally->where = where;
    }
}

/* 0.0123456 -> 0.0123, but whole numbers stay whole. */
static double round_to_three(double value)
{
    double power = pow(10, 2 - floor(log10(value)));
    return value >= 100 || !(value > 0) ? value : round(value * power) / power;
}

static void warn_tally(struct warnings *warnings, const struct tally *tally, const char *who, const char *what,
                       double unit, const char *units)
{
    char text[400];
    if (tally->beyond == 0)
        return;
    snprintf(text, sizeof text, "%.15s: in %zu of %zu %s (worst %.6g%s, %.100s)", who, tally->beyond, tally->seen, what,
             round_to_three(unit * tally->worst), units, tally->where);
    warn(warnings, text);
}

static void warn_photos(struct warnings *warnings, const struct series *series, int tracked)
{
    struct tally flagged = {0}, zncc = {0};
    for (size_t k = 0; k < series->count; k++) {
        const struct series_row *row = &series->rows[k];
        const struct photo_summary *photo = tracked ? &row->tracks : &row->grains;
        if (!photo->path)
            continue;
        tally_add(&flagged, (double)photo->distrusted / (double)photo->grains, LIMIT_FLAGGED, row->name);
        tally_add(&zncc, 1 - photo->zncc.middle, 1 - LIMIT_ZNCC, row->name);
    }
    const char *who = tracked ? "tracking" : "finding grains";
    warn_tally(warnings, &flagged, who, "photos more than 5 % of the grains are flagged as not to be trusted", 100,
               " %");
    warn_tally(warnings, &zncc, who, "photos the grains look little like the reference, 1 - median ZNCC above 0.1", 1,
               "");
}

static void warn_method(struct warnings *warnings, const struct series *series, const char *method)
{
    struct tally open = {0}, imbalance = {0}, impossible = {0}, data = {0}, misfit[2] = {{0}, {0}};
    for (size_t k = 0; k < series->count; k++) {
        const struct packing_summary *packing = &series->rows[k].packing;
        for (size_t f = 0; f < packing->force_count; f++) {
            const struct force_summary *forces = &packing->forces[f];
            if (strncmp(forces->method, method, NAME_LENGTH))
                continue;
            if (forces->iterations > 0) { /* else a method that seeks no equilibrium */
                tally_add(&open, forces->converged ? 0 : forces->iterations, 0, series->rows[k].name);
                tally_add(&imbalance, forces->imbalance, LIMIT_IMBALANCE, series->rows[k].name);
            }
            tally_add(&impossible, forces->infeasible ? forces->imbalance : 0, 0, series->rows[k].name);
            tally_add(&data, forces->data_misfit, LIMIT_MISFIT, series->rows[k].name);
            for (int axis = 0; axis < 2; axis++)
                tally_add(&misfit[axis], fabs(forces->weber[axis][axis] / packing->applied[axis][axis] - 1),
                          LIMIT_STRESS, series->rows[k].name);
        }
    }
    warn_tally(warnings, &open, method, "states it did not converge", 1, " iterations");
    warn_tally(warnings, &imbalance, method,
               "states a grain is left with an unbalanced force above 0.05 of the mean normal force", 1, "");
    warn_tally(
        warnings, &impossible, method,
        "states no forces at all on these contacts balance the loads, so that a contact must have been missed or a "
        "load is wrong; force chains may be elsewhere; unbalanced",
        1, "");
    warn_tally(
        warnings, &data, method,
        "states the photo does not fit the others: unknown loads, a wrong mu or another reference; misfit above 1.5", 1,
        "");
    warn_tally(warnings, &misfit[0], method, "states Weber stress xx is more than 10 % off the applied one", 100, " %");
    warn_tally(warnings, &misfit[1], method, "states Weber stress yy is more than 10 % off the applied one", 100, " %");
}

/* Every method that some state has, once. */
static void warn_methods(struct warnings *warnings, const struct series *series)
{
    char done[16][NAME_LENGTH];
    size_t count = 0;
    for (size_t k = 0; k < series->count; k++)
        for (size_t f = 0; f < series->rows[k].packing.force_count; f++) {
            const char *method = series->rows[k].packing.forces[f].method;
            size_t d = 0;
            while (d < count && strncmp(done[d], method, NAME_LENGTH))
                d++;
            if (d < count || count == 16)
                continue;
            memcpy(done[count++], method, NAME_LENGTH);
            warn_method(warnings, series, method);
        }
}

static void warn_floating(struct warnings *warnings, const struct series *series)
{
    struct tally floating = {0};
    for (size_t k = 0; k < series->count; k++)
        if (series->rows[k].packing.path)
            tally_add(&floating, (double)series->rows[k].packing.floating, 0, series->rows[k].name);
    warn_tally(warnings, &floating, "contacts", "states grains float, so that a contact must have been missed", 1,
               " grains");
}

/* The same overlaps stand beside every method: the first one with a stiffness speaks. */
static void warn_scale(struct warnings *warnings, const struct series *series)
{
    struct tally large = {0}, small = {0};
    for (size_t k = 0; k < series->count; k++) {
        const struct packing_summary *packing = &series->rows[k].packing;
        double ratio = NAN;
        for (size_t f = 0; f < packing->force_count && isnan(ratio); f++)
            ratio = packing->forces[f].overlaps_over_loads;
        tally_add(&large, ratio, LIMIT_OVERLAPS_OVER_LOADS, series->rows[k].name);
        tally_add(&small, ratio > 0 ? 1 / ratio : NAN, LIMIT_OVERLAPS_OVER_LOADS, series->rows[k].name);
    }
    warn_tally(warnings, &large, "contacts",
               "states overlaps times k_n are more than 1.4 times the loads: scale, stiffness or loads are wrong, or "
               "overlaps are "
               "no more than their errors",
               1, " times");
    warn_tally(warnings, &small, "contacts",
               "states the loads are more than 1.4 times the overlaps times k_n: scale, stiffness or loads are wrong, "
               "or overlaps "
               "are no more than their errors",
               1, " times");
}

/* All in one line, those behind the first few as a number. */
static void warn_skipped(struct warnings *warnings, const struct scene *scene)
{
    enum { NAMED = 8 };
    const struct scene_photos *photos = &scene->photos;
    char text[300] = "";
    size_t length = 0, count = photos->skip_count;
    for (size_t k = 0; k < count && k < NAMED; k++)
        length += (size_t)snprintf(text + length, sizeof text - length, "%s%04ld", k ? ", " : "", photos->skip[k]);
    if (count > NAMED)
        length += (size_t)snprintf(text + length, sizeof text - length, " and %zu more", count - NAMED);
    snprintf(text + length, sizeof text - length,
             " %s skipped (photos.skip): increments of the photo behind a gap span all of it",
             count == 1 ? "is" : "are");
    char line[320];
    snprintf(line, sizeof line, "photo%s %s", count == 1 ? "" : "s", text);
    if (count)
        warn(warnings, line);
}

/* What lies between two rows and is not skipped. */
static void warn_gaps(struct warnings *warnings, const struct scene *scene, const struct series *series)
{
    char text[300];
    for (size_t k = 1; k < series->count; k++) {
        int64_t before = series->rows[k - 1].index, now = series->rows[k].index;
        if (before < 0)
            continue;
        int64_t first = before + 1, last = now - 1;
        while (first <= last && scene_photo_skipped(scene, first))
            first++;
        while (first <= last && scene_photo_skipped(scene, last))
            last--;
        if (first > last)
            continue;
        if (first == last)
            snprintf(text, sizeof text, "photo %04lld is missing in the series", (long long)first);
        else
            snprintf(text, sizeof text, "photos %04lld to %04lld are missing in the series", (long long)first,
                     (long long)last);
        warn(warnings, text);
    }
}

/* By the camera's clock, where it is known. */
static void warn_order(struct warnings *warnings, const struct series *series)
{
    const struct series_row *before = NULL;
    char text[300];
    for (size_t k = 0; k < series->count; k++) {
        const struct series_row *row = &series->rows[k];
        if (!*row->taken)
            continue;
        if (before && strcmp(row->taken, before->taken) < 0) {
            snprintf(text, sizeof text, "photo %.60s was taken at %s, before photo %.60s (%s): are they in order?",
                     row->name, row->taken, before->name, before->taken);
            warn(warnings, text);
        }
        before = row;
    }
}

static int by_content(const void *left, const void *right)
{
    const struct series_input *a = *(const struct series_input *const *)left,
                              *b = *(const struct series_input *const *)right;
    int order = strcmp(a->sha256, b->sha256);
    return order ? order : strcmp(a->name, b->name);
}

/* Two names, one content: the same photo twice. */
static int warn_copies(struct warnings *warnings, const struct series *series)
{
    const struct series_input **inputs = malloc((series->input_count + 1) * sizeof *inputs);
    char text[300];
    if (!inputs)
        return error_memory("the list of inputs");
    for (size_t k = 0; k < series->input_count; k++)
        inputs[k] = &series->inputs[k];
    qsort(inputs, series->input_count, sizeof *inputs, by_content);
    for (size_t k = 1; k < series->input_count; k++)
        if (!strcmp(inputs[k]->sha256, inputs[k - 1]->sha256) && strcmp(inputs[k]->name, inputs[k - 1]->name)) {
            snprintf(text, sizeof text, "%.100s and %.100s have the same content: is one of them a copy?",
                     inputs[k - 1]->name, inputs[k]->name);
            warn(warnings, text);
        }
    free(inputs);
    return 0;
}

/* Forces that are not to be used come before everything else, each state by its name. */
static void warn_void(const struct series *series, struct html *html)
{
    int count = 0;
    for (size_t k = 0; k < series->count; k++) {
        const struct packing_summary *packing = &series->rows[k].packing;
        for (size_t f = 0; f < packing->force_count; f++) {
            const struct force_summary *forces = &packing->forces[f];
            if (forces->verdict != VERDICT_VOID)
                continue;
            if (count++ == 0)
                fputs("<h2>Not to be used</h2>\n<div class=\"void\"><ul>\n", html->stream);
            fputs("<li>NOT IN EQUILIBRIUM: ", html->stream);
            html_format(html, "%s, %.*s: %s", series->rows[k].name, NAME_LENGTH, forces->method, forces->reasons);
            fputs("</li>\n", html->stream);
        }
    }
    if (count)
        fputs("</ul></div>\n", html->stream);
}

int page_warnings(const struct scene *scene, const struct series *series, struct html *html)
{
    struct warnings warnings = {html, 0};
    warn_void(series, html);
    warn_skipped(&warnings, scene);
    warn_gaps(&warnings, scene, series);
    warn_order(&warnings, series);
    int status = warn_copies(&warnings, series);
    warn_photos(&warnings, series, 0);
    warn_photos(&warnings, series, 1);
    warn_floating(&warnings, series);
    warn_scale(&warnings, series);
    warn_methods(&warnings, series);
    if (warnings.count)
        fputs("</ul></div>\n", html->stream);
    else
        fputs(
            "<div class=\"good\"><p>Nothing to warn of: no more than 5 % of the grains flagged in any photo, ZNCC "
            "above "
            "0.9, every method converged, Weber stress within 10 % of the applied one where that is known.</p></div>\n",
            html->stream);
    return status;
}
