#include "report/states/indeterminacy.h"

#include <math.h>

static int carries(const struct packing *packing, size_t grain)
{
    return !(packing->grains.flags[grain] & (GRAIN_RATTLER | GRAIN_DISTRUST));
}

static int has_wall_friction(const struct packing *packing, const struct forces *forces)
{
    size_t wall;
    for (size_t c = 0; c < packing->contacts.count; c++)
        if (packing_is_wall(packing, c, &wall) &&
            (!forces || (isfinite(forces->contact.ft[c]) && forces->contact.ft[c] != 0)))
            return 1;
    return 0;
}

/* Directions, x and y, in which at least one segment bears a load along its normal: the other one of the pair reacts.
 */
static int loaded_directions(const struct walls *walls)
{
    int loaded[2] = {0, 0};
    for (size_t w = 0; w < walls->count; w++) {
        if (wall_is_disc(walls, w))
            continue;
        struct vec n = wall_inward(walls, w);
        int axis = fabs(n.y) > fabs(n.x);
        loaded[axis] |= isfinite(axis ? walls->fy[w] : walls->fx[w]);
    }
    return loaded[0] + loaded[1];
}

double indeterminacy(const struct packing *packing, const struct forces *forces)
{
    const struct contacts *contacts = &packing->contacts;
    int smooth = forces && forces->mu == 0, smooth_walls = smooth || !has_wall_friction(packing, forces);
    double h = 0;
    for (size_t c = 0; c < contacts->count; c++) {
        size_t wall;
        int is_wall = packing_is_wall(packing, c, &wall);
        if ((contacts->flags[c] & (CONTACT_CANDIDATE | CONTACT_NOT_FINITE)) ||
            !carries(packing, (size_t)contacts->i[c]) || (!is_wall && !carries(packing, (size_t)contacts->j[c])))
            continue;
        h += (is_wall ? smooth_walls : smooth) ? 1 : 2;
    }
    for (size_t k = 0; k < packing->grains.count; k++)
        h -= carries(packing, k) && !(packing->grains.flags[k] & GRAIN_FIXED) ? 3 : 0;
    return h - loaded_directions(&packing->walls);
}
