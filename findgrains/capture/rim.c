#include "findgrains/capture/rim.h"

#include <math.h>

/* cos 2 theta = c^2 - s^2, sin 2 theta = 2 c s: no trigonometry for a pixel. */
double rim_radius_at(const struct rim *rim, double c, double s)
{
    return rim->radius + rim->c2 * (c * c - s * s) + rim->s2 * 2 * c * s;
}

int rim_is_possible(const struct photo *photo, const struct rim *rim)
{
    double diagonal = hypot(photo->width, photo->height);
    return rim->radius > 0 && rim->radius <= diagonal && fabs(rim->x) <= 2 * diagonal && fabs(rim->y) <= 2 * diagonal &&
           fabs(rim->c2) + fabs(rim->s2) <= diagonal; /* NaN is not */
}
