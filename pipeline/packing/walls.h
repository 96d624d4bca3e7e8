/* Walls: straight segments with the interior on their left (x0 y0 -> x1 y1), and convex corner discs (centre x0 y0,
 * radius > 0). Names: "bottom" "right" "top" "left"; discs "bottom-left" and so on. In contacts, wall w is j = N + w.
 * Going round counter-clockwise (y up) keeps the interior on the left: bottom runs left to right, right runs upwards.
 *
 * A wall whose load along its normal is finite is free along that normal; NaN: fixed, its reaction is a result. A
 * corner disc moves in x with the side wall and in y with the top or bottom wall, and its contact forces enter their
 * equations. */
#ifndef PIPELINE_WALLS_H
#define PIPELINE_WALLS_H

#include "pipeline/state/columns.h"
#include "pipeline/numbers/geometry.h"

struct walls {
    size_t count;
    char (*name)[NAME_LENGTH];
    double *x0, *y0, *x1, *y1; /* m */
    double *radius;            /* m; 0 for a segment */
    double *fx, *fy;           /* N: force from outside on the wall (right wall in compression: fx < 0); NaN: fixed */
    double *s_offset;          /* m: standard error of the position along the normal */
    double *s_angle;           /* rad */
    double *dx, *dy, *dangle;  /* m, m, rad: motion of the segment's middle since the previous state */
    uint32_t *flags;
};
extern const struct table_kind WALLS;

static inline int wall_is_disc(const struct walls *walls, size_t w)
{
    return walls->radius[w] > 0;
}

/* Unit vector along a segment, from (x0, y0) to (x1, y1). */
static inline struct vec wall_direction(const struct walls *walls, size_t w)
{
    return vec_unit(vec(walls->x1[w] - walls->x0[w], walls->y1[w] - walls->y0[w]));
}

/* Middle of a segment, centre of a disc. */
static inline struct vec wall_middle(const struct walls *walls, size_t w)
{
    return vec(0.5 * (walls->x0[w] + walls->x1[w]), 0.5 * (walls->y0[w] + walls->y1[w]));
}

/* Unit normal of a segment, pointing into the specimen. */
static inline struct vec wall_inward(const struct walls *walls, size_t w)
{
    return vec_turn(wall_direction(walls, w));
}

/* Load on a segment along its inward normal, N; NaN: not given, the wall is fixed, or a disc. A component at right
 * angles to the normal may be missing. */
double wall_load(const struct walls *walls, size_t w);
/* Does wall w move along its normal? Its load there is given, and it is no reaction: of opposite walls that are both
 * loaded, which could drift away together, left and bottom bear what is needed for the balance. */
int wall_moves(const struct walls *walls, size_t w);

/* Row of the wall of that name ("bottom", "bottom-left"), or -1 without an error. */
long walls_find(const struct walls *walls, const char *name);
/* Area of the polygon between the lines of the four segments, m2; NaN without all four. */
double walls_area(const struct walls *walls);

#endif
