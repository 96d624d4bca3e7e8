/* cairo writes SVG and PDF while it draws and when the surface is finished, PNG at the end. All go to memory first,
 * then into the temporary file: so every write that the disk refuses is seen here, which cairo does not always tell,
 * and a file is whole or not there (pipeline/files/new_file.h). */
#include "pipeline/draw/canvas.h"

#include <cairo-pdf.h>
#include <cairo-svg.h>
#include <fontconfig/fontconfig.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "pipeline/speak/error.h"

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

int canvas_check_path(const char *path)
{
    enum canvas_format format;
    return path ? canvas_format_of(path, &format) : 0;
}

/* ---- begin ---- */

/* Memory or disk: a failure. Anything else: numbers in the file that no picture can show. */
static int not_drawn(cairo_status_t status)
{
    const char *reason = cairo_status_to_string(status);
    if (status == CAIRO_STATUS_NO_MEMORY || status == CAIRO_STATUS_WRITE_ERROR)
        return error_failed("the picture cannot be made: %s: make it smaller", reason);
    return error_input("the picture cannot be made: %s: look for absurd numbers in the file", reason);
}

/* Grows by doubling, so that the whole takes time in proportion to its length. -1: memory; the failure is kept. */
static int append(struct canvas_bytes *bytes, const void *data, size_t length)
{
    if (bytes->length + length > bytes->capacity) {
        size_t capacity = 2 * bytes->capacity + length + 4096;
        unsigned char *grown = realloc(bytes->data, capacity);
        bytes->failed |= !grown;
        if (!grown)
            return -1;
        bytes->data = grown;
        bytes->capacity = capacity;
    }
    memcpy(bytes->data + bytes->length, data, length);
    bytes->length += length;
    return 0;
}

/* What cairo calls with each part of a picture. */
static cairo_status_t keep(void *bytes, const unsigned char *data, unsigned int length)
{
    return append(bytes, data, length) ? CAIRO_STATUS_NO_MEMORY : CAIRO_STATUS_SUCCESS;
}

/* A surface of canvas->format, painted white. */
static int start(struct canvas *canvas, double width, double height)
{
    canvas->bytes = calloc(1, sizeof *canvas->bytes);
    if (!canvas->bytes) {
        canvas_discard(canvas);
        return error_memory("a picture");
    }
    if (canvas->format == CANVAS_SVG) {
        canvas->surface = cairo_svg_surface_create_for_stream(keep, canvas->bytes, width, height);
        cairo_svg_surface_set_document_unit(canvas->surface, CAIRO_SVG_UNIT_PX);
    } else if (canvas->format == CANVAS_PDF) {
        canvas->surface = cairo_pdf_surface_create_for_stream(keep, canvas->bytes, width, height);
        /* The same picture is the same bytes, whenever it is made. */
        cairo_pdf_surface_set_metadata(canvas->surface, CAIRO_PDF_METADATA_CREATE_DATE, "1970-01-01T00:00:00Z");
    } else {
        canvas->surface = cairo_image_surface_create(CAIRO_FORMAT_RGB24, (int)ceil(width), (int)ceil(height));
    }
    canvas->cairo = cairo_create(canvas->surface);
    cairo_status_t status = cairo_status(canvas->cairo);
    if (status != CAIRO_STATUS_SUCCESS) {
        canvas_discard(canvas);
        return not_drawn(status);
    }
    cairo_set_source_rgb(canvas->cairo, 1, 1, 1);
    cairo_paint(canvas->cairo);
    return 0;
}

int canvas_begin_memory(struct canvas *canvas, enum canvas_format format, double width, double height)
{
    *canvas = (struct canvas){.format = format};
    return start(canvas, width, height);
}

int canvas_begin(struct canvas *canvas, const char *path, double width, double height)
{
    *canvas = (struct canvas){0};
    if (canvas_format_of(path, &canvas->format) || new_file_begin(&canvas->file, path))
        return -1;
    return start(canvas, width, height);
}

