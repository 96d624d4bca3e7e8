/* Distortions of some px in a photo of thousands are not to be seen in their own size: both fields are magnified, each
 * so that its longest arrow is as long as there is room between two arrows. The correction is what lens_corrected()
 * moves; residuals without pattern say that eight parameters suffice, a pattern that they do not, or that the plate is
 * not flat. */
#include "calibration/commands/lens_picture.h"

#include <stdio.h>
#include <stdlib.h>

#include "pipeline/draw/words.h"
#include "pipeline/speak/error.h"

/* px: width of a panel, room around and above it; and the places of the correction's arrows. */
enum { PANEL = 560, GAP = 30, CAPTION = 30, ACROSS = 17, DOWN = 13 };

/* Vectors at places of the photo, both in px of the photo; NaN: not known. */
struct field {
    const char *name;
    enum colour colour;
    const struct vec *at, *by;
    size_t count;
    double room; /* px of the picture for the longest arrow */
};

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

/* From (0, 0) of the canvas on; `scale`: px of the picture per px of the photo. */
/* Caption, frame, and an arrow at each place, its dot where it begins. */
static void draw_field(struct canvas *canvas, const struct field *field, double scale, double height)
{
    double rms, largest = measure(field->by, field->count, &rms), magnify = largest > 0 ? field->room / largest : 1;
    const struct pen arrow = {field->colour, .width = 1}, dot = {.colour = field->colour};
    char text[120];
    snprintf(text, sizeof text, "%s: largest %.4f px, RMS %.4f px; arrows x %.0f", field->name, largest, rms,
             magnify / scale);
    words_draw(canvas, 0, 20, 0, 12, 0, text);
    pen_rectangle(canvas, &(struct pen){COLOUR_GREY, .width = 1}, 0, CAPTION, PANEL, height * scale);
    for (size_t k = 0; k < field->count; k++) {
        double x = field->at[k].x * scale, y = CAPTION + field->at[k].y * scale;
        if (!isfinite(field->by[k].x))
            continue;
        pen_circle(canvas, &dot, x, y, 1.5);
        pen_segment(canvas, &arrow, x, y, x + field->by[k].x * magnify, y + field->by[k].y * magnify);
    }
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

/* Both fields side by side. */
static int draw(const char *path, const struct lens_points *points, const struct field fields[2])
{
    const double scale = (double)PANEL / points->width;
    struct canvas canvas;
    if (canvas_begin(&canvas, path, 3.0 * GAP + 2 * PANEL, CAPTION + GAP + points->height * scale))
        return -1;
    int failed = canvas_keep_words(&canvas);
    for (int f = 0; f < 2 && !failed; f++) {
        canvas_move(&canvas, GAP + f * (PANEL + GAP), 0, 0);
        draw_field(&canvas, &fields[f], scale, points->height);
        canvas_restore(&canvas);
    }
    return canvas_end(&canvas, failed);
}

int lens_picture(const char *path, const struct lens_points *points, const struct lens_fitted *fitted)
{
    struct vec place[ACROSS * DOWN], correction[ACROSS * DOWN];
    struct vec *residual = malloc((points->count + 1) * sizeof *residual);
    if (!residual)
        return error_memory("the picture of the lens");
    for (int k = 0; k < ACROSS * DOWN; k++) {
        place[k] = vec((points->width - 1) * (k % ACROSS) / (ACROSS - 1.0),
                       (points->height - 1) * (k / ACROSS) / (DOWN - 1.0));
        correction[k] = vec_sub(lens_corrected(&fitted->lens, place[k]), place[k]);
    }
    for (size_t k = 0; k < points->count; k++)
        residual[k] = mean_residual(points, fitted, k);
    const struct field fields[2] = {{"correction", COLOUR_BLUE, place, correction, ACROSS * DOWN, 0.8 * PANEL / ACROSS},
                                    {"left at the points", COLOUR_VERMILLION, points->reference, residual,
                                     points->count, 1.5 * PANEL / sqrt((double)points->count + 1)}};
    int status = draw(path, points, fields);
    free(residual);
    return status;
}
