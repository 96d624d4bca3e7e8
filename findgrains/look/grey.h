/* The photo between its pixels. */
#ifndef FINDGRAINS_GREY_H
#define FINDGRAINS_GREY_H

#include "pipeline/scene/photo.h"

/* Bilinear grey at photo coordinates; the border is repeated. */
static inline double grey_at(const struct photo *photo, double x, double y)
{
    double xm = photo->width - 1.001, ym = photo->height - 1.001;
    x = x < 0 ? 0 : x > xm ? xm : x;
    y = y < 0 ? 0 : y > ym ? ym : y;
    int i = (int)x, j = (int)y;
    double fx = x - i, fy = y - j;
    const uint16_t *p = photo_row(photo, j) + i, *q = j + 1 < photo->height ? photo_row(photo, j + 1) + i : p;
    double top = p[0] + fx * (p[1] - p[0]), bottom = q[0] + fx * (q[1] - q[0]);
    return top + fy * (bottom - top);
}

#endif
