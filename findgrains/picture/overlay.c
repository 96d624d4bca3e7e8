#include "findgrains/picture/overlay.h"

#include "findgrains/picture/overlay_scale.h"
#include "pipeline/speak/error.h"
#include "pipeline/files/new_file.h"

#include <cairo.h>
#include <fontconfig/fontconfig.h>
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>

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

/* Mean of the photo's pixels under one pixel of the picture. */
static double grey_under(const struct photo *photo, double zoom, int x, int y)
{
    int x0 = (int)(x / zoom), y0 = (int)(y / zoom), x1 = (int)((x + 1) / zoom), y1 = (int)((y + 1) / zoom);
    double sum = 0, count = 0;
    for (int j = y0; j < (y1 > y0 ? y1 : y0 + 1) && j < photo->height; j++)
        for (int i = x0; i < (x1 > x0 ? x1 : x0 + 1) && i < photo->width; i++) {
            sum += photo_row(photo, j)[i];
            count += 1;
        }
    return count > 0 ? sum / count : 0;
}

static void paint_photo(const struct photo *photo, const struct overlay_layout *layout, double black, double white,
                        cairo_surface_t *surface)
{
    cairo_surface_flush(surface);
    unsigned char *data = cairo_image_surface_get_data(surface);
    int stride = cairo_image_surface_get_stride(surface);
    for (int y = 0; y < layout->photo_height; y++) {
        uint32_t *row = (uint32_t *)(void *)(data + (size_t)y * (size_t)stride);
        for (int x = 0; x < layout->photo_width; x++) {
            double grey = 255 * (grey_under(photo, layout->zoom, x, y) - black) / (white - black);
            row[x] = (uint32_t)fmin(255, fmax(0, grey)) * 0x010101u;
        }
    }
    cairo_surface_mark_dirty(surface);
}

/* A rim that can be drawn: known grains that were lost have no place. */
static int is_placed(const struct photo_grains *grains, size_t k)
{
    return isfinite(grains->x_px[k]) && isfinite(grains->y_px[k]) && isfinite(grains->radius_px[k]);
}

static int choose_colour(cairo_t *cairo, const struct photo_grains *grains, size_t k)
{
    int flagged = (grains->flags[k] & GRAIN_DISTRUST) != 0;
    if (flagged)
        cairo_set_source_rgb(cairo, OVERLAY_VERMILLION);
    else
        cairo_set_source_rgb(cairo, OVERLAY_SKY);
    return flagged;
}

static double line_width(const struct overlay_layout *layout)
{
    return fmax(LINE, layout->text / LINES_PER_TEXT);
}

/* Thinner on small circles, which would else be hidden; whole dashes around a flagged one. */
static void choose_pen(cairo_t *cairo, const struct overlay_layout *layout, double radius, int flagged)
{
    double width = fmax(LEAST_LINE, fmin(line_width(layout), 0.1 * radius)) * (flagged ? 1.8 : 1);
    double count = fmax(5, round(2 * M_PI * radius / (5 * width))), dash = M_PI * radius / count;
    const double dashes[] = {1.2 * dash, 0.8 * dash};
    cairo_set_line_width(cairo, width);
    cairo_set_dash(cairo, dashes, flagged && dash > 0 ? 2 : 0, 0);
}

static void draw_rim(cairo_t *cairo, double zoom, const struct photo_grains *grains, size_t k)
{
    enum { STEPS = 96 };
    for (int step = 0; step < STEPS; step++) {
        double phi = 2 * M_PI * step / STEPS, r = grains->radius_px[k];
        if (grains->shape_c)
            r += grains->shape_c[k] * cos(2 * phi) + grains->shape_s[k] * sin(2 * phi);
        double x = grains->x_px[k] + r * cos(phi), y = grains->y_px[k] - r * sin(phi);
        cairo_line_to(cairo, (x + 0.5) * zoom, (y + 0.5) * zoom);
    }
    cairo_close_path(cairo);
    cairo_stroke(cairo);
}

/* Flagged ones last, so that nothing hides them. */
static void draw_rims(cairo_t *cairo, const struct overlay_layout *layout, const struct photo_grains *grains)
{
    for (int flagged = 0; flagged < 2; flagged++)
        for (size_t k = 0; k < grains->count; k++)
            if (is_placed(grains, k) && choose_colour(cairo, grains, k) == flagged) {
                choose_pen(cairo, layout, grains->radius_px[k] * layout->zoom, flagged);
                draw_rim(cairo, layout->zoom, grains, k);
            }
    cairo_set_dash(cairo, NULL, 0, 0);
}

