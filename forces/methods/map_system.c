/* The linear system of one step of map. Newton's equations in (y, l) are
 *
 *     [ A D A' + soft   A D n           ] [dy]     [ left of equilibrium ]
 *     [ n' D A'         D_nn + B B' + S ] [dl] = - [ left of overlaps    ]
 *
 * with D the 2 x 2 compliances and S the slacks. B B' couples contacts that share a grain; with e = B' l as unknowns
 * and l eliminated contact by contact a quasi-definite system in (y, e) is left, which has the pattern of the network.
 */
#include "forces/methods/map.h"

#include <stdlib.h>
#include <string.h>

#include "forces/algebra/arena.h"
#include "pipeline/speak/error.h"

/* Each contact couples the degrees of freedom and the errors that it touches. */
static struct sparse *system_matrix(const struct map *map)
{
    int *place = malloc((map->count * MAP_WIDTH + 1) * sizeof *place);
    if (!place) {
        error_set(EXIT_FAILED, "out of memory: map");
        return NULL;
    }
    for (size_t c = 0; c < map->count; c++) {
        memcpy(place + c * MAP_WIDTH, map->network->contact[c].dof, sizeof map->network->contact[c].dof);
        for (int k = 0; k < EVIDENCE_WIDTH; k++) {
            int error = map->evidence->place[c][k];
            place[c * MAP_WIDTH + NETWORK_WIDTH + (size_t)k] = error < 0 ? -1 : (int)map->dofs + error;
        }
    }
    struct sparse *matrix = sparse_create(map->dofs + map->errors, map->count, MAP_WIDTH, place);
    free(place);
    return matrix;
}

static size_t lay_out(struct map *map, double *block)
{
    struct arena taken = {.block = block}, *arena = &taken;
    size_t n = map->count, dofs = map->dofs, system = dofs + map->errors;
    map->soft = arena_take(arena, dofs), map->slack = arena_take(arena, n), map->weight = arena_take(arena, n);
    map->variance = arena_take(arena, 2 * n);
    map->y = arena_take(arena, dofs), map->l = arena_take(arena, n); /* side by side, as left and step are */
    map->forces = arena_take(arena, 2 * n), map->error = arena_take(arena, map->errors);
    map->left = arena_take(arena, dofs + n), map->step = arena_take(arena, dofs + n);
    map->right = arena_take(arena, system), map->found = arena_take(arena, system);
    map->diagonal = arena_take(arena, system);
    map->relative = arena_take(arena, 2 * n), map->dual = arena_take(arena, 2 * n),
    map->push = arena_take(arena, 2 * n);
    map->side = arena_rows(arena, n, 2), map->press = arena_rows(arena, n, 2);
    map->dside = arena_rows(arena, n, 2), map->dpress = arena_rows(arena, n, 2);
    map->target = arena_rows(arena, n, 2), map->push_side = arena_rows(arena, n, 2);
    map->compliance = arena_rows(arena, n, 3), map->curve = arena_rows(arena, n, 3);
    return arena->used;
}

int map_begin(const struct network *network, const struct force_options *options, const struct evidence *evidence,
              struct map *map)
{
    *map = (struct map){.network = network,
                        .options = options,
                        .evidence = evidence,
                        .rough = 1,
                        .dofs = network->dofs,
                        .count = network->count,
                        .errors = evidence->errors};
    map->size = lay_out(map, NULL) + 1;
    map->store = calloc(map->size, sizeof(double));
    if (!map->store)
        return error_memory("map");
    lay_out(map, map->store);
    memcpy(map->variance, evidence->variance, 2 * map->count * sizeof(double));
    map->matrix = system_matrix(map);
    return map->matrix ? 0 : -1;
}

void map_copy(const struct map *from, struct map *to)
{
    memcpy(to->store, from->store, from->size * sizeof(double));
    to->warm = from->warm;
    to->feasible = from->feasible;
    to->length = from->length;
}

void map_free(struct map *map)
{
    sparse_free(map->matrix);
    free(map->store);
    memset(map, 0, sizeof *map);
}

int map_measured(const struct map *map, size_t c)
{
    return isfinite(map->evidence->measured[c]);
}

double map_error_at(const struct map *map, size_t c)
{
    double sum = 0;
    for (int k = 0; k < EVIDENCE_WIDTH && map->evidence->place[c][k] >= 0; k++)
        sum += map->evidence->share[c][k] * map->error[map->evidence->place[c][k]];
    return sum;
}

