/* What stands around the photo in the picture of findgrains: ticks and numbers in px of the photo, and a caption. The
 * photo's top left corner is the picture's: the place of a cursor in the picture, over the zoom, is px of the photo. */
#ifndef FINDGRAINS_OVERLAY_SCALE_H
#define FINDGRAINS_OVERLAY_SCALE_H

#include <stddef.h>

#include "pipeline/draw/words.h"

#define OVERLAY_SIDE 4000.0 /* px of the longer side of the drawn photo at most; larger ones shrink to 1/2, 1/3 ... */
#define OVERLAY_ZOOM 4.0    /* smaller ones are magnified so many times at most */

struct overlay_facts {
    size_t grains, flagged, numbered; /* numbered: circles with the number of their row inside */
    int has_frame;
};

enum { OVERLAY_CAPTION_LINES = 5, OVERLAY_CAPTION_LENGTH = 512 };

/* Lengths in px of the picture, where nothing else is said. */
struct overlay_layout {
    double zoom;                   /* px of the picture per px of the photo: 4, 3, 2, 1, 1/2, 1/3 ... */
    int photo_width, photo_height; /* of the photo as it is drawn */
    int width, height;             /* of the picture */
    double text;                   /* size of the letters */
    double step;                   /* px of the photo between two numbers: 1, 2 or 5 times a power of ten */
    char caption[OVERLAY_CAPTION_LINES][OVERLAY_CAPTION_LENGTH]; /* "" after the last line */
};

/* A picture of a photo of width x height px, its longer side drawn with OVERLAY_SIDE px at most. */
void overlay_layout_make(int width, int height, struct overlay_layout *layout);
/* Write the caption and make room for it below the photo. */
void overlay_layout_caption(const struct overlay_facts *facts, struct overlay_layout *layout);
/* Size of the letters of a number inside a circle (radius in px of the photo); 0: it would be too small to be read. */
double overlay_number_size(const struct overlay_layout *layout, double radius_px, size_t number);
/* Paper, ticks and numbers around the photo, caption; the photo is left as it is, but for ticks along its border. */
void overlay_layout_draw(const struct overlay_layout *layout, struct canvas *canvas);

#endif
