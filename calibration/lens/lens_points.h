/* What photos of a plate that is moved rigidly say: points of the reference photo and where each is seen. */
#ifndef CALIBRATION_LENS_POINTS_H
#define CALIBRATION_LENS_POINTS_H

#include <stddef.h>

#include "pipeline/numbers/geometry.h"

/* Limits of one calibration; LENS_FEWEST_POINTS: per photo. */
enum { LENS_UNKNOWNS = 8, LENS_PHOTOS_MAX = 64, LENS_FEWEST_POINTS = 60, LENS_FEWEST_PHOTOS = 2 };

/* Points of the plate: where they are in the reference photo and, photo by photo, where they are seen. */
struct lens_points {
    size_t count, photos;        /* photos: beside the reference */
    const struct vec *reference; /* count */
    const struct vec *seen;      /* photos * count, photo by photo */
    const double *sigma;         /* photos * count: px, error of seen; NaN: not seen */
    int width, height;           /* of the photos */
};

#endif
