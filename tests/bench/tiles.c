#include "tests/bench/tiles.h"

#include <stdlib.h>
#include <string.h>

#include "pipeline/speak/error.h"

struct tiling {
    const struct packing *tile;
    struct packing *packing;
    size_t k;
    double width, height;
    long wall[4]; /* rows of left, right, bottom, top in the tile */
    size_t filled;
};

enum { LEFT, RIGHT, BOTTOM, TOP };

static double placed(double x, double length, size_t column)
{
    return column % 2 ? length * (double)(column + 1) - x : length * (double)column + x;
}

static void place_grains(struct tiling *tiling)
{
    const struct grains *from = &tiling->tile->grains;
    struct grains *to = &tiling->packing->grains;
    for (size_t t = 0; t < tiling->k * tiling->k; t++)
        for (size_t g = 0; g < from->count; g++) {
            size_t at = t * from->count + g;
            to->x[at] = placed(from->x[g], tiling->width, t % tiling->k);
            to->y[at] = placed(from->y[g], tiling->height, t / tiling->k);
            to->radius[at] = from->radius[g], to->mass[at] = from->mass[g], to->inertia[at] = from->inertia[g];
            to->flags[at] = from->flags[g];
        }
}

/* The side of the whole on which side `wall` of tile t lies, or -1: another tile is there, *other. */
static int outer_side(const struct tiling *tiling, size_t t, int wall, size_t *other)
{
    size_t k = tiling->k, column = t % k, row = t / k;
    int upright = wall == LEFT || wall == RIGHT, ahead = wall == RIGHT || wall == TOP;
    size_t at = upright ? column : row;
    if (at % 2)
        ahead = !ahead;
    if (ahead ? at + 1 == k : at == 0)
        return upright ? (ahead ? RIGHT : LEFT) : ahead ? TOP : BOTTOM;
    *other = ahead ? t + (upright ? 1 : k) : t - (upright ? 1 : k);
    return -1;
}

/* Contact c of tile t; one between a grain and its image is made by the first of the two tiles. */
static void place_contact(struct tiling *tiling, size_t t, size_t c)
{
    const struct contacts *from = &tiling->tile->contacts;
    struct contacts *to = &tiling->packing->contacts;
    const struct contact_forces *force = &packing_forces(tiling->tile, "dem")->contact;
    struct contact_forces *force_to = &tiling->packing->forces[0].contact;
    size_t n = tiling->tile->grains.count, column = t % tiling->k, row = t / tiling->k, at = tiling->filled, other;
    int flip_x = column % 2, flip_y = row % 2;
    int64_t j = from->j[c] + (int64_t)(t * n);
    if ((size_t)from->j[c] >= n) {
        int wall = 0;
        while (tiling->wall[wall] != from->j[c] - (int64_t)n)
            wall++;
        int side = outer_side(tiling, t, wall, &other);
        if (side < 0 && other < t)
            return;
        j = side < 0 ? (int64_t)(other * n) + from->i[c] : (int64_t)(n * tiling->k * tiling->k) + tiling->wall[side];
    }
    to->i[at] = from->i[c] + (int64_t)(t * n), to->j[at] = j;
    to->nx[at] = flip_x ? -from->nx[c] : from->nx[c], to->ny[at] = flip_y ? -from->ny[c] : from->ny[c];
    to->x[at] = placed(from->x[c], tiling->width, column), to->y[at] = placed(from->y[c], tiling->height, row);
    to->overlap[at] = from->overlap[c];
    force_to->fn[at] = force->fn[c];
    force_to->ft[at] = flip_x != flip_y ? -force->ft[c] : force->ft[c];
    tiling->filled++;
}

static void place_walls(struct tiling *tiling)
{
    struct walls *walls = &tiling->packing->walls;
    double k = (double)tiling->k;
    for (size_t w = 0; w < walls->count; w++) {
        walls->x0[w] *= k, walls->x1[w] *= k, walls->y0[w] *= k, walls->y1[w] *= k;
        walls->fx[w] *= k, walls->fy[w] *= k;
    }
}

static int allocate(struct tiling *tiling, size_t contacts)
{
    static const char *const grain_columns[] = {"x", "y", "radius", "mass", "inertia", "flags", NULL};
    static const char *const contact_columns[] = {"i", "j", "nx", "ny", "x", "y", "overlap", "flags", NULL};
    static const char *const force_columns[] = {"fn", "ft", NULL};
    struct packing *packing = tiling->packing;
    memset(packing, 0, sizeof *packing);
    packing->length_m = tiling->tile->length_m;
    packing->forces = calloc(1, sizeof *packing->forces);
    if (!packing->forces)
        return error_memory("tiles");
    packing->force_count = 1;
    strcpy(packing->forces[0].method, "dem");
    return table_alloc(&GRAINS, &packing->grains, tiling->tile->grains.count * tiling->k * tiling->k, grain_columns) ||
                   table_copy(&WALLS, &packing->walls, &tiling->tile->walls) ||
                   table_alloc(&CONTACTS, &packing->contacts, contacts, contact_columns) ||
                   table_alloc(&CONTACT_FORCES, &packing->forces[0].contact, contacts, force_columns)
               ? -1
               : 0;
}

/* How many contacts place_contact() will keep. */
static size_t count_contacts(const struct tiling *tiling)
{
    size_t count = 0, n = tiling->tile->grains.count, other;
    for (size_t t = 0; t < tiling->k * tiling->k; t++)
        for (size_t c = 0; c < tiling->tile->contacts.count; c++) {
            int wall = 0;
            if ((size_t)tiling->tile->contacts.j[c] >= n)
                while (tiling->wall[wall] != tiling->tile->contacts.j[c] - (int64_t)n)
                    wall++;
            int kept = (size_t)tiling->tile->contacts.j[c] < n || outer_side(tiling, t, wall, &other) >= 0 || other > t;
            count += (size_t)kept;
        }
    return count;
}

int tiles_mirrored(const struct packing *tile, size_t k, struct packing *packing)
{
    static const char *const names[] = {"left", "right", "bottom", "top"};
    struct tiling tiling = {.tile = tile, .packing = packing, .k = k};
    for (int w = 0; w < 4; w++)
        tiling.wall[w] = walls_find(&tile->walls, names[w]);
    tiling.width = tile->walls.x0[tiling.wall[RIGHT]] - tile->walls.x0[tiling.wall[LEFT]];
    tiling.height = tile->walls.y0[tiling.wall[TOP]] - tile->walls.y0[tiling.wall[BOTTOM]];
    if (allocate(&tiling, count_contacts(&tiling)))
        return -1;
    place_grains(&tiling);
    for (size_t t = 0; t < k * k; t++)
        for (size_t c = 0; c < tile->contacts.count; c++)
            place_contact(&tiling, t, c);
    place_walls(&tiling);
    return 0;
}
