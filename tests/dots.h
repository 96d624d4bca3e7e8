/* Photos with an exact truth for tests and benches: circular Gaussian dots, each integrated over the pixels, carried
 * by a rigid motion. Nothing is interpolated, so any shift and angle is exact (note "tracking", section 2). */
#ifndef TESTS_DOTS_H
#define TESTS_DOTS_H

#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "pipeline/scene/photo.h"
#include "pipeline/numbers/random.h"

/* A speckle pattern within `radius` of its centre. */
struct dots {
    size_t count;
    double radius;
    double *x, *y, *sigma, *height;
};

/* Ranges of dot sizes (standard deviation, px): the note's normal, fine and coarse patterns. */
#define DOTS_NORMAL ((const double[2]){1.2, 2.2})
#define DOTS_FINE ((const double[2]){0.6, 1.0})
#define DOTS_COARSE ((const double[2]){2.5, 4.0})

/* Heights +-1 times a random factor; their number gives every pattern the same grey variance, near 0.14^2. */
static inline struct dots dots_make(double radius, const double sigma[2], uint64_t key)
{
    double mean = (sigma[0] + sigma[1]) / 2;
    struct dots dots = {.radius = radius};
    dots.count = (size_t)(0.55 * radius * radius / (mean * mean)) + 3;
    double *block = malloc(4 * dots.count * sizeof *block);
    if (!block)
        abort();
    dots.x = block;
    dots.y = block + dots.count;
    dots.sigma = block + 2 * dots.count;
    dots.height = block + 3 * dots.count;
    for (size_t k = 0; k < dots.count; k++) {
        double r = radius * sqrt(random_uniform(key, 5 * k)), a = 6.283185307179586 * random_uniform(key, 5 * k + 1);
        dots.x[k] = r * cos(a);
        dots.y[k] = r * sin(a);
        dots.sigma[k] = sigma[0] + (sigma[1] - sigma[0]) * random_uniform(key, 5 * k + 2);
        dots.height[k] =
            (random_uniform(key, 5 * k + 3) < 0.5 ? -1 : 1) * (0.15 + 0.2 * random_uniform(key, 5 * k + 4));
    }
    return dots;
}

static inline void dots_free(struct dots *dots)
{
    free(dots->x);
    *dots = (struct dots){0};
}

/* A picture of doubles: 0 black, 1 white (DOTS_WHITE grey values). */
struct canvas {
    int width, height;
    double *grey;
};
#define DOTS_WHITE 40000.0

static inline struct canvas canvas_make(int width, int height, double level)
{
    struct canvas canvas = {width, height, malloc(sizeof(double) * (size_t)width * (size_t)height)};
    if (!canvas.grey)
        abort();
    for (size_t k = 0; k < (size_t)width * (size_t)height; k++)
        canvas.grey[k] = level;
    return canvas;
}

static inline void canvas_free(struct canvas *canvas)
{
    free(canvas->grey);
    *canvas = (struct canvas){0};
}

/* One dot, integrated over each pixel; `blur` is the standard deviation of a point spread. */
static inline void canvas_add_dot(struct canvas *canvas, double x, double y, double sigma, double height, double blur)
{
    enum { REACH = 48 };
    double across[2 * REACH + 1], wide = sqrt(sigma * sigma + blur * blur), scale = 1 / (wide * sqrt(2));
    int reach = (int)ceil(6 * wide) < REACH ? (int)ceil(6 * wide) : REACH, ix = (int)floor(x), iy = (int)floor(y);
    double volume = height * (sigma * sigma) * 1.5707963267948966; /* 2 pi sigma^2 / 4, for the two differences */
    for (int i = -reach; i <= reach; i++)
        across[i + reach] = erf((ix + i + 0.5 - x) * scale) - erf((ix + i - 0.5 - x) * scale);
    for (int j = -reach; j <= reach; j++) {
        int row = iy + j;
        if (row < 0 || row >= canvas->height)
            continue;
        double down = volume * (erf((row + 0.5 - y) * scale) - erf((row - 0.5 - y) * scale));
        for (int i = -reach; i <= reach; i++)
            if (ix + i >= 0 && ix + i < canvas->width)
                canvas->grey[(size_t)row * (size_t)canvas->width + (size_t)(ix + i)] += down * across[i + reach];
    }
}

/* The pattern with its centre at (x, y), turned counter-clockwise as seen by `angle`. */
static inline void canvas_add(struct canvas *canvas, const struct dots *dots, double x, double y, double angle,
                              double blur)
{
    double c = cos(angle), s = sin(angle);
    for (size_t k = 0; k < dots->count; k++)
        canvas_add_dot(canvas, x + c * dots->x[k] + s * dots->y[k], y - s * dots->x[k] + c * dots->y[k], dots->sigma[k],
                       dots->height[k], blur);
}

/* A disc of brightness `height` with an edge as wide as the point spread `edge`. */
static inline void canvas_add_disc(struct canvas *canvas, double x, double y, double radius, double height, double edge)
{
    int reach = (int)ceil(radius + 6 * edge);
    for (int j = (int)y - reach; j <= (int)y + reach; j++)
        for (int i = (int)x - reach; i <= (int)x + reach; i++)
            if (i >= 0 && j >= 0 && i < canvas->width && j < canvas->height)
                canvas->grey[(size_t)j * (size_t)canvas->width + (size_t)i] +=
                    height * 0.5 * erfc((hypot(i - x, j - y) - radius) / (edge * sqrt(2)));
}

/* gain * canvas + offset with white noise (all in units of white), cut to 16 bits. */
static inline struct photo canvas_photo(const struct canvas *canvas, double gain, double offset, double noise,
                                        uint64_t key)
{
    size_t n = (size_t)canvas->width * (size_t)canvas->height;
    struct photo photo = {
        .width = canvas->width, .height = canvas->height, .bits = 16, .pixels = malloc(n * sizeof(uint16_t))};
    if (!photo.pixels)
        abort();
    for (size_t k = 0; k < n; k++) {
        double grey = gain * canvas->grey[k] + offset + (noise > 0 ? noise * random_normal(key, k) : 0);
        grey = floor(grey * DOTS_WHITE + 0.5);
        photo.pixels[k] = (uint16_t)(grey < 0 ? 0 : grey > 65535 ? 65535 : grey);
    }
    return photo;
}

#endif
