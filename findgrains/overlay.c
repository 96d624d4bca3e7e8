#include "findgrains/overlay.h"

#include "pipeline/error.h"
#include "pipeline/new_file.h"

#include <cairo.h>
#include <math.h>
#include <stdint.h>

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

static cairo_surface_t *paint_photo(const struct photo *photo, double zoom, double black, double white)
{
    int width = (int)fmax(1, photo->width * zoom), height = (int)fmax(1, photo->height * zoom);
    cairo_surface_t *surface = cairo_image_surface_create(CAIRO_FORMAT_RGB24, width, height);
    if (cairo_surface_status(surface) != CAIRO_STATUS_SUCCESS)
        return surface;
    cairo_surface_flush(surface);
    unsigned char *data = cairo_image_surface_get_data(surface);
    int stride = cairo_image_surface_get_stride(surface);
    for (int y = 0; y < height; y++) {
        uint32_t *row = (uint32_t *)(void *)(data + (size_t)y * (size_t)stride);
        for (int x = 0; x < width; x++) {
            double grey = 255 * (grey_under(photo, zoom, x, y) - black) / (white - black);
            row[x] = (uint32_t)fmin(255, fmax(0, grey)) * 0x010101u;
        }
    }
    cairo_surface_mark_dirty(surface);
    return surface;
}

static void draw_rims(cairo_t *cairo, double zoom, const struct photo_grains *grains)
{
    enum { STEPS = 96 };
    for (size_t k = 0; k < grains->count; k++) {
        for (int step = 0; step < STEPS; step++) {
            double phi = 2 * M_PI * step / STEPS, r = grains->radius_px[k];
            if (grains->shape_c)
                r += grains->shape_c[k] * cos(2 * phi) + grains->shape_s[k] * sin(2 * phi);
            double x = grains->x_px[k] + r * cos(phi), y = grains->y_px[k] - r * sin(phi);
            cairo_line_to(cairo, (x + 0.5) * zoom, (y + 0.5) * zoom);
        }
        cairo_close_path(cairo);
        if (grains->flags[k] & GRAIN_DISTRUST)
            cairo_set_source_rgb(cairo, 1, 0.25, 0.2);
        else
            cairo_set_source_rgb(cairo, 0.2, 0.9, 0.3);
        cairo_stroke(cairo);
    }
}

static void draw_zone(cairo_t *cairo, double zoom, const struct zone *zone)
{
    if (!zone->has_frame)
        return;
    cairo_set_source_rgb(cairo, 0.3, 0.6, 1);
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
    double side = photo->width > photo->height ? photo->width : photo->height;
    double zoom = fmin(4, OVERLAY_SIDE / side);
    zoom = zoom >= 1 ? floor(zoom) : 1 / ceil(1 / zoom);
    double black = notes->levels.void_level, white = black + 1.6 * (notes->levels.grain_level - black);
    cairo_surface_t *surface = paint_photo(photo, zoom, black, fmax(white, black + 1));
    cairo_t *cairo = cairo_create(surface);
    cairo_set_line_width(cairo, 1.2);
    draw_zone(cairo, zoom, &notes->zone);
    draw_rims(cairo, zoom, grains);
    cairo_destroy(cairo);
    int status = cairo_surface_status(surface) == CAIRO_STATUS_SUCCESS
                     ? write_png(surface, path)
                     : error_failed("%s: the picture cannot be drawn: use a smaller photo", path);
    cairo_surface_destroy(surface);
    return status;
}
