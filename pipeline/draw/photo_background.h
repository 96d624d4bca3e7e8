/* A photo as the background of a picture. */
#ifndef DRAW_PHOTO_BACKGROUND_H
#define DRAW_PHOTO_BACKGROUND_H

#include "pipeline/draw/canvas.h"
#include "pipeline/scene/photo.h"

/* px of the photo: the part to show; the centres of pixels are whole numbers. */
struct photo_view {
    double x0, y0, x1, y1;
};

/* Paint that part into the rectangle (0, 0, width, height): greys stretched between the 0.5 % and 99.5 % quantiles of
 * what is shown, reduced by area averages where the photo is finer than the picture. An input error when the part lies
 * outside the photo. */
int photo_background(struct canvas *canvas, const struct photo *photo, const struct photo_view *view, double width,
                     double height);
/* Paint all of it from the upper left corner, `zoom` px (a whole number, or 1 over one) per px of the photo and as many
 * as width * height, without blending: the pixels can be counted. `black` and `white` are the greys shown as such. */
int photo_background_pixels(struct canvas *canvas, const struct photo *photo, double zoom, int width, int height,
                            double black, double white);

#endif