int canvas_keep_words(struct canvas *canvas)
{
    if (canvas->format != CANVAS_SVG)
        return 0;
    canvas->words = open_memstream(&canvas->word_text, &canvas->word_length);
    return canvas->words ? 0 : error_memory("the words of a picture");
}

/* ---- end ---- */

void canvas_discard(struct canvas *canvas)
{
    if (canvas->cairo)
        cairo_destroy(canvas->cairo);
    if (canvas->surface)
        cairo_surface_destroy(canvas->surface); /* an SVG in memory writes its end */
    if (canvas->words)
        fclose(canvas->words);
    if (canvas->bytes)
        free(canvas->bytes->data);
    free(canvas->word_text);
    free(canvas->bytes);
    new_file_discard(&canvas->file);
    *canvas = (struct canvas){0};
}

/* The kept words stand before the end of the SVG that cairo has written. */
static int put_words(struct canvas *canvas)
{
    static const char end[] = "</svg>\n";
    struct canvas_bytes *bytes = canvas->bytes;
    int failed = ferror(canvas->words) | fclose(canvas->words);
    canvas->words = NULL;
    if (bytes->length >= strlen(end))
        bytes->length -= strlen(end);
    return failed || append(bytes, canvas->word_text, canvas->word_length) || append(bytes, end, strlen(end));
}

/* All bytes of the picture. cairo tells of trouble in three places: the drawing, the surface, and, when its last bytes
 * found no memory, not at all. */
static int finish(struct canvas *canvas)
{
    cairo_status_t status = cairo_status(canvas->cairo);
    if (status == CAIRO_STATUS_SUCCESS && canvas->format == CANVAS_PNG)
        status = cairo_surface_write_to_png_stream(canvas->surface, keep, canvas->bytes);
    cairo_surface_finish(canvas->surface); /* SVG and PDF are written now */
    if (status == CAIRO_STATUS_SUCCESS)
        status = cairo_surface_status(canvas->surface);
    if (status == CAIRO_STATUS_SUCCESS && (canvas->bytes->failed || (canvas->words && put_words(canvas))))
        status = CAIRO_STATUS_NO_MEMORY;
    return status == CAIRO_STATUS_SUCCESS ? 0 : not_drawn(status);
}

/* The temporary file beside the target; new_file_commit() gives it the name. */
static int write_bytes(const struct canvas *canvas)
{
    FILE *file = fopen(canvas->file.temporary, "wb");
    int whole = file && fwrite(canvas->bytes->data, 1, canvas->bytes->length, file) == canvas->bytes->length;
    if (file && fclose(file) == 0 && whole)
        return 0;
    return error_failed("%s: cannot be written: check the room on the disk", canvas->file.path);
}

int canvas_commit(struct canvas *canvas)
{
    int result = finish(canvas) || write_bytes(canvas) ? -1 : new_file_commit(&canvas->file);
    canvas_discard(canvas);
    return result;
}

int canvas_take(struct canvas *canvas, unsigned char **data, size_t *length)
{
    int result = finish(canvas);
    *data = result ? NULL : canvas->bytes->data;
    *length = result ? 0 : canvas->bytes->length;
    if (!result)
        canvas->bytes->data = NULL;
    canvas_discard(canvas);
    return result;
}

int canvas_end(struct canvas *canvas, int failed)
{
    if (!failed)
        return canvas_commit(canvas);
    canvas_discard(canvas);
    return -1;
}

/* ---- where things are drawn ---- */

void canvas_move(struct canvas *canvas, double dx, double dy, double angle)
{
    cairo_save(canvas->cairo);
    cairo_translate(canvas->cairo, dx, dy);
    cairo_rotate(canvas->cairo, angle);
}

void canvas_clip(struct canvas *canvas, double x, double y, double width, double height)
{
    cairo_save(canvas->cairo);
    cairo_rectangle(canvas->cairo, x, y, width, height);
    cairo_clip(canvas->cairo);
}

void canvas_restore(struct canvas *canvas)
{
    cairo_restore(canvas->cairo);
}

void canvas_forget_fonts(void)
{
    cairo_debug_reset_static_data();
    FcFini();
}
