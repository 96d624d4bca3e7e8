/* A packing of speckled discs drawn by tests, and where its grains are in one photo. */
#ifndef TESTS_DRAWN_PACKING_H
#define TESTS_DRAWN_PACKING_H

#include "tests/check.h"
#include "tests/dots.h"

#include "tracker/subset/rigid_motion.h"
#include "tracker/follow/track_grains.h"

enum { COLUMNS = 5, ROWS = 4, COUNT = COLUMNS * ROWS, WIDTH = 420, HEIGHT = 360 };
static const double degree = 3.141592653589793 / 180, radius = 27;

struct packing {
    struct dots dots[COUNT];
    double x[COUNT], y[COUNT]; /* in the reference */
    struct motion motion[COUNT];
};

static inline void packing_make(struct packing *packing, uint64_t key)
{
    for (int k = 0; k < COUNT; k++) {
        packing->dots[k] = dots_make(radius, DOTS_NORMAL, key * 100 + (uint64_t)k);
        packing->x[k] = 80 + (k % COLUMNS) * 60 + random_uniform(key, 2 * (uint64_t)k);
        packing->y[k] = 80 + (k / COLUMNS) * 60 + random_uniform(key, 2 * (uint64_t)k + 1);
        packing->motion[k] = (struct motion){0};
    }
}

/* A common shift and turn of `angle` at most, plus what each grain does on its own. */
static inline void packing_move(struct packing *packing, double u, double v, double jitter, double angle, uint64_t key)
{
    for (int k = 0; k < COUNT; k++) {
        uint64_t c = 3 * (uint64_t)k;
        packing->motion[k] = (struct motion){u + jitter * (2 * random_uniform(key, c) - 1),
                                             v + jitter * (2 * random_uniform(key, c + 1) - 1),
                                             angle * (2 * random_uniform(key, c + 2) - 1)};
    }
}

static inline void packing_free(struct packing *packing)
{
    for (int k = 0; k < COUNT; k++)
        dots_free(&packing->dots[k]);
}

static inline struct canvas packing_canvas(const struct packing *packing)
{
    struct canvas canvas = canvas_make(WIDTH, HEIGHT, 0.05);
    for (int k = 0; k < COUNT; k++) {
        const struct motion *motion = &packing->motion[k];
        canvas_add_disc(&canvas, packing->x[k] + motion->u, packing->y[k] + motion->v, radius, 0.75, 0.7);
        canvas_add(&canvas, &packing->dots[k], packing->x[k] + motion->u, packing->y[k] + motion->v, motion->angle, 0);
    }
    return canvas;
}

static inline struct photo packing_photo(const struct packing *packing, double noise, uint64_t key)
{
    struct canvas canvas = packing_canvas(packing);
    struct photo photo = canvas_photo(&canvas, 1, 0, noise, key);
    canvas_free(&canvas);
    return photo;
}

static inline struct photo_grains packing_grains(const struct packing *packing)
{
    static const char *const names[] = {"x_px", "y_px", "radius_px", "flags", "s_x", "s_y", NULL};
    struct photo_grains grains = {0};
    check_done(table_alloc(&PHOTO_GRAINS, &grains, COUNT, names));
    for (int k = 0; k < COUNT; k++) {
        grains.x_px[k] = packing->x[k];
        grains.y_px[k] = packing->y[k];
        grains.radius_px[k] = radius;
        grains.s_x[k] = grains.s_y[k] = 0.01;
    }
    return grains;
}

/* One grain: within `sigmas` standard errors (and 0.05 px, 0.2 degrees), not flagged. */
static inline void check_grain(const struct photo_grains *tracks, const struct packing *packing, int k, double sigmas)
{
    const struct motion *truth = &packing->motion[k];
    assert_int_equal(tracks->flags[k] & GRAIN_DISTRUST, 0);
    check_near(tracks->x_px[k], packing->x[k] + truth->u, fmin(0.05, sigmas * tracks->s_x[k] + 0.002));
    check_near(tracks->y_px[k], packing->y[k] + truth->v, fmin(0.05, sigmas * tracks->s_y[k] + 0.002));
    check_near(tracks->angle[k], truth->angle, fmin(0.2 * degree, sigmas * tracks->s_angle[k] + 1e-4));
}

#endif
