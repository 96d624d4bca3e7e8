/* The photo's specimen zone at a coarser (or finer) pixel, as floats. */
#ifndef FINDGRAINS_LEVEL_H
#define FINDGRAINS_LEVEL_H

#include "pipeline/scene/photo.h"
#include "findgrains/look/zone.h"

/* Level coordinates count level pixels; pixel (i, j) of the level is centred at (x0 + i scale, y0 + j scale) of the
 * photo. */
struct level {
    int width, height;
    double scale;  /* photo pixels per level pixel */
    double x0, y0; /* photo coordinates of the level's pixel (0, 0) */
    float *pixels;
};

/* The zone at about `scale` photo pixels per pixel (a whole number from 1 on, else the inverse of one); outside the
 * zone: `outside`, grey levels. 0, or -1 with a line: the zone is smaller than 4 level pixels (EXIT_INPUT), memory is
 * gone. To be freed. */
int level_make(const struct photo *photo, const struct zone *zone, double scale, double outside, struct level *level);
/* The same picture at `factor` times coarser pixels. */
int level_shrink(const struct level *from, int factor, struct level *to);
void level_free(struct level *level); /* accepts a zeroed struct */

/* Bilinear value at level coordinates, border pixels repeated. */
static inline double level_at(const struct level *level, double x, double y)
{
    double xm = level->width - 1.001, ym = level->height - 1.001;
    x = x < 0 ? 0 : x > xm ? xm : x;
    y = y < 0 ? 0 : y > ym ? ym : y;
    int i = (int)x, j = (int)y;
    double fx = x - i, fy = y - j;
    const float *p = level->pixels + (size_t)j * (size_t)level->width + i;
    double top = p[0] + fx * (p[1] - p[0]), bottom = p[level->width] + fx * (p[level->width + 1] - p[level->width]);
    return top + fy * (bottom - top);
}

#endif
