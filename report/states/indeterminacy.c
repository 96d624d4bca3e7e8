#include "report/states/indeterminacy.h"

#include <math.h>

#include "pipeline/packing/structure.h"

static int has_wall_friction(const struct packing *packing, const struct forces *forces)
{
    size_t wall;
    for (size_t c = 0; c < packing->contacts.count; c++)
        if (packing_is_wall(packing, c, &wall) &&
            (!forces || (isfinite(forces->contact.ft[c]) && forces->contact.ft[c] != 0)))
            return 1;
    return 0;
}

int indeterminacy(const struct packing *packing, const struct forces *forces, double *h)
{
    struct indeterminacy computed = packing->indeterminacy;
    double mu = forces ? forces->mu : NAN, mu_wall = mu == 0 || !has_wall_friction(packing, forces) ? 0 : NAN;
    if (!computed.known && packing_indeterminacy(packing, mu, mu_wall, &computed))
        return -1;
    *h = computed.h;
    return 0;
}
