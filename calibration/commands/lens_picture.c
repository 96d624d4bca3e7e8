#include "calibration/commands/lens_picture.h"

#include <stdio.h>
#include <stdlib.h>

#include "pipeline/speak/error.h"
#include "pipeline/files/new_file.h"

enum { PANEL = 560, GAP = 30, CAPTION = 30, ACROSS = 17, DOWN = 13 };

struct panel {
    FILE *file;
    double left, scale; /* of the photo on the page: page units per px */
    double magnify;     /* page units per px of an arrow */
};

static void open_panel(const struct panel *panel, int height, const char *colour, const char *caption, double largest,
                       double rms)
{
    fprintf(panel->file, "<text x=\"%g\" y=\"20\">%s: largest %.4f px, RMS %.4f px; arrows x %.0f</text>\n",
            panel->left, caption, largest, rms, panel->magnify / panel->scale);
    fprintf(panel->file, "<rect x=\"%g\" y=\"%d\" width=\"%d\" height=\"%g\" fill=\"none\" stroke=\"#999\"/>\n",
            panel->left, CAPTION, PANEL, height * panel->scale);
    fprintf(panel->file, "<g stroke=\"%s\" stroke-width=\"1\" fill=\"%s\">\n", colour, colour);
}

static void arrow(const struct panel *panel, struct vec at, struct vec by)
{
    double x = panel->left + at.x * panel->scale, y = CAPTION + at.y * panel->scale;
    fprintf(panel->file, "<circle cx=\"%.2f\" cy=\"%.2f\" r=\"1.5\"/><path d=\"M%.2f %.2fl%.2f %.2f\"/>\n", x, y, x, y,
            by.x * panel->magnify, by.y * panel->magnify);
}

/* The longest arrow and the root mean square per component. */
static double measure(const struct vec *by, size_t count, double *rms)
{
    double largest = 0, square = 0;
    size_t n = 0;
    for (size_t k = 0; k < count; k++)
        if (isfinite(by[k].x)) {
            largest = fmax(largest, vec_norm(by[k]));
            square += vec_dot(by[k], by[k]) / 2;
            n++;
        }
    *rms = n ? sqrt(square / (double)n) : 0;
    return largest;
}

static void draw(struct panel *panel, int height, const char *colour, const char *caption, const struct vec *at,
                 const struct vec *by, size_t count, double room)
{
    double rms, largest = measure(by, count, &rms);
    panel->magnify = largest > 0 ? room / largest : 1;
    open_panel(panel, height, colour, caption, largest, rms);
    for (size_t k = 0; k < count; k++)
        if (isfinite(by[k].x))
            arrow(panel, at[k], by[k]);
    fputs("</g>\n", panel->file);
}

/* Mean over the photos in which the point was followed. */
static struct vec mean_residual(const struct lens_points *points, const struct lens_fitted *fitted, size_t k)
{
    struct vec sum = {0, 0};
    double n = 0;
    for (size_t p = 0; p < points->photos; p++)
        if (!isnan(points->sigma[p * points->count + k])) {
            sum = vec_add(sum, lens_residual(points, fitted, p, k));
            n++;
        }
    return vec_scale(1 / n, sum); /* NaN: never followed */
}

static void write_panels(FILE *file, const struct lens_points *points, const struct lens_fitted *fitted,
                         struct vec *residual)
{
    const double scale = (double)PANEL / points->width;
    struct vec place[ACROSS * DOWN], correction[ACROSS * DOWN];
    struct panel panel = {.file = file, .left = GAP, .scale = scale};
    for (int k = 0; k < ACROSS * DOWN; k++) {
        place[k] = vec((points->width - 1) * (k % ACROSS) / (ACROSS - 1.0),
                       (points->height - 1) * (k / ACROSS) / (DOWN - 1.0));
        correction[k] = vec_sub(lens_corrected(&fitted->lens, place[k]), place[k]);
    }
    for (size_t k = 0; k < points->count; k++)
        residual[k] = mean_residual(points, fitted, k);
    double width = 3.0 * GAP + 2 * PANEL, height = CAPTION + GAP + points->height * scale;
    fprintf(file,
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 %g %g\" font-family=\"sans-serif\" "
            "font-size=\"12\">\n<rect width=\"100%%\" height=\"100%%\" fill=\"white\"/>\n",
            width, height);
    draw(&panel, points->height, "#1f5fa8", "correction", place, correction, ACROSS * DOWN, 0.8 * PANEL / ACROSS);
    panel.left = PANEL + 2 * GAP;
    draw(&panel, points->height, "#b03a2e", "left at the points", points->reference, residual, points->count,
         1.5 * PANEL / sqrt((double)points->count + 1));
    fputs("</svg>\n", file);
}

int lens_picture(const char *path, const struct lens_points *points, const struct lens_fitted *fitted)
{
    struct new_file file;
    struct vec *residual = malloc((points->count + 1) * sizeof *residual);
    if (!residual)
        return error_memory("the picture of the lens");
    if (new_file_begin(&file, path)) {
        free(residual);
        return -1;
    }
    FILE *stream = fopen(file.temporary, "w");
    int status = stream ? 0 : error_failed("%s: cannot be written: check the disk", path);
    if (stream) {
        write_panels(stream, points, fitted, residual);
        if (ferror(stream) | fclose(stream))
            status = error_failed("%s: cannot be written: check the disk", path);
    }
    free(residual);
    if (status)
        return new_file_discard(&file), -1;
    return new_file_commit(&file);
}
