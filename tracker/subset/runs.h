/* Which pixels of the reference a subset has: those of a disc or a rectangle that may be used, row by row. */
#ifndef TRACKER_RUNS_H
#define TRACKER_RUNS_H

#include <stddef.h>

#include "pipeline/scene/photo.h"

struct shape {
    double cx, cy;         /* centre, px */
    double radius;         /* of the disc; of the circle around a rectangle */
    double half_w, half_h; /* of the rectangle; 0: a disc */
};

/* Pixels (x + 0 .. x + count - 1, y), stored from `offset` on. */
struct run {
    int x, y, count;
    size_t offset;
};

/* Which pixels of the reference may be used. */
struct subset_mask {
    uint16_t saturation;            /* grey values from here on are left out; 0: none */
    const struct shape *neighbours; /* discs whose pixels are left out */
    size_t neighbour_count;
    const struct photo *photo; /* the photo to be searched: pixels that `x y` carry beyond its border are left out; */
    double u, v, angle;        /* NULL: none */
};

/* Pixels as stretches of rows, which loops take many at a time. */
struct runs {
    struct run *items; /* from top to bottom, in a row from left to right; to be freed with free() */
    size_t count;
    size_t pixels;    /* of all runs */
    double used;      /* share of the shape's pixels (those beyond the border too) that they are */
    size_t saturated; /* pixels left out at the upper end of the grey range */
};

/* The runs of the shape, at least SLOPES_REACH px from the border of the reference. Fails only for lack of memory. */
int runs_find(const struct photo *reference, const struct shape *shape, const struct subset_mask *mask,
              struct runs *runs);

#endif
