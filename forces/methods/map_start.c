/* Where the interior point of map begins. The mean force on every contact is a good place but for contacts that
 * equilibrium keeps at zero: two contacts hold a grain without load only if the line through them lies inside both
 * cones. Where it does not, their cones have no interior in common, and the interior point would need a step for every
 * halving of these forces. They begin in the corner of their cones instead; the solution is the same. */
#include "forces/methods/map.h"

#include <stdlib.h>
#include <string.h>

#include "pipeline/speak/error.h"

#define FIRST_GAP 10  /* side press at the start: about that of overlaps wrong by a few <fn> */
#define PARALLEL 1e-9 /* two contacts whose equations are this near to dependent are left alone */
#define EDGE 1e-9     /* of the larger force: nearer than this to the edge of a cone is inside */

/* Contacts of one grain that may carry force: how many, and the first two. */
struct bearing {
    int count, contact[2], entry[2]; /* entry: where the grain's equations stand in the contact */
};

/* The forces (fn, ft) of two contacts that balance each other on a grain, up to a factor: the null vector of three
 * equations, by Cramer's rule. 0: not unique. */
static int balance_two(const struct network_contact *const contact[2], const int at[2], double v[4])
{
    double a[3][4], largest = 0;
    for (int d = 0; d < 3; d++)
        for (int k = 0; k < 2; k++)
            a[d][2 * k] = contact[k]->n[at[k] + d], a[d][2 * k + 1] = contact[k]->t[at[k] + d];
    for (int k = 0; k < 4; k++) {
        int p = k == 0, q = k <= 1 ? 2 : 1, r = k <= 2 ? 3 : 2;
        v[k] = a[0][p] * (a[1][q] * a[2][r] - a[1][r] * a[2][q]) - a[0][q] * (a[1][p] * a[2][r] - a[1][r] * a[2][p]) +
               a[0][r] * (a[1][p] * a[2][q] - a[1][q] * a[2][p]);
        v[k] *= k % 2 ? -1 : 1;
        largest = fmax(largest, fabs(v[k]));
    }
    return largest > PARALLEL;
}

/* Is one of both signs of that pair inside both cones? Two contacts whose equations are dependent can hold anything. */
static int can_hold(const struct network_contact *const contact[2], const int at[2])
{
    double v[4], edge;
    if (!balance_two(contact, at, v))
        return 1;
    edge = EDGE * fmax(fabs(v[0]), fabs(v[2]));
    for (int sign = -1; sign <= 1; sign += 2) {
        int inside = 1;
        for (int k = 0; k < 2; k++)
            inside &= sign * v[2 * k] > 0 && fabs(v[2 * k + 1]) <= contact[k]->mu * sign * v[2 * k] + edge;
        if (inside)
            return 1;
    }
    return 0;
}

/* Does anything but its contacts push the grain with these degrees of freedom? */
static int loaded(const struct map *map, long dof)
{
    for (long d = dof; d < dof + 3; d++)
        if (map->network->load[d] != 0 || map->evidence->soft[d] != 0)
            return 1;
    return 0;
}

static void count_bearings(const struct map *map, const unsigned char *idle, struct bearing *of_dof)
{
    memset(of_dof, 0, map->dofs * sizeof *of_dof);
    for (size_t c = 0; c < map->count; c++)
        for (int e = 0; e < NETWORK_WIDTH && !idle[c] && map->network->contact[c].dof[e] >= 0; e++) {
            struct bearing *bearing = &of_dof[map->network->contact[c].dof[e]];
            if (bearing->count < 2)
                bearing->contact[bearing->count] = (int)c, bearing->entry[bearing->count] = e;
            bearing->count++;
        }
}

/* Marks the contacts that grains with two contacts keep from carrying; then their neighbours may have but two. */
static void find_idle(const struct map *map, struct bearing *of_dof, unsigned char *idle)
{
    for (int again = 1; again;) {
        again = 0;
        count_bearings(map, idle, of_dof);
        for (size_t k = 0; k < map->network->grains; k++) {
            long dof = map->network->grain_dof[k];
            if (dof < 0 || of_dof[dof].count == 0 || of_dof[dof].count > 2 || loaded(map, dof))
                continue;
            const struct bearing *bearing = &of_dof[dof];
            const struct network_contact *contact[2] = {&map->network->contact[bearing->contact[0]],
                                                        &map->network->contact[bearing->contact[1]]};
            if (bearing->count == 2 && can_hold(contact, bearing->entry))
                continue;
            for (int e = 0; e < bearing->count; e++)
                again |= !idle[bearing->contact[e]], idle[bearing->contact[e]] = 1;
        }
    }
}

/* The force that the unknown loads leave to a contact in the corner of its cone. */
static double corner_force(const struct map *map, size_t c)
{
    double soft = 0;
    for (int e = 0; e < NETWORK_WIDTH && map->network->contact[c].dof[e] >= 0; e++)
        soft = fmax(soft, map->soft[map->network->contact[c].dof[e]]);
    return sqrt(map->weight[c] * soft);
}

/* No friction; side and press such that their product is FIRST_GAP, or, in the corner, the weight. */
static void place(struct map *map, size_t c, int idle)
{
    double fn = idle ? corner_force(map, c) : 1;
    map_set_force(map, c, fn);
    for (int k = 0; k < 2; k++)
        map->press[c][k] = (idle ? map->weight[c] : FIRST_GAP) / map->side[c][k];
}

int map_cold_start(struct map *map)
{
    struct bearing *of_dof = malloc((map->dofs + 1) * sizeof *of_dof);
    unsigned char *idle = calloc(map->count + 1, 1);
    int status = of_dof && idle ? 0 : error_memory("map");
    if (!status) {
        find_idle(map, of_dof, idle);
        memset(map->y, 0, (map->dofs + map->count) * sizeof(double));
        for (size_t c = 0; c < map->count; c++)
            place(map, c, idle[c]);
        map->length = 1;
    }
    free(of_dof), free(idle);
    return status;
}
