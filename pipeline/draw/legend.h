/* What a legend is made of: samples with words, and a bar that tells lengths. What stands where is up to the picture:
 * maps have theirs below, charts above. */
#ifndef DRAW_LEGEND_H
#define DRAW_LEGEND_H

#include "pipeline/draw/words.h"

/* A sample of how something is drawn, and what it is. */
struct legend_entry {
    enum { LEGEND_LINE, LEGEND_RING, LEGEND_PATCH } sample;
    struct pen pen;
    double length; /* px of a line or a patch; a ring has 7/22 of it as its radius */
    double gap;    /* px between the sample and the words */
    double size;   /* of the letters */
    const char *text;
};

/* The sample alone, the middle of its left end at (x, y); with its words, `drop` px below that. */
void legend_sample(struct canvas *canvas, const struct legend_entry *entry, double x, double y);
void legend_draw(struct canvas *canvas, const struct legend_entry *entry, double x, double y, double drop);

/* A bar that says how long `text` is: `length` px, its right end at (right, y), `width` thick, the words centred `drop`
 * px below. */
void legend_scale(struct canvas *canvas, double right, double y, double length, double width, double drop, double size,
                  const char *text);

#endif
