/* A tile of the photo while it is painted: the scene sampled on cells, CELLS x CELLS per pixel.
 *
 * What is painted is the scene after a small blur by the cubic B-spline of one cell (variance cell^2 / 3), evaluated
 * in closed form from the signed distance to each edge; the sensor takes that variance off the point spread that it
 * still has to apply. So edges lie where they are told to, and the cells alias nothing that the eye or a fit could
 * see (docs/render.md has the numbers). */
#ifndef SIMULATION_TILE_H
#define SIMULATION_TILE_H

#include <math.h>
#include <stddef.h>

#include "pipeline/numbers/simd.h"
#include "simulation/render/camera.h"
#include "simulation/render/optics.h"

enum { CELLS = 4, TILE_PIXELS = 64 };

/* Part of a tile, in cells: columns x0 .. x1 - 1, rows y0 .. y1 - 1. */
struct window {
    int x0, y0, x1, y1;
};

struct tile {
    int pixel_x, pixel_y;      /* first pixel of the tile, without the margin */
    int margin;                /* px around it that the point spread needs */
    int width, height;         /* cells, margin included */
    double origin_x, origin_y; /* px: scene position that x and y count from */
    double cell;               /* px of the scene per cell */
    double to_cell[2][2];      /* cells per scene px, about the tile's middle */
    double bend;               /* cells: the furthest that this affine map errs within the tile */
    float *x, *y;              /* px: scene position of every cell's middle, from the origin */
    float *value, *cover;      /* light of the grains so far; share of the cell that they hide */
    float *layer, *back;       /* a surface before it is cut to its outline; what lies behind the grains */
};

/* Where a body lies: its middle and its rotation, counter-clockwise as seen (y down). */
struct pose {
    double x, y, cosine, sine;
};

static inline struct pose pose_of(double x, double y, double angle)
{
    return (struct pose){x, y, cos(angle), sin(angle)};
}

/* Share of a cell inside an edge whose signed distance is d cells (positive inside): the integral of the cubic
 * B-spline. Between -2 and 2 cells; no branches and no fmaxf(), so that compilers vectorise it. */
static inline float coverage(float d)
{
    float a = fabsf(d), p = 2 - a > 0 ? 2 - a : 0, q = 1 - a > 0 ? 1 - a : 0;
    float p2 = p * p, q2 = q * q, tail = (p2 * p2 - 4 * (q2 * q2)) * (1.0f / 24);
    return d > 0 ? 1 - tail : tail;
}

/* A disc's half-level lies inside its rim by variance / (2 R) after a blur: that variance is cell^2 / 3. */
static inline double coverage_radius(double radius, double cell)
{
    return radius - cell * cell / (6 * radius);
}

/* Room for a tile with this margin, px. 0, or -1 when memory is gone; tile_free() in either case. */
int tile_alloc(struct tile *tile, int margin);
void tile_free(struct tile *tile);
/* Go to a place in the photo: positions of all cells, no light yet. */
void tile_begin(struct tile *tile, const struct camera *camera, int pixel_x, int pixel_y);

/* Cells that can see a disc; empty windows have x0 >= x1 or y0 >= y1. */
struct window tile_window(const struct tile *tile, double x, double y, double radius);
struct window tile_whole(const struct tile *tile);

/* Fill the window of the layer with a surface: level, then its paint, all of it fixed to the body at `pose`. */
void speckle_surface(const struct tile *tile, struct window window, const struct surface *surface, double level,
                     struct pose pose, uint64_t key);
/* Throw the surface's paint onto what the layer holds. */
void speckle_paint(const struct tile *tile, struct window window, const struct surface *surface, struct pose pose,
                   uint64_t key);

#endif
