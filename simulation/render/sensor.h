/* From light on cells to numbers on pixels: point spread, pixel, shading, noise, steps. */
#ifndef SIMULATION_SENSOR_H
#define SIMULATION_SENSOR_H

#include "pipeline/scene/photo.h"
#include "simulation/render/optics.h"
#include "simulation/render/tile.h"

enum { SENSOR_TAPS_MAX = 2048 };

struct sensor {
    const struct optics *optics;
    long index;      /* of the photo: key of the noise */
    int margin;      /* px that the point spread reaches */
    int taps;        /* cells in one direction */
    double psf;      /* px */
    double exposure; /* of this photo */
    float weight[SENSOR_TAPS_MAX];
};

/* blur: px, added to the point spread of this photo; brightness: multiplies its exposure. */
int sensor_begin(struct sensor *sensor, const struct optics *optics, long index, double blur, double brightness);
/* The tile's pixels into the photo, each thread its own tiles; scratch: tile->width floats, one block per thread.
 * Pixels of the last tiles that lie beyond the photo are left out. */
void sensor_expose(const struct sensor *sensor, const struct tile *tile, float *scratch, struct photo *photo);

#endif
