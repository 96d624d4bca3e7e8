#include "pipeline/packing/packing.h"

#include <stdlib.h>
#include <string.h>

void packing_free(struct packing *packing)
{
    table_free(&GRAINS, &packing->grains);
    table_free(&WALLS, &packing->walls);
    table_free(&CONTACTS, &packing->contacts);
    for (size_t f = 0; f < packing->force_count; f++)
        forces_free(&packing->forces[f]);
    free(packing->forces);
    state_info_free(&packing->info);
    memset(packing, 0, sizeof *packing);
}

const struct forces *packing_forces(const struct packing *packing, const char *method)
{
    for (size_t f = 0; f < packing->force_count; f++)
        if (!strncmp(packing->forces[f].method, method, NAME_LENGTH))
            return &packing->forces[f];
    return NULL;
}

/* ---- contacts as geometry ---- */

int packing_is_wall(const struct packing *packing, size_t c, size_t *wall)
{
    size_t j = (size_t)packing->contacts.j[c];
    if (j < packing->grains.count)
        return 0;
    *wall = j - packing->grains.count;
    return 1;
}

struct vec packing_partner(const struct packing *packing, size_t c)
{
    const struct grains *grains = &packing->grains;
    const struct walls *walls = &packing->walls;
    size_t i = (size_t)packing->contacts.i[c], wall;
    if (!packing_is_wall(packing, c, &wall)) {
        size_t j = (size_t)packing->contacts.j[c];
        return vec(grains->x[j], grains->y[j]);
    }
    struct vec start = vec(walls->x0[wall], walls->y0[wall]), centre = vec(grains->x[i], grains->y[i]);
    if (wall_is_disc(walls, wall))
        return start;
    struct vec along = wall_direction(walls, wall);
    return vec_add(start, vec_scale(vec_dot(vec_sub(centre, start), along), along));
}

struct vec packing_branch(const struct packing *packing, size_t c)
{
    size_t i = (size_t)packing->contacts.i[c];
    return vec_sub(packing_partner(packing, c), vec(packing->grains.x[i], packing->grains.y[i]));
}
