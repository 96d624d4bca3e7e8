/* A drawing becomes a picture on the page and, where a folder is named, a file of its own. */
#ifndef REPORT_PICTURE_H
#define REPORT_PICTURE_H

#include "pipeline/draw/canvas.h"
#include "report/page/html.h"

/* Drawn once for the page, and once more for a file: draw() must draw the same each time. Everything is borrowed. */
struct picture {
    const char *title;
    double width, height; /* px */
    /* Draws `what` into (0, 0, width, height) of the canvas; -1 with the error set. */
    int (*draw)(struct canvas *canvas, const void *what);
    const void *what;
};

/* Inside the page in that format, PNG or SVG; as html->pictures/TITLE.EXTENSION, spaces and signs of the title as "-".
 */
int picture_put(const struct picture *picture, enum canvas_format format, struct html *html);

#endif
