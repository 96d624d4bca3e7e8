/* A cairo picture that ends as a whole file, PNG, SVG or PDF by its extension, or as bytes in memory. */
#ifndef REPORT_CANVAS_H
#define REPORT_CANVAS_H

#include <cairo.h>
#include <stddef.h>

#include "pipeline/files/new_file.h"

enum canvas_format { CANVAS_PNG, CANVAS_SVG, CANVAS_PDF };

struct canvas_bytes {
    unsigned char *data;
    size_t length, capacity;
    int failed; /* memory was out on the way: cairo does not tell when it writes a PDF */
};

struct canvas {
    cairo_t *cairo;
    cairo_surface_t *surface;
    enum canvas_format format;
    struct new_file file;       /* when it becomes a file */
    struct canvas_bytes *bytes; /* when it stays in memory */
};

/* The format that a path asks for; an error that names the choices for other extensions. */
int canvas_format_of(const char *path, enum canvas_format *format);
/* White. Sizes in px (PDF: points). */
int canvas_begin(struct canvas *canvas, const char *path, double width, double height);
int canvas_begin_memory(struct canvas *canvas, enum canvas_format format, double width, double height);
int canvas_commit(struct canvas *canvas);   /* frees the canvas whatever happens */
void canvas_discard(struct canvas *canvas); /* accepts a zeroed struct */
/* The bytes of a picture in memory, to be freed; the canvas is freed whatever happens. */
int canvas_take(struct canvas *canvas, unsigned char **bytes, size_t *length);

/* Give back the fonts that cairo keeps for the life of a process; call it last. */
void canvas_forget_fonts(void);

/* Colours that people with any colour vision tell apart (Okabe and Ito 2008), as red, green, blue. */
#define COLOUR_BLUE 0.000, 0.447, 0.698
#define COLOUR_VERMILLION 0.835, 0.369, 0.000
#define COLOUR_GREEN 0.000, 0.620, 0.451
#define COLOUR_ORANGE 0.902, 0.624, 0.000
#define COLOUR_PURPLE 0.800, 0.475, 0.655
#define COLOUR_SKY 0.337, 0.706, 0.914
#define COLOUR_INK 0.133, 0.133, 0.133
#define COLOUR_GREY 0.600, 0.600, 0.600

/* Choose the font; the width that the text takes in it. Here and below '?' stands for what text_clean() replaces. */
double canvas_text_width(cairo_t *cairo, double size, int bold, const char *text);
/* Text with its baseline's left end, middle or right end (align 0, 0.5, 1) at (x, y). */
void canvas_text(cairo_t *cairo, double x, double y, double align, double size, int bold, const char *text);
/* The same from the left, in a smaller size where the text would be wider than `width`. */
void canvas_text_within(cairo_t *cairo, double x, double y, double width, double size, int bold, const char *text);
/* The largest of 1, 2, 5 times a power of ten that is not above the value. */
double canvas_round_number(double value);

#endif
