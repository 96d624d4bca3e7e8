/* B-spline coefficients of a small part of a photo: a patch around one grain, small enough for the cache.
 * Cubic and quintic splines interpolate the pixels; their coefficients come from the symmetric inverse filter of the
 * sampled B-spline (Unser 1999), cut where its taps fall below 2e-5 (cubic) or 2e-6 (quintic) of its centre. */
#ifndef TRACKER_BSPLINE_H
#define TRACKER_BSPLINE_H

#include <stddef.h>

#include "pipeline/scene/photo.h"

enum bspline_order { BSPLINE_CUBIC, BSPLINE_QUINTIC };
enum { BSPLINE_MARGIN = 3 }; /* px that a patch must reach beyond the positions asked from it */

/* Buffers that one thread uses again and again. */
struct patch {
    int x0, y0, width, height; /* of the coefficients, in the photo; may reach beyond its border (mirrored) */
    enum bspline_order order;
    float *coefficients; /* row-major, width * height */
    float *grey, *line;  /* workspace */
    size_t coefficient_capacity, grey_capacity, line_capacity;
};

/* Coefficients for every position in [x_min, x_max] x [y_min, y_max] (px). `level` is subtracted from every pixel. */
int patch_load(const struct photo *photo, double x_min, double y_min, double x_max, double y_max, float level,
               enum bspline_order order, struct patch *patch);
/* Do the coefficients cover this box? */
int patch_covers(const struct patch *patch, double x_min, double y_min, double x_max, double y_max);
void patch_free(struct patch *patch); /* accepts a zeroed struct */

/* Variance of the spline interpolated at position x, in one direction, over that of white pixel noise. */
double bspline_noise_gain(enum bspline_order order, double x);

/* The weights of the taps from floor(x) - 1 (cubic, 4 taps) or floor(x) - 2 (quintic, 6 taps) at fraction t. */
static inline void bspline_cubic_weights(float t, float w[4])
{
    float r = 1 - t;
    w[0] = r * r * r * (1.0f / 6);
    w[1] = (2.0f / 3) - t * t * (1 - 0.5f * t);
    w[2] = (2.0f / 3) - r * r * (1 - 0.5f * r);
    w[3] = t * t * t * (1.0f / 6);
}

/* The three pieces of the quintic B-spline, at distances a in [0, 1], b = a + 1 and c = a + 2. */
static inline float bspline_quintic_inner(float a)
{
    float q = a * a;
    return 0.55f + q * (-0.5f + q * (0.25f - a * (1.0f / 12)));
}

static inline float bspline_quintic_middle(float b)
{
    return 0.425f + b * (0.625f + b * (-1.75f + b * (1.25f + b * (-0.375f + b * (1.0f / 24)))));
}

static inline float bspline_quintic_outer(float c)
{
    float r = 3 - c, q = r * r;
    return q * q * r * (1.0f / 120);
}

static inline void bspline_quintic_weights(float t, float w[6])
{
    float r = 1 - t;
    w[0] = bspline_quintic_outer(t + 2);
    w[1] = bspline_quintic_middle(t + 1);
    w[2] = bspline_quintic_inner(t);
    w[3] = bspline_quintic_inner(r);
    w[4] = bspline_quintic_middle(r + 1);
    w[5] = bspline_quintic_outer(r + 2);
}

#endif
