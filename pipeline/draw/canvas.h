/* A picture on cairo that ends as a whole file or not at all, PNG, SVG or PDF by its ending, or as bytes in memory.
 * This room alone includes cairo's headers (tests/unit/test_directions holds it): others draw with pen.h, words.h,
 * chart.h, legend.h and photo_background.h on a canvas whose insides they cannot use.
 *
 * Lengths are px in PNG and SVG, points in PDF; x runs right and y down from the upper left corner. */
#ifndef DRAW_CANVAS_H
#define DRAW_CANVAS_H

#include <stddef.h>
#include <stdio.h>

#include "pipeline/files/new_file.h"

enum canvas_format { CANVAS_PNG, CANVAS_SVG, CANVAS_PDF };

/* The bytes of a picture as they come from cairo, which says nothing when memory runs out as it writes its last. */
struct canvas_bytes {
    unsigned char *data;
    size_t length, capacity;
    int failed;
};

struct canvas {
    struct _cairo *cairo;
    struct _cairo_surface *surface;
    enum canvas_format format;
    struct new_file file;       /* empty when the picture stays in memory */
    struct canvas_bytes *bytes; /* not inside the canvas: cairo keeps the address */
    FILE *words;                /* canvas_keep_words(): <text> elements, written into word_text; NULL: glyphs */
    char *word_text;
    size_t word_length;
};

/* The format that a path asks for: 0; an input error that names the choices for other endings. */
int canvas_format_of(const char *path, enum canvas_format *format);
/* Can a picture of that name be drawn? To be asked before the work that it shows. NULL, no picture, is fine. */
int canvas_check_path(const char *path);

/* A white canvas of that size, whose picture becomes the file `path`. -1 with the error set and nothing to free: an
 * ending without a format, a folder that is absent, a size that cairo refuses. */
int canvas_begin(struct canvas *canvas, const char *path, double width, double height);
/* The same for canvas_take(). */
int canvas_begin_memory(struct canvas *canvas, enum canvas_format format, double width, double height);
/* Texts of an SVG stay texts, which can be searched and copied, in the reader's sans-serif and over all else; without
 * it, and in PNG and PDF, their letters are drawn and look the same everywhere. -1: memory. */
int canvas_keep_words(struct canvas *canvas);

/* Write the file, whole or not at all: a failure (disk, memory) or an input error (numbers that no picture can show).
 * The canvas is freed whatever happens. */
int canvas_commit(struct canvas *canvas);
/* Its bytes, to be freed by the caller, NULL after an error; the canvas is freed whatever happens. */
int canvas_take(struct canvas *canvas, unsigned char **bytes, size_t *length);
/* End a drawing of which `failed` says whether it went wrong: then nothing is left of it and the error stands. */
int canvas_end(struct canvas *canvas, int failed);
/* Free without a picture; accepts a zeroed struct. */
void canvas_discard(struct canvas *canvas);

/* The origin moves right by dx and down by dy, and what is drawn is turned by `angle` (radians, clockwise as seen),
 * until canvas_restore(). */
void canvas_move(struct canvas *canvas, double dx, double dy, double angle);
/* Nothing shows outside the rectangle, until canvas_restore(). */
void canvas_clip(struct canvas *canvas, double x, double y, double width, double height);
/* Undo the last canvas_move() or canvas_clip(). */
void canvas_restore(struct canvas *canvas);

/* Give back the fonts that cairo keeps for the life of a process; call it last. */
void canvas_forget_fonts(void);

#endif
