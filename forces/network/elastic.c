#include "forces/network/elastic.h"

struct contact_pair elastic_pair(const struct packing *packing, const struct contact_law *law, size_t row)
{
    double radius = packing->grains.radius[packing->contacts.i[row]];
    size_t wall;
    if (!packing_is_wall(packing, row, &wall)) {
        double other = packing->grains.radius[packing->contacts.j[row]];
        radius = radius * other / (radius + other);
    }
    return contact_pair_of(law, radius);
}

struct elastic_tangent elastic_tangent(const struct contact_law *law, const struct contact_pair *pair, double overlap)
{
    double force = contact_pair_force(law, pair, overlap);
    return (struct elastic_tangent){force, contact_pair_stiffness(law, pair, force)};
}
