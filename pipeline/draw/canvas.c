#include "pipeline/draw/canvas.h"

#include <cairo-pdf.h>
#include <cairo-svg.h>
#include <fontconfig/fontconfig.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "pipeline/speak/error.h"
#include "pipeline/speak/text.h"

int canvas_format_of(const char *path, enum canvas_format *format)
{
    static const char *const extensions[] = {".png", ".svg", ".pdf"};
    const char *dot = strrchr(path, '.');
    for (int k = 0; dot && k < 3; k++)
        if (!strcasecmp(dot, extensions[k])) {
            *format = (enum canvas_format)k;
            return 0;
        }
    return error_input("%s: no picture format has this ending: name it .png, .svg or .pdf", path);
}

/* Memory or disk: a failure. Anything else: numbers in the file that no picture can show. */
static int not_drawn(cairo_status_t status)
{
    const char *reason = cairo_status_to_string(status);
    if (status == CAIRO_STATUS_NO_MEMORY || status == CAIRO_STATUS_WRITE_ERROR)
        return error_failed("the picture cannot be made: %s: make it smaller", reason);
    return error_input("the picture cannot be made: %s: look for absurd numbers in the file", reason);
}

static int start(struct canvas *canvas)
{
    canvas->cairo = cairo_create(canvas->surface);
    if (cairo_status(canvas->cairo) != CAIRO_STATUS_SUCCESS) {
        cairo_status_t status = cairo_status(canvas->cairo);
        canvas_discard(canvas);
        return not_drawn(status);
    }
    cairo_set_source_rgb(canvas->cairo, 1, 1, 1);
    cairo_paint(canvas->cairo);
    return 0;
}

static cairo_status_t append(void *closure, const unsigned char *data, unsigned int length)
{
    struct canvas_bytes *bytes = closure;
    if (bytes->length + length > bytes->capacity) {
        size_t capacity = 2 * bytes->capacity + length + 4096;
        unsigned char *grown = realloc(bytes->data, capacity);
        bytes->failed |= !grown;
        if (!grown)
            return CAIRO_STATUS_NO_MEMORY;
        bytes->data = grown;
        bytes->capacity = capacity;
    }
    memcpy(bytes->data + bytes->length, data, length);
    bytes->length += length;
    return CAIRO_STATUS_SUCCESS;
}

int canvas_begin_memory(struct canvas *canvas, enum canvas_format format, double width, double height)
{
    memset(canvas, 0, sizeof *canvas);
    canvas->format = format;
    canvas->bytes = calloc(1, sizeof *canvas->bytes);
    if (!canvas->bytes)
        return error_memory("a picture");
    if (format == CANVAS_SVG) {
        canvas->surface = cairo_svg_surface_create_for_stream(append, canvas->bytes, width, height);
        cairo_svg_surface_set_document_unit(canvas->surface, CAIRO_SVG_UNIT_PX);
    } else {
        canvas->surface = cairo_image_surface_create(CAIRO_FORMAT_RGB24, (int)ceil(width), (int)ceil(height));
    }
    return start(canvas);
}

int canvas_begin(struct canvas *canvas, const char *path, double width, double height)
{
    memset(canvas, 0, sizeof *canvas);
    if (canvas_format_of(path, &canvas->format) || new_file_begin(&canvas->file, path))
        return -1;
    if (canvas->format == CANVAS_SVG) {
        canvas->surface = cairo_svg_surface_create(canvas->file.temporary, width, height);
        cairo_svg_surface_set_document_unit(canvas->surface, CAIRO_SVG_UNIT_PX);
    } else if (canvas->format == CANVAS_PDF) {
        canvas->bytes = calloc(1, sizeof *canvas->bytes);
        if (!canvas->bytes) {
            new_file_discard(&canvas->file);
            return error_memory("a picture");
        }
        canvas->surface = cairo_pdf_surface_create_for_stream(append, canvas->bytes, width, height);
        cairo_pdf_surface_set_metadata(canvas->surface, CAIRO_PDF_METADATA_CREATE_DATE, "1970-01-01T00:00:00Z");
    } else {
        canvas->surface = cairo_image_surface_create(CAIRO_FORMAT_RGB24, (int)ceil(width), (int)ceil(height));
    }
    return start(canvas);
}