/* The number of a row inside its circle, and inside the photo, in the circle's colour on a dark edge. */
static void draw_row(cairo_t *cairo, const struct overlay_layout *layout, const struct photo_grains *grains, size_t k)
{
    char text[32];
    double size = overlay_number_size(layout, grains->radius_px[k], k);
    if (!(size > 0))
        return;
    snprintf(text, sizeof text, "%zu", k);
    double width = overlay_text_width(cairo, size, text);
    double x = (grains->x_px[k] + 0.5) * layout->zoom - 0.5 * width, y = (grains->y_px[k] + 0.5) * layout->zoom;
    cairo_move_to(cairo, fmax(0, fmin(x, layout->photo_width - width)),
                  fmax(0.5 * size, fmin(y, layout->photo_height - 0.5 * size)) + 0.36 * size);
    cairo_text_path(cairo, text);
    cairo_set_source_rgb(cairo, 0, 0, 0);
    cairo_set_line_width(cairo, 0.2 * size);
    cairo_stroke_preserve(cairo);
    choose_colour(cairo, grains, k);
    cairo_fill(cairo);
}

static void draw_zone(cairo_t *cairo, const struct overlay_layout *layout, const struct zone *zone)
{
    double zoom = layout->zoom;
    if (!zone->has_frame)
        return;
    cairo_set_source_rgb(cairo, OVERLAY_YELLOW);
    cairo_set_line_width(cairo, line_width(layout));
    for (int k = 0; k < 4; k++)
        cairo_line_to(cairo, (zone->corners[k].x + 0.5) * zoom, (zone->corners[k].y + 0.5) * zoom);
    cairo_close_path(cairo);
    cairo_stroke(cairo);
    for (int k = 0; k < 4 && zone->corner_radius > 0; k++) {
        cairo_arc(cairo, (zone->corners[k].x + 0.5) * zoom, (zone->corners[k].y + 0.5) * zoom,
                  zone->corner_radius * zoom, 0, 2 * M_PI);
        cairo_stroke(cairo);
    }
}

static struct overlay_facts count_facts(const struct overlay_layout *layout, const struct photo_grains *grains,
                                        const struct find_notes *notes)
{
    struct overlay_facts facts = {
        .grains = grains->count, .flagged = find_count_flagged(grains), .has_frame = notes->zone.has_frame};
    for (size_t k = 0; k < grains->count; k++)
        facts.numbered += is_placed(grains, k) && overlay_number_size(layout, grains->radius_px[k], k) > 0;
    return facts;
}

/* Everything over the photo, and around it. */
static cairo_status_t draw(cairo_surface_t *surface, const struct overlay_layout *layout,
                           const struct photo_grains *grains, const struct find_notes *notes)
{
    cairo_t *cairo = cairo_create(surface);
    cairo_set_line_join(cairo, CAIRO_LINE_JOIN_ROUND);
    draw_zone(cairo, layout, &notes->zone);
    draw_rims(cairo, layout, grains);
    for (size_t k = 0; k < grains->count; k++)
        if (is_placed(grains, k))
            draw_row(cairo, layout, grains, k);
    overlay_layout_draw(layout, cairo);
    cairo_status_t status = cairo_status(cairo);
    cairo_destroy(cairo);
    return status;
}

static int write_png(cairo_surface_t *surface, const char *path)
{
    struct new_file file;
    if (new_file_begin(&file, path))
        return -1;
    cairo_status_t status = cairo_surface_write_to_png(surface, file.temporary);
    if (status != CAIRO_STATUS_SUCCESS) {
        new_file_discard(&file);
        return error_failed("%s: %s: free some space or choose another place", path, cairo_status_to_string(status));
    }
    return new_file_commit(&file);
}

int overlay_write(const char *path, const struct photo *photo, const struct photo_grains *grains,
                  const struct find_notes *notes)
{
    struct overlay_layout layout;
    double black = notes->levels.void_level, white = black + 1.6 * (notes->levels.grain_level - black);
    overlay_layout_make(photo->width, photo->height, &layout);
    struct overlay_facts facts = count_facts(&layout, grains, notes);
    overlay_layout_caption(&facts, &layout);
    cairo_surface_t *surface = cairo_image_surface_create(CAIRO_FORMAT_RGB24, layout.width, layout.height);
    cairo_status_t drawn = cairo_surface_status(surface);
    if (drawn == CAIRO_STATUS_SUCCESS) {
        paint_photo(photo, &layout, black, fmax(white, black + 1), surface);
        drawn = draw(surface, &layout, grains, notes);
    }
    int status = drawn == CAIRO_STATUS_SUCCESS
                     ? write_png(surface, path)
                     : error_failed("%s: the picture cannot be drawn: %s: use a smaller photo", path,
                                    cairo_status_to_string(drawn));
    cairo_surface_destroy(surface);
    return status;
}

void overlay_forget_fonts(void)
{
    cairo_debug_reset_static_data();
    FcFini();
}
