/* The photo side as a picture: found or tracked rims over the photo, flagged ones marked, motions as arrows. */
#ifndef REPORT_PHOTO_MAP_H
#define REPORT_PHOTO_MAP_H

#include "pipeline/draw/canvas.h"
#include "pipeline/packing/grains.h"
#include "pipeline/scene/photo.h"

struct photo_map {
    const struct photo_grains *grains;
    const struct photo *photo; /* NULL: white */
    const char *title;
    double width;  /* px of the picture */
    double arrows; /* length of an arrow over that of the motion since the reference; 0: none, NaN: chosen */
    /* set by photo_map_measure(): px; px of the picture per px of the photo; px of the photo at the left and the top of
     * the view; px of the view without the legend */
    double height, scale, x0, y0, view_height;
};

/* The view: the grains with a margin. Rims are drawn as seen where the file says so (x_seen_px). An input error when no
 * grain has a place. */
int photo_map_measure(struct photo_map *map);
/* Into (0, 0, width, height) of the canvas; the error of photo_background(). */
int photo_map_draw(const struct photo_map *map, struct canvas *canvas);
/* Measure and draw into a file, written whole or not at all. */
int photo_map_write(struct photo_map *map, const char *path);

#endif
