/* Metres per pixel from known lengths. */
#ifndef CALIBRATION_SCALE_H
#define CALIBRATION_SCALE_H

#include <stddef.h>

#include "pipeline/numbers/geometry.h"

struct known_length {
    struct vec a, b; /* px, with the lens undone */
    double metres;
};

struct scale {
    double m_per_px, s_m_per_px;
    double scatter_px; /* what the lengths disagree by; NaN for one length */
};

/* Least squares of metres = scale * pixels, with errors of `error_px` at each mark, or what the lengths disagree by if
 * that is more. */
int scale_estimate(const struct known_length *lengths, size_t count, double error_px, struct scale *scale);

#endif
