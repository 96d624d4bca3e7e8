/* Slopes of the reference photo around a subset: plain ones, those of the smoothed photo, and its Laplacian. */
#ifndef TRACKER_SLOPES_H
#define TRACKER_SLOPES_H

#include <stddef.h>

#include "pipeline/scene/photo.h"

enum { SLOPES_REACH = 3 }; /* px that the plain slopes need around a pixel */

/* A box of grey values (less `level`), and of the smoothed ones; beyond the photo's border the last pixel goes on. */
struct slopes {
    int x0, y0, width, height;
    float *grey, *smooth;
};

/* Everything needed for pixels [x0, x1] x [y0, y1]. */
int slopes_load(const struct photo *photo, int x0, int y0, int x1, int y1, float level, struct slopes *slopes);
void slopes_free(struct slopes *slopes); /* accepts a zeroed struct */

/* The grey values from (x, y) on, less the level. */
const float *slopes_grey(const struct slopes *slopes, int x, int y);
/* `count` pixels from (x, y) on. */
void slopes_plain(const struct slopes *slopes, int x, int y, int count, float *gx, float *gy);
void slopes_smooth(const struct slopes *slopes, int x, int y, int count, float *gx, float *gy);
void slopes_laplacian(const struct slopes *slopes, int x, int y, int count, float *laplacian);

/* Covariance of a smooth slope and the plain one when the pixels carry white noise of variance 1. */
double slopes_noise(void);

#endif
