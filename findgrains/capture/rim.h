/* The rim of a grain in the photo. px, x right, y down. */
#ifndef FINDGRAINS_RIM_H
#define FINDGRAINS_RIM_H

#include "pipeline/scene/photo.h"

/* r(theta) = radius + c2 cos 2 theta + s2 sin 2 theta, theta from x towards y: clockwise as seen. */
struct rim {
    double x, y, radius, c2, s2;
};

/* r(theta) of a rim. */
double rim_radius_at(const struct rim *rim, double cos_theta, double sin_theta);

/* Can the photo show some of it? Not when it is larger than the photo, or further away, or no number: whoever measures
 * pixels along a rim asks this first. */
int rim_is_possible(const struct photo *photo, const struct rim *rim);

#endif
