#include "pipeline/packing/structure.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "pipeline/numbers/rank.h"
#include "pipeline/speak/error.h"

void packing_fabric(const struct packing *packing, double area, struct fabric *fabric)
{
    const struct contacts *contacts = &packing->contacts;
    const struct grains *grains = &packing->grains;
    double grain_area = 0;
    memset(fabric, 0, sizeof *fabric);
    for (size_t k = 0; k < grains->count; k++) {
        double r = grains->radius[k];
        if (isfinite(r))
            grain_area += M_PI * r * r;
        fabric->rattlers += (grains->flags[k] & GRAIN_RATTLER) != 0;
    }
    for (size_t c = 0; c < contacts->count; c++) {
        size_t wall;
        struct vec n = vec(contacts->nx[c], contacts->ny[c]);
        if ((contacts->flags[c] & CONTACT_CANDIDATE) || isnan(n.x) || isnan(n.y))
            continue;
        fabric->contacts++;
        fabric->wall_contacts += (size_t)packing_is_wall(packing, c, &wall);
        tensor_add(fabric->tensor, n, n);
    }
    if (fabric->contacts)
        tensor_scale(fabric->tensor, 1 / (double)fabric->contacts);
    fabric->z = (double)(2 * fabric->contacts - fabric->wall_contacts) / (double)grains->count;
    fabric->solid = grain_area / area;
    fabric->void_ratio = 1 / fabric->solid - 1;
}

/* ---- indeterminacy ---- */

/* The equations: row[b] is the first of body b's rows, NONE when it has none. Moments are divided by the radius,
 * so that all entries are of size 1. */
struct equations {
    size_t count, *row;
    struct vec *place;
};
static const size_t NONE = (size_t)-1;

/* Rattlers and grains without a place take no part in equilibrium. */
static int carries(const struct grains *grains, size_t k)
{
    return !(grains->flags[k] & (GRAIN_RATTLER | GRAIN_NOT_FINITE));
}

static int number_equations(const struct packing *packing, struct equations *e)
{
    const struct grains *grains = &packing->grains;
    size_t bodies = grains->count + packing->walls.count;
    e->row = malloc((bodies + 1) * sizeof *e->row);
    e->place = malloc((3 * bodies + 1) * sizeof *e->place);
    if (!e->row || !e->place)
        return error_memory("equations of equilibrium");
    for (size_t k = 0; k < grains->count; k++) {
        int free = carries(grains, k) && !(grains->flags[k] & GRAIN_FIXED);
        e->row[k] = free ? e->count : NONE;
        for (int d = 0; free && d < 3; d++)
            e->place[e->count++] = vec(grains->x[k], grains->y[k]);
    }
    for (size_t w = 0; w < packing->walls.count; w++) {
        int moves = wall_moves(&packing->walls, w);
        e->row[grains->count + w] = moves ? e->count : NONE;
        if (moves)
            e->place[e->count++] = vec(NAN, NAN);
    }
    return 0;
}

/* The column has room for it. */
static void add_entry(struct rank_column *column, size_t row, double value)
{
    column->row[column->count] = row;
    column->value[column->count++] = value;
}

/* A unit force in direction `along` at contact c, on a grain. */
static void add_grain(const struct packing *packing, const struct equations *e, size_t c, size_t k, struct vec along,
                      struct rank_column *column)
{
    struct vec arm = vec(packing->contacts.x[c] - packing->grains.x[k], packing->contacts.y[c] - packing->grains.y[k]);
    if (e->row[k] == NONE)
        return;
    add_entry(column, e->row[k], along.x);
    add_entry(column, e->row[k] + 1, along.y);
    add_entry(column, e->row[k] + 2, vec_cross(arm, along) / packing->grains.radius[k]);
}

/* ... and on a wall; on the x (y) part of a corner disc for its side (top or bottom) wall. */
static void add_wall(const struct packing *packing, const struct equations *e, size_t w, struct vec along,
                     struct rank_column *column)
{
    const struct walls *walls = &packing->walls;
    const size_t *row = e->row + packing->grains.count;
    if (!wall_is_disc(walls, w)) {
        if (row[w] != NONE)
            add_entry(column, row[w], vec_dot(wall_inward(walls, w), along));
        return;
    }
    long side = walls_find(walls, strstr(walls->name[w], "left") ? "left" : "right");
    long flat = walls_find(walls, strstr(walls->name[w], "top") ? "top" : "bottom");
    if (side >= 0 && row[side] != NONE)
        add_entry(column, row[side], wall_inward(walls, (size_t)side).x * along.x);
    if (flat >= 0 && row[flat] != NONE)
        add_entry(column, row[flat], wall_inward(walls, (size_t)flat).y * along.y);
}

/* A contact that exists, between bodies that carry. */
static int bears(const struct packing *packing, size_t c)
{
    size_t i = (size_t)packing->contacts.i[c], j = (size_t)packing->contacts.j[c];
    return !(packing->contacts.flags[c] & (CONTACT_CANDIDATE | CONTACT_NOT_FINITE)) && carries(&packing->grains, i) &&
           (j >= packing->grains.count || carries(&packing->grains, j));
}

/* A column per unknown force; one between bodies that cannot move has no entries. */
static size_t fill_columns(const struct packing *packing, const struct equations *e, const double mu[2],
                           struct rank_column *columns)
{
    size_t count = 0;
    for (size_t c = 0; c < packing->contacts.count; c++) {
        size_t i = (size_t)packing->contacts.i[c], j = (size_t)packing->contacts.j[c], wall;
        int is_wall = packing_is_wall(packing, c, &wall);
        struct vec along = vec(packing->contacts.nx[c], packing->contacts.ny[c]);
        for (int part = 0; bears(packing, c) && part < (mu[is_wall] == 0 ? 1 : 2); part++) {
            struct rank_column *column = &columns[count++];
            column->count = 0;
            add_grain(packing, e, c, i, vec_scale(-1, along), column);
            if (is_wall)
                add_wall(packing, e, wall, along, column);
            else
                add_grain(packing, e, c, j, along, column);
            along = vec_turn(along);
        }
    }
    return count;
}

int packing_indeterminacy(const struct packing *packing, double mu, double mu_wall, struct indeterminacy *out)
{
    struct equations e = {0};
    struct rank_column *columns = malloc((2 * packing->contacts.count + 1) * sizeof *columns);
    size_t unknowns = 0, rank = 0, rattlers = 0;
    int status = columns ? number_equations(packing, &e) : error_memory("equations of equilibrium");
    if (status == 0) {
        unknowns = fill_columns(packing, &e, (const double[2]){mu, mu_wall}, columns);
        status = rank_of(columns, unknowns, e.place, e.count, &rank);
    }
    for (size_t k = 0; k < packing->grains.count; k++)
        rattlers += (packing->grains.flags[k] & GRAIN_RATTLER) != 0;
    *out = (struct indeterminacy){
        .known = status == 0,
        .h = (double)unknowns - (double)rank,
        .mechanisms = (double)(e.count - rank) + 3 * (double)rattlers,
    };
    free(columns);
    free(e.row);
    free(e.place);
    return status;
}
