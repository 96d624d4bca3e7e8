/* Small packings drawn by the tests of forces: discs, a box of four walls, contacts found by brute force. */
#ifndef TESTS_DISCS_H
#define TESTS_DISCS_H

#include <math.h>
#include <string.h>

#include "pipeline/packing/packing.h"
#include "tests/check.h"

static const char *const DISC_COLUMNS[] = {"x",      "y",      "radius", "mass",  "inertia",
                                           "load_x", "load_y", "load_m", "flags", NULL};
static const char *const BOX_COLUMNS[] = {"name", "x0", "y0", "x1", "y1", "radius", "fx", "fy", "flags", NULL};
static const char *const TOUCH_COLUMNS[] = {"i", "j", "nx", "ny", "x", "y", "overlap", "flags", NULL};

static inline void discs_begin(struct packing *packing, size_t grains)
{
    memset(packing, 0, sizeof *packing);
    packing->length_m = NAN;
    check_done(table_alloc(&GRAINS, &packing->grains, grains, DISC_COLUMNS));
}

static inline void disc_put(struct packing *packing, size_t k, double x, double y, double radius)
{
    struct grains *g = &packing->grains;
    g->x[k] = x, g->y[k] = y, g->radius[k] = radius;
    g->mass[k] = 1000 * 3.141592653589793 * radius * radius;
    g->inertia[k] = g->mass[k] * radius * radius / 2;
    g->load_x[k] = g->load_y[k] = g->load_m[k] = 0;
}

/* Walls bottom, right, top, left of the box [0, width] x [0, height], without loads; `extra` rows left for discs. */
static inline void discs_box(struct packing *packing, double width, double height, size_t extra)
{
    static const char *const names[] = {"bottom", "right", "top", "left"};
    double x[] = {0, width, width, 0}, y[] = {0, 0, height, height};
    check_done(table_alloc(&WALLS, &packing->walls, 4 + extra, BOX_COLUMNS));
    for (size_t w = 0; w < 4; w++) {
        struct walls *walls = &packing->walls;
        memcpy(walls->name[w], names[w], strlen(names[w]));
        walls->x0[w] = x[w], walls->y0[w] = y[w];
        walls->x1[w] = x[(w + 1) % 4], walls->y1[w] = y[(w + 1) % 4];
        walls->radius[w] = 0;
    }
}

static inline void discs_load_wall(struct packing *packing, const char *name, double fx, double fy)
{
    long w = walls_find(&packing->walls, name);
    assert_true(w >= 0);
    packing->walls.fx[w] = fx, packing->walls.fy[w] = fy;
}

static inline void touch_put(struct packing *packing, size_t c, size_t i, size_t j, struct vec n, struct vec point,
                             double overlap)
{
    struct contacts *contacts = &packing->contacts;
    contacts->i[c] = (int64_t)i, contacts->j[c] = (int64_t)j;
    contacts->nx[c] = n.x, contacts->ny[c] = n.y;
    contacts->x[c] = point.x, contacts->y[c] = point.y;
    contacts->overlap[c] = overlap;
}

/* The contact of discs i and j when they are closer than `gap`; 1: there is one. Stored as row c unless c is -1. */
static inline int touch_discs(struct packing *packing, long c, size_t i, size_t j, double gap)
{
    const struct grains *g = &packing->grains;
    struct vec a = vec(g->x[i], g->y[i]), l = vec_sub(vec(g->x[j], g->y[j]), a), n = vec_unit(l);
    double overlap = g->radius[i] + g->radius[j] - vec_norm(l);
    if (overlap < -gap)
        return 0;
    if (c >= 0)
        touch_put(packing, (size_t)c, i, j, n, vec_add(a, vec_scale(g->radius[i] - overlap / 2, n)), overlap);
    return 1;
}

static inline int touch_wall(struct packing *packing, long c, size_t i, size_t w, double gap)
{
    const struct grains *g = &packing->grains;
    struct vec a = vec(g->x[i], g->y[i]), in = wall_inward(&packing->walls, w), n = vec_scale(-1, in);
    double overlap = g->radius[i] - vec_dot(vec_sub(a, vec(packing->walls.x0[w], packing->walls.y0[w])), in);
    if (wall_is_disc(&packing->walls, w) || overlap < -gap)
        return 0;
    if (c >= 0)
        touch_put(packing, (size_t)c, i, g->count + w, n, vec_add(a, vec_scale(g->radius[i] - overlap / 2, n)),
                  overlap);
    return 1;
}

/* Every pair closer than `gap`, except with corner discs. */
static inline void discs_touch(struct packing *packing, double gap)
{
    for (int pass = 0; pass < 2; pass++) {
        long found = 0;
        for (size_t i = 0; i < packing->grains.count; i++) {
            for (size_t j = i + 1; j < packing->grains.count; j++)
                found += touch_discs(packing, pass ? found : -1, i, j, gap);
            for (size_t w = 0; w < packing->walls.count; w++)
                found += touch_wall(packing, pass ? found : -1, i, w, gap);
        }
        if (!pass)
            check_done(table_alloc(&CONTACTS, &packing->contacts, (size_t)found, TOUCH_COLUMNS));
    }
}

/* nx x ny discs of radius r on a square lattice, the right and top walls loaded. */
static inline void discs_square_lattice(struct packing *packing, size_t nx, size_t ny, double r, double fx, double fy)
{
    discs_begin(packing, nx * ny);
    for (size_t k = 0; k < nx * ny; k++)
        disc_put(packing, k, r * (1 + 2 * (double)(k % nx)), r * (1 + 2 * (double)(k / nx)), r);
    discs_box(packing, 2 * r * (double)nx, 2 * r * (double)ny, 0);
    discs_load_wall(packing, "right", -fx, 0);
    discs_load_wall(packing, "top", 0, -fy);
    discs_touch(packing, 1e-6 * r);
}

/* nx discs a row in ny rows of a hexagonal crystal, in a box pressed from the right and from above. */
static inline void discs_hexagonal(struct packing *packing, size_t nx, size_t ny)
{
    const double r = 0.01, rise = r * sqrt(3);
    discs_begin(packing, nx * ny);
    for (size_t k = 0; k < nx * ny; k++)
        disc_put(packing, k, r * (1 + 2 * (double)(k % nx) + (double)((k / nx) % 2)), r + rise * (double)(k / nx), r);
    discs_box(packing, r * (2 * (double)nx + 1), 2 * r + rise * (double)(ny - 1), 0);
    discs_load_wall(packing, "right", -1000, 0);
    discs_load_wall(packing, "top", 0, -1200);
    discs_touch(packing, 1e-6 * r);
}

#endif
