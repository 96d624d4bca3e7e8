/* The force map: every contact force as a line between the centres, as wide as fn; walls; what is wrong, marked. (A map
 * in forces/ is an estimator; here, and in photo_map.h, it is a picture.) */
#ifndef REPORT_FORCE_MAP_H
#define REPORT_FORCE_MAP_H

#include <math.h>

#include "pipeline/draw/canvas.h"
#include "pipeline/packing/packing.h"
#include "pipeline/scene/photo.h"
#include "pipeline/scene/scene.h"

#define FORCE_MAP_WIDTH 1400 /* px, unless something else is asked for */

/* A part of the plane, m. */
struct force_map_box {
    double x0, y0, x1, y1;
};
#define FORCE_MAP_BOX_NONE                                                                                             \
    {                                                                                                                  \
        INFINITY, INFINITY, -INFINITY, -INFINITY                                                                       \
    }
/* Widen the box by everything that a packing has: walls and rims, but for those without a place. */
void force_map_box_add(struct force_map_box *box, const struct packing *packing);
/* <fn> over loaded contacts; NaN when none is loaded. N. */
double force_map_mean_fn(const struct forces *forces);

/* What to draw; everything is borrowed. */
struct force_map {
    const struct packing *packing;
    const struct forces *forces;     /* NULL: contacts only */
    const struct photo *photo;       /* background; NULL: circles */
    const struct scene *scene;       /* places the photo; NULL without one */
    const char *title;               /* NULL: none */
    double mean_fn;                  /* N: drawn as the unit of width; NaN: of this state */
    double width;                    /* px; below 100: FORCE_MAP_WIDTH */
    const struct force_map_box *box; /* what to show, m; NULL: this packing */
    /* set by force_map_measure() */
    double height, scale, x0, y1; /* px, px/m, m: left and top of the view */
    double view_height, margin;   /* px: without the legend; around the walls and rims */
};

/* Choose the view: walls and rims with a margin. An input error when no grain has a place. */
int force_map_measure(struct force_map *map);
/* Draw into (0, 0, width, height); -1: no memory, or a photo that does not show the packing. */
int force_map_draw(const struct force_map *map, struct canvas *canvas);
/* Measure and draw into a file, written whole or not at all. */
int force_map_write(struct force_map *map, const char *path);

/* Parts of it: the force that gets the unit of width (N), the width of a force (px), how many contacts bear more than
 * the eight units at which the width ends, what stands below the map. */
double force_map_unit_fn(const struct force_map *map);
double force_map_line_width(const struct force_map *map, double fn);
size_t force_map_cut_lines(const struct force_map *map);
void force_map_legend(const struct force_map *map, struct canvas *canvas);

#endif
