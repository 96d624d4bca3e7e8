/* Words in a picture: sans-serif, in ink. '?' stands for what text_clean() (pipeline/speak/text.h) replaces: cairo
 * draws UTF-8 or nothing at all. Sizes are those of the letters, in px. */
#ifndef DRAW_WORDS_H
#define DRAW_WORDS_H

#include "pipeline/draw/pen.h"

/* The width that a text takes, px of the canvas before canvas_move() turns it. */
double words_width(struct canvas *canvas, double size, int bold, const char *text);
/* With the left end, the middle or the right end (align 0, 0.5, 1) of the baseline at (x, y). */
void words_draw(struct canvas *canvas, double x, double y, double align, double size, int bold, const char *text);
/* From the left, in a smaller size where the text would be wider than `width`. */
void words_within(struct canvas *canvas, double x, double y, double width, double size, int bold, const char *text);
/* Letters of a colour with a black edge, to be read over a photo; the left end of the baseline at (x, y). */
void words_over_photo(struct canvas *canvas, double x, double y, double size, enum colour colour, const char *text);

#endif
