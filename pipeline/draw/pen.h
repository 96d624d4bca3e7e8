/* Lines and shapes, and the one palette of all pictures. A pen says how they look; with width 0 the shape is filled. */
#ifndef DRAW_PEN_H
#define DRAW_PEN_H

#include <stddef.h>

#include "pipeline/draw/canvas.h"

/* Blue to yellow are told apart with any colour vision (Okabe and Ito 2008); the others are paper and ink. Between them
 * two colours of one picture never mean the same. */
enum colour {
    COLOUR_INK,
    COLOUR_BLUE,
    COLOUR_VERMILLION,
    COLOUR_GREEN,
    COLOUR_ORANGE,
    COLOUR_PURPLE,
    COLOUR_SKY,
    COLOUR_YELLOW,
    COLOUR_GREY,
    COLOUR_GRID,  /* lines behind a chart */
    COLOUR_GRAIN, /* the face of a grain that bears forces */
    COLOUR_WHITE
};

/* Zero is an opaque fill in ink; what is said of a line does not matter to a fill. Lengths are px. */
struct pen {
    enum colour colour;
    double width;                /* 0: fill */
    double clear;                /* 0: opaque, to 1: not seen */
    double dash[2];              /* length of a dash and of the gap behind it; 0: none */
    int round_ends, round_joins; /* of the line, and of its corners; else square and pointed */
};

/* A path of one's own: begin, move and go, close where it returns; pen_draw() draws and forgets it. */
void pen_begin(struct canvas *canvas);
void pen_move(struct canvas *canvas, double x, double y);
void pen_go(struct canvas *canvas, double x, double y); /* in a straight line; the first point after pen_begin() */
void pen_close(struct canvas *canvas);
void pen_draw(struct canvas *canvas, const struct pen *pen);
/* What pen_draw() draws with, for a path that words.c makes of letters. */
void pen_set(struct canvas *canvas, const struct pen *pen);

void pen_segment(struct canvas *canvas, const struct pen *pen, double x0, double y0, double x1, double y1);
void pen_circle(struct canvas *canvas, const struct pen *pen, double x, double y, double radius);
void pen_rectangle(struct canvas *canvas, const struct pen *pen, double x, double y, double width, double height);
/* With a head of 7 `unit`, or half of a shorter arrow; arrows below half a `unit` are left out. */
void pen_arrow(struct canvas *canvas, const struct pen *pen, double x0, double y0, double x1, double y1, double unit);

/* Around (x, y) `count` directions share the circle, direction k at k / count of a turn, counter-clockwise as seen and
 * from the right. A sector is the slice of one of them; arcs are the outline of all, each with its own radius. */
void pen_sector(struct canvas *canvas, const struct pen *pen, double x, double y, double radius, int k, int count);
void pen_arcs(struct canvas *canvas, const struct pen *pen, double x, double y, const double radius[], int count);

#endif
