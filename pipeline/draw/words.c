/* cairo shows letters as outlines, in every format. In an SVG whose canvas keeps its words they become <text> elements
 * instead, at the place on the page that user coordinates have there; their widths, which the layout needs, are still
 * those of the fonts of this machine. */
#include "pipeline/draw/words.h"

#include <cairo.h>
#include <math.h>

#include "pipeline/speak/text.h"

enum { LONGEST_TEXT = 1000 };

/* The size is that of the letters' em, px. */
static void choose_font(cairo_t *cairo, double size, int bold)
{
    cairo_select_font_face(cairo, "sans-serif", CAIRO_FONT_SLANT_NORMAL,
                           bold ? CAIRO_FONT_WEIGHT_BOLD : CAIRO_FONT_WEIGHT_NORMAL);
    cairo_set_font_size(cairo, size);
}

double words_width(struct canvas *canvas, double size, int bold, const char *text)
{
    char clean[LONGEST_TEXT];
    cairo_text_extents_t extents;
    choose_font(canvas->cairo, size, bold);
    text_clean(text, clean, sizeof clean);
    cairo_text_extents(canvas->cairo, clean, &extents);
    return extents.x_advance;
}

/* An element of SVG where the canvas keeps its words; nothing from outside becomes markup. */
static void keep(struct canvas *canvas, double x, double y, double align, double size, int bold, const char *clean)
{
    cairo_matrix_t matrix;
    FILE *file = canvas->words;
    cairo_get_matrix(canvas->cairo, &matrix);
    cairo_user_to_device(canvas->cairo, &x, &y);
    fprintf(file, "<text x=\"%.2f\" y=\"%.2f\" font-family=\"sans-serif\" font-size=\"%g\" fill=\"#222\"", x, y, size);
    if (bold)
        fputs(" font-weight=\"bold\"", file);
    if (align > 0)
        fprintf(file, " text-anchor=\"%s\"", align < 1 ? "middle" : "end");
    if (matrix.yx != 0)
        fprintf(file, " transform=\"rotate(%g %.2f %.2f)\"", atan2(matrix.yx, matrix.xx) * 180 / M_PI, x, y);
    fputc('>', file);
    for (; *clean; clean++)
        if (*clean == '<')
            fputs("&lt;", file);
        else if (*clean == '&')
            fputs("&amp;", file);
        else
            fputc(*clean, file);
    fputs("</text>\n", file);
}

void words_draw(struct canvas *canvas, double x, double y, double align, double size, int bold, const char *text)
{
    char clean[LONGEST_TEXT];
    text_clean(text, clean, sizeof clean);
    if (canvas->words) {
        keep(canvas, x, y, align, size, bold, clean);
        return;
    }
    pen_set(canvas, &(struct pen){COLOUR_INK, .width = 1});
    cairo_move_to(canvas->cairo, x - align * words_width(canvas, size, bold, text), y);
    cairo_show_text(canvas->cairo, clean);
}

void words_within(struct canvas *canvas, double x, double y, double width, double size, int bold, const char *text)
{
    double wide = words_width(canvas, size, bold, text);
    words_draw(canvas, x, y, 0, wide > width ? size * width / wide : size, bold, text);
}

/* The edge is a line of a fifth of the size along the outline, half of which the letters then cover. */
void words_over_photo(struct canvas *canvas, double x, double y, double size, enum colour colour, const char *text)
{
    cairo_t *cairo = canvas->cairo;
    choose_font(cairo, size, 0);
    pen_set(canvas, &(struct pen){colour, .width = 0.2 * size, .round_joins = 1});
    cairo_move_to(cairo, x, y);
    cairo_text_path(cairo, text);
    cairo_set_source_rgb(cairo, 0, 0, 0);
    cairo_stroke_preserve(cairo);
    pen_draw(canvas, &(struct pen){.colour = colour});
}
