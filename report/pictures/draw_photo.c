#include "report/pictures/draw_photo.h"

#include <math.h>
#include <stdlib.h>

#include "pipeline/speak/error.h"

/* The shown pixels in blocks of factor * factor. */
struct blocks {
    int x0, y0, factor, columns, rows;
};

static int clamp(double value, int most)
{
    return value < 0 ? 0 : value > most ? most : (int)value;
}

static struct blocks cut_blocks(const struct photo *photo, const struct photo_view *view, double width)
{
    struct blocks blocks;
    int x1 = clamp(ceil(view->x1) + 1, photo->width), y1 = clamp(ceil(view->y1) + 1, photo->height);
    double finer = (view->x1 - view->x0) / width;
    blocks.x0 = clamp(floor(view->x0), photo->width);
    blocks.y0 = clamp(floor(view->y0), photo->height);
    blocks.factor = finer >= 2 ? (int)finer : 1;
    blocks.columns = (x1 - blocks.x0) / blocks.factor;
    blocks.rows = (y1 - blocks.y0) / blocks.factor;
    return blocks;
}

static unsigned block_mean(const struct photo *photo, const struct blocks *blocks, int column, int row)
{
    uint64_t sum = 0;
    for (int y = 0; y < blocks->factor; y++) {
        const uint16_t *pixels = photo_row(photo, blocks->y0 + row * blocks->factor + y) + blocks->x0;
        for (int x = 0; x < blocks->factor; x++)
            sum += pixels[column * blocks->factor + x];
    }
    return (unsigned)(sum / ((uint64_t)blocks->factor * (uint64_t)blocks->factor));
}

static int find_greys(const struct photo *photo, const struct blocks *blocks, unsigned *black, unsigned *white)
{
    size_t *histogram = calloc(65537, sizeof *histogram), total = 0, below = 0;
    if (!histogram)
        return error_memory("a histogram");
    for (int row = 0; row < blocks->rows; row++)
        for (int column = 0; column < blocks->columns; column++, total++)
            histogram[block_mean(photo, blocks, column, row)]++;
    *black = *white = 0;
    for (unsigned grey = 0; grey < 65536; grey++) {
        if (below <= total / 200)
            *black = grey;
        if (below <= total - total / 200)
            *white = grey;
        below += histogram[grey];
    }
    if (*white <= *black)
        *white = *black + 1;
    free(histogram);
    return 0;
}

static void fill(cairo_surface_t *surface, const struct photo *photo, const struct blocks *blocks, unsigned black,
                 unsigned white)
{
    unsigned char *data = cairo_image_surface_get_data(surface);
    int stride = cairo_image_surface_get_stride(surface);
    cairo_surface_flush(surface);
    for (int row = 0; row < blocks->rows; row++) {
        uint32_t *line = (uint32_t *)(void *)(data + (size_t)row * (size_t)stride);
        for (int column = 0; column < blocks->columns; column++) {
            double grey = ((double)block_mean(photo, blocks, column, row) - black) / ((double)white - black);
            line[column] = 0x010101u * (uint32_t)(255 * fmin(fmax(grey, 0), 1));
        }
    }
    cairo_surface_mark_dirty(surface);
}

int draw_photo(cairo_t *cairo, const struct photo *photo, const struct photo_view *view, double width, double height)
{
    struct blocks blocks = cut_blocks(photo, view, width);
    unsigned black, white;
    if (blocks.columns <= 0 || blocks.rows <= 0)
        return error_input("the photo does not show the packing: check scale_m_per_px and origin_px of the scene");
    if (find_greys(photo, &blocks, &black, &white))
        return -1;
    cairo_surface_t *surface = cairo_image_surface_create(CAIRO_FORMAT_RGB24, blocks.columns, blocks.rows);
    if (cairo_surface_status(surface) != CAIRO_STATUS_SUCCESS) {
        cairo_surface_destroy(surface);
        return error_memory("the photo in a picture");
    }
    fill(surface, photo, &blocks, black, white);
    cairo_save(cairo);
    cairo_rectangle(cairo, 0, 0, width, height);
    cairo_clip(cairo);
    cairo_scale(cairo, width / (view->x1 - view->x0), height / (view->y1 - view->y0));
    cairo_translate(cairo, blocks.x0 - 0.5 - view->x0, blocks.y0 - 0.5 - view->y0);
    cairo_scale(cairo, blocks.factor, blocks.factor);
    cairo_set_source_surface(cairo, surface, 0, 0);
    cairo_pattern_set_filter(cairo_get_source(cairo), CAIRO_FILTER_GOOD);
    cairo_paint(cairo);
    cairo_restore(cairo);
    cairo_surface_destroy(surface);
    return 0;
}