void canvas_discard(struct canvas *canvas)
{
    if (canvas->cairo)
        cairo_destroy(canvas->cairo);
    if (canvas->surface)
        cairo_surface_destroy(canvas->surface); /* an SVG in memory writes its end */
    if (canvas->bytes)
        free(canvas->bytes->data);
    free(canvas->bytes);
    new_file_discard(&canvas->file);
    memset(canvas, 0, sizeof *canvas);
}

/* cairo does not tell when the disk refuses what it writes of a PDF: those bytes are written here. */
static cairo_status_t write_bytes(const struct canvas *canvas)
{
    FILE *file = fopen(canvas->file.temporary, "wb");
    if (!file)
        return CAIRO_STATUS_WRITE_ERROR;
    int whole = fwrite(canvas->bytes->data, 1, canvas->bytes->length, file) == canvas->bytes->length;
    return fclose(file) == 0 && whole ? CAIRO_STATUS_SUCCESS : CAIRO_STATUS_WRITE_ERROR;
}

int canvas_commit(struct canvas *canvas)
{
    cairo_status_t status = cairo_status(canvas->cairo);
    if (status == CAIRO_STATUS_SUCCESS && canvas->format == CANVAS_PNG)
        status = cairo_surface_write_to_png(canvas->surface, canvas->file.temporary);
    cairo_surface_finish(canvas->surface);
    if (status == CAIRO_STATUS_SUCCESS)
        status = cairo_surface_status(canvas->surface);
    if (status == CAIRO_STATUS_SUCCESS && canvas->bytes)
        status = canvas->bytes->failed ? CAIRO_STATUS_NO_MEMORY : write_bytes(canvas);
    if (status != CAIRO_STATUS_SUCCESS) {
        (void)(status == CAIRO_STATUS_NO_MEMORY ? error_memory(canvas->file.path)
                                                : error_failed("%s: cannot be written: %s: check the room on the disk",
                                                               canvas->file.path, cairo_status_to_string(status)));
        canvas_discard(canvas);
        return -1;
    }
    int result = new_file_commit(&canvas->file);
    canvas_discard(canvas);
    return result;
}

int canvas_take(struct canvas *canvas, unsigned char **data, size_t *length)
{
    cairo_status_t status = cairo_status(canvas->cairo);
    if (status == CAIRO_STATUS_SUCCESS && canvas->format == CANVAS_PNG)
        status = cairo_surface_write_to_png_stream(canvas->surface, append, canvas->bytes);
    cairo_surface_finish(canvas->surface); /* SVG is written now */
    if (status == CAIRO_STATUS_SUCCESS)
        status = canvas->bytes->failed ? CAIRO_STATUS_NO_MEMORY : cairo_surface_status(canvas->surface);
    *data = canvas->bytes->data;
    *length = canvas->bytes->length;
    canvas->bytes->data = NULL;
    canvas_discard(canvas);
    if (status == CAIRO_STATUS_SUCCESS)
        return 0;
    free(*data);
    *data = NULL;
    return not_drawn(status);
}

enum { LONGEST_TEXT = 1000 };

double canvas_text_width(cairo_t *cairo, double size, int bold, const char *text)
{
    char clean[LONGEST_TEXT];
    cairo_text_extents_t extents;
    cairo_select_font_face(cairo, "sans-serif", CAIRO_FONT_SLANT_NORMAL,
                           bold ? CAIRO_FONT_WEIGHT_BOLD : CAIRO_FONT_WEIGHT_NORMAL);
    cairo_set_font_size(cairo, size);
    text_clean(text, clean, sizeof clean); /* cairo draws UTF-8 or nothing at all */
    cairo_text_extents(cairo, clean, &extents);
    return extents.x_advance;
}

void canvas_text(cairo_t *cairo, double x, double y, double align, double size, int bold, const char *text)
{
    char clean[LONGEST_TEXT];
    cairo_move_to(cairo, x - align * canvas_text_width(cairo, size, bold, text), y);
    text_clean(text, clean, sizeof clean);
    cairo_show_text(cairo, clean);
}

void canvas_text_within(cairo_t *cairo, double x, double y, double width, double size, int bold, const char *text)
{
    double wide = canvas_text_width(cairo, size, bold, text);
    canvas_text(cairo, x, y, 0, wide > width ? size * width / wide : size, bold, text);
}

void canvas_forget_fonts(void)
{
    cairo_debug_reset_static_data();
    FcFini();
}

double canvas_round_number(double value)
{
    double power = pow(10, floor(log10(value))), digit = value / power;
    return power * (digit >= 5 ? 5 : digit >= 2 ? 2 : 1);
}
