#include "forces/network/elastic.h"

#include <math.h>

int elastic_known(const struct contact_law *law)
{
    double given = law->kind == LAW_LINEAR ? law->kn : law->young;
    return isfinite(given) && given > 0;
}

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

void elastic_advance(const struct contact_law *law, const struct contact_pair *pair, double mu, double dun, double dut,
                     double *fn, double *ft)
{
    if (law->kind == LAW_LINEAR) {
        contact_law_advance(law, mu, dun, dut, fn, ft);
        return;
    }
    double overlap = contact_pair_overlap(law, pair, *fn) - dun;
    double before = contact_pair_stiffness(law, pair, *fn);
    struct contact_spring spring = {.fn = *fn, .ft = *ft, .stiffness = before, .peak = *fn};
    if (!(overlap > 0)) {
        *fn = *ft = 0;
        return;
    }
    contact_spring_press(law, pair, overlap, &spring);
    contact_spring_slide(law, before, dut, &spring);
    *fn = spring.fn, *ft = spring.ft;
    coulomb_clip(mu, fn, ft);
}
