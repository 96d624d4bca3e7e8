/* A photo as the background of a picture. */
#ifndef REPORT_DRAW_PHOTO_H
#define REPORT_DRAW_PHOTO_H

#include <cairo.h>

#include "pipeline/scene/photo.h"

struct photo_view {
    double x0, y0, x1, y1; /* px of the photo: the part to show, pixel centres at integers */
};

/* Paint that part into the rectangle (0, 0, width, height), greys stretched between the 0.5 % and 99.5 % quantiles of
 * what is shown, reduced by area averages where the photo is finer than the picture. */
int draw_photo(cairo_t *cairo, const struct photo *photo, const struct photo_view *view, double width, double height);

#endif