void map_errors(struct map *map)
{
    memset(map->error, 0, map->errors * sizeof(double));
    for (size_t c = 0; c < map->count; c++)
        for (int k = 0; k < EVIDENCE_WIDTH && map->evidence->place[c][k] >= 0; k++)
            map->error[map->evidence->place[c][k]] += map->evidence->share[c][k] * map->l[c];
}

/* What a unit of the pull along its normal lets contact c do on its entry `dof`: (A D n) there. */
static double stroke(const struct map *map, size_t c, int dof)
{
    const struct network_contact *contact = &map->network->contact[c];
    return contact->n[dof] * map->curve[c][0] + contact->t[dof] * map->curve[c][1];
}

/* What contact c adds to the system: its equilibrium part less what its overlap equation takes up (d its pivot). */
static void add_block(struct map *map, size_t c)
{
    const struct network_contact *contact = &map->network->contact[c];
    const double *curve = map->curve[c], *share = map->evidence->share[c];
    double block[MAP_WIDTH * MAP_WIDTH] = {0}, a[NETWORK_WIDTH];
    int measured = map_measured(map, c);
    double d = curve[0] + map->slack[c], gain = measured ? 1 / d : 0;
    contact_block(contact, curve, MAP_WIDTH, block);
    for (int i = 0; i < NETWORK_WIDTH; i++) {
        a[i] = stroke(map, c, i);
        for (int j = 0; j <= i; j++)
            block[i * MAP_WIDTH + j] -= gain * a[i] * a[j];
    }
    for (int i = 0; i < EVIDENCE_WIDTH && measured; i++) {
        double *row = &block[(NETWORK_WIDTH + i) * MAP_WIDTH];
        for (int j = 0; j < NETWORK_WIDTH; j++)
            row[j] = -gain * share[i] * a[j];
        for (int j = 0; j <= i; j++)
            row[NETWORK_WIDTH + j] = -gain * share[i] * share[j];
    }
    sparse_add(map->matrix, c, block);
}

/* A mechanism can have a pivot that rounds to zero: then once more with a shift, which only shortens the step. */
int map_factorise(struct map *map)
{
    sparse_clear(map->matrix);
    for (size_t c = 0; c < map->count; c++)
        add_block(map, c);
    for (size_t d = 0; d < map->dofs; d++)
        map->diagonal[d] = map->soft[d];
    for (size_t k = 0; k < map->errors; k++)
        map->diagonal[map->dofs + k] = -1;
    sparse_add_diagonal(map->matrix, map->diagonal, 0);
    for (double shift = 1e-12; sparse_factorise_indefinite(map->matrix); shift *= 100) {
        if (shift > 1e-6)
            return -1;
        error_clear();
        for (size_t d = 0; d < map->dofs + map->errors; d++)
            map->diagonal[d] = d < map->dofs ? shift : 0;
        sparse_add_diagonal(map->matrix, map->diagonal, 0);
    }
    return 0;
}

/* The right-hand side in (y, e): l eliminated. */
static void fill_right(struct map *map)
{
    memset(map->right, 0, (map->dofs + map->errors) * sizeof(double));
    for (size_t d = 0; d < map->dofs; d++)
        map->right[d] = -map->left[d];
    for (size_t c = 0; c < map->count; c++) {
        const int *dof = map->network->contact[c].dof, *place = map->evidence->place[c];
        double g = map_measured(map, c) ? map->left[map->dofs + c] / (map->curve[c][0] + map->slack[c]) : 0;
        for (int k = 0; k < NETWORK_WIDTH && dof[k] >= 0; k++)
            map->right[dof[k]] += stroke(map, c, k) * g;
        for (int k = 0; k < EVIDENCE_WIDTH && place[k] >= 0; k++)
            map->right[map->dofs + (size_t)place[k]] += map->evidence->share[c][k] * g;
    }
}

/* dy from the system; dl contact by contact from its overlap equation. */
int map_back_solve(struct map *map)
{
    fill_right(map);
    if (sparse_solve(map->matrix, map->right, map->found))
        return -1;
    memcpy(map->step, map->found, map->dofs * sizeof(double));
    for (size_t c = 0; c < map->count; c++) {
        const int *dof = map->network->contact[c].dof, *place = map->evidence->place[c];
        double sum = map->left[map->dofs + c];
        for (int k = 0; k < NETWORK_WIDTH && dof[k] >= 0; k++)
            sum += stroke(map, c, k) * map->found[dof[k]];
        for (int k = 0; k < EVIDENCE_WIDTH && place[k] >= 0; k++)
            sum += map->evidence->share[c][k] * map->found[map->dofs + (size_t)place[k]];
        map->step[map->dofs + c] = map_measured(map, c) ? -sum / (map->curve[c][0] + map->slack[c]) : 0;
    }
    return 0;
}
