/* Photo, frame, circles, numbers, from below; ticks and caption around them (overlay_scale.c). Places are px of the
 * photo with the centres of pixels at whole numbers: (x + 0.5) zoom is their place in the picture. Greys run from the
 * level of the voids (black) to 1.6 times that of the grains above it, so that bright grains do not hide the circles.
 */
#include "findgrains/picture/overlay.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>

#include "findgrains/picture/overlay_scale.h"
#include "pipeline/draw/photo_background.h"
#include "pipeline/speak/error.h"

#define LEAST_LINE 1.2      /* px: thinnest circle */
#define LINE 2.0            /* px: circles with room for it, in small pictures */
#define LINES_PER_TEXT 11.0 /* size of letters over the width of a circle in larger ones */

int overlay_check_path(const char *path)
{
    const char *dot = path ? strrchr(path, '.') : NULL;
    if (!path || (dot && !strcasecmp(dot, ".png")))
        return 0;
    return error_input("%s: the picture is a PNG and has another ending: name it .png", path);
}

/* A rim that can be drawn: known grains that were lost have no place. */
static int is_placed(const struct photo_grains *grains, size_t k)
{
    return isfinite(grains->x_px[k]) && isfinite(grains->y_px[k]) && isfinite(grains->radius_px[k]);
}

static int is_flagged(const struct photo_grains *grains, size_t k)
{
    return (grains->flags[k] & GRAIN_DISTRUST) != 0;
}

static enum colour colour_of(const struct photo_grains *grains, size_t k)
{
    return is_flagged(grains, k) ? COLOUR_VERMILLION : COLOUR_SKY;
}

/* px of a circle with room for it, and of the frame. */
static double line_width(const struct overlay_layout *layout)
{
    return fmax(LINE, layout->text / LINES_PER_TEXT);
}

/* Thinner on small circles, which would else be hidden. A flagged one has whole dashes around it, 5 at least, of some 5
 * widths each with its gap: 3 parts of line and 2 of gap, so that dashes and gaps meet where they began. */
static struct pen pen_of(const struct overlay_layout *layout, const struct photo_grains *grains, size_t k)
{
    int flagged = is_flagged(grains, k);
    double radius = grains->radius_px[k] * layout->zoom;
    double width = fmax(LEAST_LINE, fmin(line_width(layout), 0.1 * radius)) * (flagged ? 1.8 : 1);
    double count = fmax(5, round(2 * M_PI * radius / (5 * width))), dash = M_PI * radius / count;
    struct pen pen = {colour_of(grains, k), .width = width, .round_joins = 1};
    if (flagged)
        pen.dash[0] = 1.2 * dash, pen.dash[1] = 0.8 * dash;
    return pen;
}

/* The rim with its shape r + c cos(2 phi) + s sin(2 phi), as the file has it, phi counter-clockwise as seen. */
static void draw_rim(struct canvas *canvas, const struct overlay_layout *layout, const struct photo_grains *grains,
                     size_t k)
{
    enum { STEPS = 96 };
    const struct pen pen = pen_of(layout, grains, k);
    double zoom = layout->zoom;
    pen_begin(canvas);
    for (int step = 0; step < STEPS; step++) {
        double phi = 2 * M_PI * step / STEPS, r = grains->radius_px[k];
        if (grains->shape_c)
            r += grains->shape_c[k] * cos(2 * phi) + grains->shape_s[k] * sin(2 * phi);
        double x = grains->x_px[k] + r * cos(phi), y = grains->y_px[k] - r * sin(phi);
        pen_go(canvas, (x + 0.5) * zoom, (y + 0.5) * zoom);
    }
    pen_close(canvas);
    pen_draw(canvas, &pen);
}

/* Flagged ones last, so that nothing hides them. */
static void draw_rims(struct canvas *canvas, const struct overlay_layout *layout, const struct photo_grains *grains)
{
    for (int flagged = 0; flagged < 2; flagged++)
        for (size_t k = 0; k < grains->count; k++)
            if (is_placed(grains, k) && is_flagged(grains, k) == flagged)
                draw_rim(canvas, layout, grains, k);
}

/* The number of a row inside its circle, and inside the photo, in the circle's colour on a dark edge. */
static void draw_row(struct canvas *canvas, const struct overlay_layout *layout, const struct photo_grains *grains,
                     size_t k)
{
    char text[32];
    double size = overlay_number_size(layout, grains->radius_px[k], k);
    if (!(size > 0))
        return;
    snprintf(text, sizeof text, "%zu", k);
    double width = words_width(canvas, size, 0, text);
    double x = (grains->x_px[k] + 0.5) * layout->zoom - 0.5 * width, y = (grains->y_px[k] + 0.5) * layout->zoom;
    words_over_photo(canvas, fmax(0, fmin(x, layout->photo_width - width)),
                     fmax(0.5 * size, fmin(y, layout->photo_height - 0.5 * size)) + 0.36 * size, size,
                     colour_of(grains, k), text);
}

/* The frame that the grains lie in, and its corner markers. */
static void draw_zone(struct canvas *canvas, const struct overlay_layout *layout, const struct zone *zone)
{
    const struct pen pen = {COLOUR_YELLOW, .width = line_width(layout), .round_joins = 1};
    double zoom = layout->zoom;
    if (!zone->has_frame)
        return;
    pen_begin(canvas);
    for (int k = 0; k < 4; k++)
        pen_go(canvas, (zone->corners[k].x + 0.5) * zoom, (zone->corners[k].y + 0.5) * zoom);
    pen_close(canvas);
    pen_draw(canvas, &pen);
    for (int k = 0; k < 4 && zone->corner_radius > 0; k++)
        pen_circle(canvas, &pen, (zone->corners[k].x + 0.5) * zoom, (zone->corners[k].y + 0.5) * zoom,
                   zone->corner_radius * zoom);
}

/* What the caption says. */
static struct overlay_facts count_facts(const struct overlay_layout *layout, const struct photo_grains *grains,
                                        const struct find_notes *notes)
{
    struct overlay_facts facts = {
        .grains = grains->count, .flagged = find_count_flagged(grains), .has_frame = notes->zone.has_frame};
    for (size_t k = 0; k < grains->count; k++)
        facts.numbered += is_placed(grains, k) && overlay_number_size(layout, grains->radius_px[k], k) > 0;
    return facts;
}

int overlay_write(const char *path, const struct photo *photo, const struct photo_grains *grains,
                  const struct find_notes *notes)
{
    struct overlay_layout layout;
    struct canvas canvas;
    double black = notes->levels.void_level, white = black + 1.6 * (notes->levels.grain_level - black);
    overlay_layout_make(photo->width, photo->height, &layout);
    struct overlay_facts facts = count_facts(&layout, grains, notes);
    overlay_layout_caption(&facts, &layout);
    if (canvas_begin(&canvas, path, layout.width, layout.height))
        return -1;
    int failed = photo_background_pixels(&canvas, photo, layout.zoom, layout.photo_width, layout.photo_height, black,
                                         fmax(white, black + 1));
    if (!failed) {
        draw_zone(&canvas, &layout, &notes->zone);
        draw_rims(&canvas, &layout, grains);
        for (size_t k = 0; k < grains->count; k++)
            if (is_placed(grains, k))
                draw_row(&canvas, &layout, grains, k);
        overlay_layout_draw(&layout, &canvas);
    }
    return canvas_end(&canvas, failed);
}
