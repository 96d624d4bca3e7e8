/* Grains by hand and sums over a photo, for tests of what is drawn. */
#ifndef TESTS_PHOTO_SUMS_H
#define TESTS_PHOTO_SUMS_H

#include "tests/check.h"

#include <math.h>

#include "simulation/render/render.h"

static const double PI = 3.14159265358979323846;

static inline void grains_make(struct photo_grains *grains, size_t count)
{
    static const char *const columns[] = {"x_px", "y_px", "radius_px", "angle", NULL};
    *grains = (struct photo_grains){0};
    check_done(table_alloc(&PHOTO_GRAINS, grains, count, columns));
}

static inline void grain_put(struct photo_grains *grains, size_t k, double x, double y, double radius, double angle)
{
    grains->x_px[k] = x;
    grains->y_px[k] = y;
    grains->radius_px[k] = radius;
    grains->angle[k] = angle;
}

static inline void grains_free(struct photo_grains *grains)
{
    table_free(&PHOTO_GRAINS, grains);
}

struct moments {
    double mass, x, y; /* of the light above the top-left pixel's level; centroid in px */
};

/* A pixel sum of a blurred picture equals its integral (Poisson: the blurred spectrum is nil at whole frequencies). */
static inline struct moments photo_moments(const struct photo *photo)
{
    struct moments m = {0};
    double floor_level = photo_row(photo, 0)[0];
    for (int y = 0; y < photo->height; y++)
        for (int x = 0; x < photo->width; x++) {
            double light = photo_row(photo, y)[x] - floor_level;
            m.mass += light;
            m.x += light * x;
            m.y += light * y;
        }
    m.x /= m.mass;
    m.y /= m.mass;
    return m;
}

#endif
