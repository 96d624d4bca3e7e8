/* The force map: every contact force as a line between the centres, as wide as fn; walls; what is wrong, marked. */
#ifndef REPORT_MAP_H
#define REPORT_MAP_H

#include <cairo.h>
#include <math.h>

#include "pipeline/packing/packing.h"
#include "pipeline/scene/photo.h"
#include "pipeline/scene/scene.h"

#define MAP_WIDTH 1400

/* A part of the plane, m. */
struct map_box {
    double x0, y0, x1, y1;
};
#define MAP_BOX_NONE                                                                                                   \
    {                                                                                                                  \
        INFINITY, INFINITY, -INFINITY, -INFINITY                                                                       \
    }
/* Widen the box by everything that a packing has: walls and rims. */
void map_box_add(struct map_box *box, const struct packing *packing);
/* <fn> over loaded contacts; NaN when none is loaded. N. */
double map_mean_fn(const struct forces *forces);

struct map {
    const struct packing *packing;
    const struct forces *forces; /* NULL: contacts only */
    const struct photo *photo;   /* background; NULL: circles */
    const struct scene *scene;   /* places the photo; NULL without one */
    const char *title;
    double mean_fn;            /* N: drawn as the unit of width; NaN: of this state */
    double width;              /* px */
    const struct map_box *box; /* what to show, m; NULL: this packing */
    /* set by map_measure() */
    double height, scale, x0, y1; /* px, px/m, m: left and top of the view */
    double view_height, margin;   /* px: without the legend; around the walls and rims */
};

/* Choose the view: walls and rims with a margin. Error when no grain has a place. */
int map_measure(struct map *map);
/* Draw into (0, 0, width, height). */
int map_draw(const struct map *map, cairo_t *cairo);

/* Parts of it: the force that gets the unit of width (N), the width of a force (px), how many contacts bear more than
 * the eight units at which the width ends, what stands below the map. */
double map_unit_fn(const struct map *map);
double map_line_width(const struct map *map, double fn);
size_t map_cut_lines(const struct map *map);
void map_legend(const struct map *map, cairo_t *cairo);

#endif
