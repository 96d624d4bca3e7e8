/* Loads on walls and grains, and what they say about the contact forces. In equilibrium the virial of the contacts is
 * that of the loads,
 *
 *     sum over contacts of fn l = - sum over loads of F . (x - corner),
 *
 * l the length of the branch (tangential forces of discs have no virial); reactions of fixed walls have none about the
 * corner where their lines meet. It gives the unit of force, an estimate of <fn>, before any method has run, and the
 * scale of forces from overlaps. */
#include "forces/network/network_loads.h"

#include <string.h>

#include "forces/network/network_parts.h"

double network_load_misfit(const struct packing *packing, double misfit[2])
{
    const struct walls *walls = &packing->walls;
    const struct grains *grains = &packing->grains;
    struct vec sum = {0, 0};
    double largest = 0;
    int segments = 0;
    misfit[0] = misfit[1] = NAN;
    for (size_t w = 0; w < walls->count; w++) {
        double load = wall_load(walls, w);
        if (wall_is_disc(walls, w))
            continue;
        if (!isfinite(load))
            return NAN;
        segments++;
        sum = vec_add(sum, vec_scale(load, wall_inward(walls, w)));
        largest = fmax(largest, fabs(load));
    }
    if (segments < 4)
        return NAN;
    for (size_t k = 0; k < grains->count; k++)
        sum = vec_add(sum, vec(column_or_zero(grains->load_x, k), column_or_zero(grains->load_y, k)));
    misfit[0] = sum.x, misfit[1] = sum.y;
    return largest > 0 ? vec_norm(sum) / largest : 0;
}

double network_radius(const struct grains *grains)
{
    double sum = 0;
    size_t count = 0;
    for (size_t k = 0; k < grains->count; k++)
        if (isfinite(grains->radius[k]))
            sum += grains->radius[k], count++;
    return count && sum > 0 ? sum / (double)count : 1;
}

/* A line n . x = at. */
struct line {
    struct vec n;
    double at;
};

static struct line line_of(const struct walls *walls, size_t w)
{
    struct vec in = wall_inward(walls, w);
    return (struct line){in, vec_dot(in, vec(walls->x0[w], walls->y0[w]))};
}

/* The far end of the packing in x (direction 0) or y, as a line. */
static struct line far_end(const struct grains *g, int direction)
{
    double low = INFINITY;
    for (size_t k = 0; k < g->count; k++) {
        double place = direction ? g->y[k] : g->x[k];
        low = fmin(low, isfinite(place) ? place - g->radius[k] : INFINITY);
    }
    return (struct line){direction ? vec(0, 1) : vec(1, 0), isfinite(low) ? low : 0};
}

/* Where the lines of the fixed walls meet: their reactions, along their normals, have no virial about it. A direction
 * without a fixed wall is counted from the far end of the packing. 0: a reaction cannot be left out so (two opposite
 * walls or a grain are fixed). */
static int far_corner(const struct packing *packing, const struct network *network, struct vec *corner)
{
    struct line line[2] = {far_end(&packing->grains, 0), far_end(&packing->grains, 1)};
    int held[2] = {0, 0}, exact = 1;
    for (size_t w = 0; w < packing->walls.count; w++) {
        if (network->wall_dof[w] >= 0 || wall_is_disc(&packing->walls, w))
            continue;
        int level = fabs(wall_inward(&packing->walls, w).x) <= 0.7;
        line[level] = line_of(&packing->walls, w);
        exact &= ++held[level] < 2;
    }
    for (size_t k = 0; k < packing->grains.count; k++)
        exact &= !network_fixes(packing, k);
    double determinant = vec_cross(line[0].n, line[1].n);
    *corner = vec((line[0].at * line[1].n.y - line[1].at * line[0].n.y) / determinant,
                  (line[1].at * line[0].n.x - line[0].at * line[1].n.x) / determinant);
    return exact && isfinite(corner->x) && isfinite(corner->y);
}

/* The sum of fn times branch length over the contacts, from the loads: -sum F . x about the far corner. */
static double virial_of_loads(const struct packing *packing, const struct network *network, int *exact)
{
    const struct grains *g = &packing->grains;
    struct vec corner;
    double virial = 0;
    *exact = far_corner(packing, network, &corner);
    for (size_t w = 0; w < packing->walls.count; w++) {
        if (network->wall_dof[w] < 0)
            continue;
        struct line line = line_of(&packing->walls, w);
        virial -= wall_load(&packing->walls, w) * (line.at - vec_dot(line.n, corner));
    }
    for (size_t k = 0; k < g->count; k++)
        if (network->grain_dof[k] >= 0)
            virial -= column_or_zero(g->load_x, k) * (g->x[k] - corner.x) +
                      column_or_zero(g->load_y, k) * (g->y[k] - corner.y);
    return virial;
}

/* <fn> from the loads; sets the virial, still in N m. */
static double force_from_loads(const struct packing *packing, struct network *network)
{
    double length = 0;
    int exact;
    for (size_t c = 0; c < network->count; c++)
        length += network->contact[c].length * network->radius;
    double virial = virial_of_loads(packing, network, &exact);
    network->virial = exact && virial > 0 ? virial : NAN;
    return length > 0 ? fabs(virial) / length : 0;
}

/* Mean load of a grain that is in the equations, per contact. */
static double load_per_contact(const struct packing *packing, const struct network *network)
{
    const struct grains *g = &packing->grains;
    double sum = 0;
    for (size_t k = 0; k < g->count; k++)
        if (network->grain_dof[k] >= 0)
            sum += hypot(column_or_zero(g->load_x, k), column_or_zero(g->load_y, k));
    return network->count ? sum / (double)network->count : 0;
}

/* The unit of force: from the loads, else from the overlaps, else 1 N. Loads on grains in all directions have next to
 * no virial, but need contact forces of their own size. */
double network_force(const struct packing *packing, const struct contact_law *law, struct network *network)
{
    double unit = force_from_loads(packing, network), sum = 0;
    unit = fmax(isfinite(unit) ? unit : 0, load_per_contact(packing, network));
    if (unit > 0)
        return unit;
    if (packing->contacts.overlap && isfinite(law->kn))
        for (size_t c = 0; c < network->count; c++)
            sum += fmax(0, law->kn * packing->contacts.overlap[network->contact[c].row]) / (double)network->count;
    return sum > 0 ? sum : 1;
}

void network_loads(const struct packing *packing, struct network *network)
{
    const struct grains *g = &packing->grains;
    for (size_t k = 0; k < network->grains; k++) {
        long dof = network->grain_dof[k];
        if (dof < 0)
            continue;
        network->load[dof] = column_or_zero(g->load_x, k) / network->force;
        network->load[dof + 1] = column_or_zero(g->load_y, k) / network->force;
        network->load[dof + 2] = column_or_zero(g->load_m, k) / (network->force * network->radius);
    }
    for (size_t w = 0; w < network->walls; w++)
        if (network->wall_dof[w] >= 0)
            network->load[network->wall_dof[w]] = wall_load(&packing->walls, w) / network->force;
}
