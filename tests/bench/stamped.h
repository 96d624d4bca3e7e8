/* Photos of full size, drawn body by body: each speckled body is drawn exactly (tests/dots.h) on a small canvas of its
 * own and stamped into the photo, so that 80 Mpixels need no picture of doubles. */
#ifndef TESTS_BENCH_STAMPED_H
#define TESTS_BENCH_STAMPED_H

#include "pipeline/speak/error.h"
#include "tests/dots.h"
#include "tracker/subset/rigid_motion.h"

enum { FULL_WIDTH = 10320, FULL_HEIGHT = 7752 };

/* A grey photo of `level` with white noise, to stamp on. */
static inline struct photo stamped_blank(double level, double noise, uint64_t key)
{
    struct photo photo = {.width = FULL_WIDTH,
                          .height = FULL_HEIGHT,
                          .bits = 16,
                          .pixels = malloc((size_t)FULL_WIDTH * FULL_HEIGHT * sizeof(uint16_t))};
    if (!photo.pixels)
        abort();
    for (size_t k = 0; k < (size_t)FULL_WIDTH * FULL_HEIGHT; k++)
        photo.pixels[k] = (uint16_t)((level + noise * (random_uniform(key, k) - 0.5)) * DOTS_WHITE);
    return photo;
}

/* The pattern at (x, y), turned by `angle` and enlarged by `zoom`, replaces the square of `half` px around (x0, y0). */
static inline void stamp(struct photo *photo, const struct dots *dots, double x0, double y0, int half, double x,
                         double y, double angle, double zoom, double noise, uint64_t key)
{
    int left = (int)x0 - half, top = (int)y0 - half;
    struct canvas canvas = canvas_make(2 * half, 2 * half, 0.7);
    double c = zoom * cos(angle), s = zoom * sin(angle);
    for (size_t k = 0; k < dots->count; k++)
        canvas_add_dot(&canvas, x - left + c * dots->x[k] + s * dots->y[k], y - top - s * dots->x[k] + c * dots->y[k],
                       dots->sigma[k], dots->height[k], 0);
    struct photo square = canvas_photo(&canvas, 1, 0, noise, key);
    for (int j = 0; j < 2 * half; j++)
        for (int i = 0; i < 2 * half; i++)
            if (left + i >= 0 && top + j >= 0 && left + i < photo->width && top + j < photo->height)
                photo->pixels[(size_t)(top + j) * (size_t)photo->width + (size_t)(left + i)] =
                    square.pixels[j * 2 * half + i];
    free(square.pixels);
    canvas_free(&canvas);
}

#endif
