/* A photo has more greys than a picture and often more pixels. Greys go by a straight line from [black, white] to
 * [0, 255], clipped. Pixels are averaged over whole blocks, reduced * reduced of them, the largest blocks that are not
 * coarser than the picture; cairo then fits the rest, less than a factor of two, by its own filter. */
#include "pipeline/draw/photo_background.h"

#include <cairo.h>
#include <math.h>
#include <stdlib.h>

#include "pipeline/speak/error.h"

/* A raster over the photo from (x0, y0) on: `magnified` of its pixels per px of the photo, or each the mean of
 * `reduced` times `reduced` px; one of the two is 1. */
struct raster {
    const struct photo *photo;
    int x0, y0, columns, rows, magnified, reduced;
    double black, white;
};

/* Mean of the photo's pixels under one pixel of the raster. */
static double grey_under(const struct raster *raster, int column, int row)
{
    const struct photo *photo = raster->photo;
    double sum = 0, count = 0;
    int x0 = raster->x0 + column / raster->magnified * raster->reduced;
    int y0 = raster->y0 + row / raster->magnified * raster->reduced;
    for (int y = y0; y < y0 + raster->reduced && y < photo->height; y++)
        for (int x = x0; x < x0 + raster->reduced && x < photo->width; x++) {
            sum += photo_row(photo, y)[x];
            count += 1;
        }
    return count > 0 ? sum / count : 0;
}

/* The raster as a surface of cairo, greys clipped to black and white; NULL: memory. */
static cairo_surface_t *paint(const struct raster *raster)
{
    cairo_surface_t *surface = cairo_image_surface_create(CAIRO_FORMAT_RGB24, raster->columns, raster->rows);
    if (cairo_surface_status(surface) != CAIRO_STATUS_SUCCESS) {
        cairo_surface_destroy(surface);
        (void)error_memory("the photo in a picture");
        return NULL;
    }
    cairo_surface_flush(surface);
    unsigned char *data = cairo_image_surface_get_data(surface);
    int stride = cairo_image_surface_get_stride(surface);
    for (int row = 0; row < raster->rows; row++) {
        uint32_t *line = (uint32_t *)(void *)(data + (size_t)row * (size_t)stride);
        for (int column = 0; column < raster->columns; column++) {
            double grey = 255 * (grey_under(raster, column, row) - raster->black) / (raster->white - raster->black);
            line[column] = 0x010101u * (uint32_t)fmin(255, fmax(0, grey));
        }
    }
    cairo_surface_mark_dirty(surface);
    return surface;
}

/* To 0 ... most, whatever the value: a scene may place the photo anywhere. */
static int clamp(double value, int most)
{
    return value < 0 ? 0 : value > most ? most : (int)value;
}

/* Whole blocks of the photo's pixels, not much finer than the picture's. */
static struct raster cut(const struct photo *photo, const struct photo_view *view, double width)
{
    struct raster raster = {.photo = photo, .magnified = 1};
    int x1 = clamp(ceil(view->x1) + 1, photo->width), y1 = clamp(ceil(view->y1) + 1, photo->height);
    double finer = (view->x1 - view->x0) / width;
    raster.reduced = finer >= 2 ? (int)finer : 1;
    raster.x0 = clamp(floor(view->x0), photo->width);
    raster.y0 = clamp(floor(view->y0), photo->height);
    raster.columns = (x1 - raster.x0) / raster.reduced;
    raster.rows = (y1 - raster.y0) / raster.reduced;
    return raster;
}

/* The greys that 0.5 % of the raster lie below and above. */
static int find_greys(struct raster *raster)
{
    size_t *histogram = calloc(65537, sizeof *histogram), total = 0, below = 0;
    unsigned black = 0, white = 0;
    if (!histogram)
        return error_memory("a histogram");
    for (int row = 0; row < raster->rows; row++)
        for (int column = 0; column < raster->columns; column++, total++)
            histogram[(unsigned)grey_under(raster, column, row)]++;
    for (unsigned grey = 0; grey < 65536; grey++) {
        if (below <= total / 200)
            black = grey;
        if (below <= total - total / 200)
            white = grey;
        below += histogram[grey];
    }
    raster->black = black;
    raster->white = white > black ? white : black + 1;
    free(histogram);
    return 0;
}

int photo_background(struct canvas *canvas, const struct photo *photo, const struct photo_view *view, double width,
                     double height)
{
    struct raster raster = cut(photo, view, width);
    cairo_t *cairo = canvas->cairo;
    if (raster.columns <= 0 || raster.rows <= 0)
        return error_input("the photo does not show the packing: check scale_m_per_px and origin_px of the scene");
    cairo_surface_t *surface = find_greys(&raster) ? NULL : paint(&raster);
    if (!surface)
        return -1;
    canvas_clip(canvas, 0, 0, width, height);
    /* From the picture to px of the photo (pixel centres are whole numbers: its edge lies half a px before), to blocks.
     */
    cairo_scale(cairo, width / (view->x1 - view->x0), height / (view->y1 - view->y0));
    cairo_translate(cairo, raster.x0 - 0.5 - view->x0, raster.y0 - 0.5 - view->y0);
    cairo_scale(cairo, raster.reduced, raster.reduced);
    cairo_set_source_surface(cairo, surface, 0, 0);
    cairo_pattern_set_filter(cairo_get_source(cairo), CAIRO_FILTER_GOOD);
    cairo_paint(cairo);
    canvas_restore(canvas);
    cairo_surface_destroy(surface);
    return 0;
}

int photo_background_pixels(struct canvas *canvas, const struct photo *photo, double zoom, int width, int height,
                            double black, double white)
{
    const struct raster raster = {.photo = photo,
                                  .columns = width,
                                  .rows = height,
                                  .magnified = zoom > 1 ? (int)round(zoom) : 1,
                                  .reduced = zoom < 1 ? (int)round(1 / zoom) : 1,
                                  .black = black,
                                  .white = white};
    cairo_surface_t *surface = paint(&raster);
    if (!surface)
        return -1;
    cairo_set_source_surface(canvas->cairo, surface, 0, 0);
    cairo_pattern_set_filter(cairo_get_source(canvas->cairo), CAIRO_FILTER_NEAREST);
    cairo_paint(canvas->cairo);
    cairo_surface_destroy(surface);
    return 0;
}
