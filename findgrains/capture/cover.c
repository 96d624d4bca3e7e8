/* A mask of the level's pixels under the grains that are sure. Slightly smaller than the grains: the rims of their
 * neighbours must be seen. */
#include "findgrains/capture/cover.h"

#include "pipeline/speak/error.h"

#include <math.h>
#include <stdlib.h>

#define DEPTH 0.9 /* of the radius: the rim itself, and what touches it, stays in view */

static int clamp(double value, int last)
{
    return value < 0 ? 0 : value > last ? last : (int)value;
}

void cover_add(struct cover *cover, const struct rim *rim)
{
    const struct level *level = cover->level;
    double x = (rim->x - level->x0) / level->scale, y = (rim->y - level->y0) / level->scale;
    double r = DEPTH * rim->radius / level->scale;
    if (x + r < 0 || y + r < 0 || x - r > level->width - 1 || y - r > level->height - 1)
        return;
    for (int j = clamp(ceil(y - r), level->height - 1); j <= clamp(floor(y + r), level->height - 1); j++) {
        double half2 = r * r - (j - y) * (j - y), half = half2 > 0 ? sqrt(half2) : -1;
        for (int i = (int)fmax(0, ceil(x - half)); i <= (int)fmin(level->width - 1, floor(x + half)); i++)
            cover->pixels[(size_t)j * (size_t)level->width + (size_t)i] = 1;
    }
}

int cover_make(const struct level *level, const struct candidates *sure, struct cover *cover)
{
    *cover = (struct cover){level, calloc((size_t)level->width * (size_t)level->height, 1)};
    if (!cover->pixels)
        return error_memory("cover of the grains seen");
    for (size_t k = 0; k < sure->count; k++)
        cover_add(cover, &sure->items[k].rim);
    return 0;
}

int cover_at(const struct cover *cover, double x, double y)
{
    const struct level *level = cover->level;
    int i = clamp((x - level->x0) / level->scale + 0.5, level->width - 1);
    int j = clamp((y - level->y0) / level->scale + 0.5, level->height - 1);
    return cover->pixels[(size_t)j * (size_t)level->width + (size_t)i];
}

void cover_free(struct cover *cover)
{
    free(cover->pixels);
    *cover = (struct cover){0};
}
