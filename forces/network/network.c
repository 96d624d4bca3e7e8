/* How A, b and the masses come about. A contact (fn, ft) acts with fn n + ft t on its second body j and with the
 * opposite on i, n pointing from i to j and t being n turned to the left; the moment about a grain's centre is arm x
 * force, arm from the centre to the contact point. Each body's equations are divided by the unit of force, moments also
 * by the mean radius. A straight wall has one equation, along its inward normal; a corner disc belongs to two walls and
 * acts in the equations of both. */
#include "forces/network/network.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "forces/network/network_loads.h"
#include "forces/network/network_parts.h"
#include "pipeline/speak/error.h"

/* Three per grain that moves, in the order of the grains, then one per free wall. */
static void number_dofs(const struct packing *packing, struct network *network)
{
    size_t next = 0;
    for (size_t k = 0; k < network->grains; k++) {
        int moves = !network_fixes(packing, k) && !network->peeled[k];
        network->grain_dof[k] = moves ? (long)next : -1;
        next += moves ? 3 : 0;
    }
    for (size_t w = 0; w < network->walls; w++)
        network->wall_dof[w] = wall_moves(&packing->walls, w) ? (long)next++ : -1;
    network->dofs = next;
}

static void add_entry(struct network_contact *contact, int *at, long dof, double n, double t)
{
    contact->dof[*at] = (int)dof;
    contact->n[*at] = n;
    contact->t[*at] = t;
    ++*at;
}

/* The three equations of a grain: sign -1 for i, which feels the opposite of (fn, ft). */
static void add_grain(const struct packing *packing, const struct network *network, size_t c, size_t grain, double sign,
                      struct network_contact *contact, int *at)
{
    long dof = network->grain_dof[grain];
    if (dof < 0)
        return;
    struct vec n = vec(packing->contacts.nx[c], packing->contacts.ny[c]), t = vec_turn(n);
    struct vec arm = vec_scale(1 / network->radius, vec_sub(vec(packing->contacts.x[c], packing->contacts.y[c]),
                                                            vec(packing->grains.x[grain], packing->grains.y[grain])));
    add_entry(contact, at, dof, sign * n.x, sign * t.x);
    add_entry(contact, at, dof + 1, sign * n.y, sign * t.y);
    add_entry(contact, at, dof + 2, sign * vec_cross(arm, n), sign * vec_cross(arm, t));
}

/* Motion of a corner disc in x (with its side wall) or y (with its top or bottom wall). */
static void add_disc_part(const struct packing *packing, const struct network *network, const char *wall, int vertical,
                          struct vec n, struct network_contact *contact, int *at)
{
    long w = walls_find(&packing->walls, wall);
    if (w < 0 || network->wall_dof[w] < 0)
        return;
    struct vec in = wall_inward(&packing->walls, (size_t)w), t = vec_turn(n);
    add_entry(contact, at, network->wall_dof[w], vertical ? in.y * n.y : in.x * n.x,
              vertical ? in.y * t.y : in.x * t.x);
}

/* Where a wall is fixed its contacts push against nothing that could move: no entry. */
static void add_wall(const struct packing *packing, const struct network *network, size_t c, size_t wall,
                     struct network_contact *contact, int *at)
{
    struct vec n = vec(packing->contacts.nx[c], packing->contacts.ny[c]);
    const char *name = packing->walls.name[wall];
    if (wall_is_disc(&packing->walls, wall)) {
        add_disc_part(packing, network, strstr(name, "left") ? "left" : "right", 0, n, contact, at);
        add_disc_part(packing, network, strstr(name, "top") ? "top" : "bottom", 1, n, contact, at);
    } else if (network->wall_dof[wall] >= 0) {
        struct vec in = wall_inward(&packing->walls, wall);
        add_entry(contact, at, network->wall_dof[wall], vec_dot(in, n), vec_dot(in, vec_turn(n)));
    }
}

/* Contacts between two bodies that cannot move have no equation and are left out. */
static void add_contact(const struct packing *packing, const struct contact_law *law, size_t c, struct network *network)
{
    struct network_contact contact = {.row = c, .dof = {-1, -1, -1, -1, -1, -1}, .mu = law->mu};
    size_t wall;
    int at = 0;
    add_grain(packing, network, c, (size_t)packing->contacts.i[c], -1, &contact, &at);
    if (packing_is_wall(packing, c, &wall)) {
        add_wall(packing, network, c, wall, &contact, &at);
        contact.mu = law->mu_wall;
    } else {
        add_grain(packing, network, c, (size_t)packing->contacts.j[c], 1, &contact, &at);
    }
    contact.length = vec_norm(packing_branch(packing, c)) / network->radius;
    if (at > 0)
        network->contact[network->count++] = contact;
}

/* 1: masses and moments of inertia are known; 0: of no moving grain; -1: of some only. */
static int masses_known(const struct packing *packing, const struct network *network)
{
    const struct grains *g = &packing->grains;
    size_t moving = 0, known = 0, bad = 0;
    for (size_t k = 0; k < network->grains; k++) {
        if (network->grain_dof[k] < 0)
            continue;
        double mass = g->mass ? g->mass[k] : NAN, inertia = g->inertia ? g->inertia[k] : NAN;
        int good = mass > 0 && inertia > 0 && isfinite(mass) && isfinite(inertia);
        moving++, known += (size_t)good;
        bad = good ? bad : k;
    }
    if (known > 0 && known < moving)
        return error_input("grain %zu has no mass and moment of inertia above 0, others have: run contacts again", bad);
    return moving > 0 && known == moving;
}

/* Masses as in the file; where no grain has one, proportional to the square of the radius. */
static int fill_masses(const struct packing *packing, double wall_mass, struct network *network)
{
    const struct grains *g = &packing->grains;
    double mean = 0, moving = 0;
    int known = masses_known(packing, network);
    if (known < 0)
        return -1;
    for (size_t k = 0; k < network->grains; k++)
        if (network->grain_dof[k] >= 0)
            mean += known ? g->mass[k] : g->radius[k] * g->radius[k], moving++;
    mean = moving > 0 ? mean / moving : 1;
    for (size_t k = 0; k < network->grains; k++) {
        long dof = network->grain_dof[k];
        if (dof < 0)
            continue;
        double square = g->radius[k] * g->radius[k];
        double mass = known ? g->mass[k] : square, inertia = known ? g->inertia[k] : square * square / 2;
        network->inverse_mass[dof] = network->inverse_mass[dof + 1] = mean / mass;
        network->inverse_mass[dof + 2] = mean * network->radius * network->radius / inertia;
    }
    for (size_t w = 0; w < network->walls; w++)
        if (network->wall_dof[w] >= 0)
            network->inverse_mass[network->wall_dof[w]] = 1 / wall_mass;
    return 0;
}

/* All arrays for the most there can be: nobody moves, everybody counts. */
static int network_alloc(const struct packing *packing, struct network *network)
{
    network->grains = packing->grains.count;
    network->walls = packing->walls.count;
    size_t dofs = 3 * network->grains + network->walls;
    if (dofs > 200u * 1000 * 1000)
        return error_input("%zu grains: cut the packing", network->grains);
    network->contact = calloc(packing->contacts.count + 1, sizeof *network->contact);
    network->load = calloc(dofs + 1, sizeof(double));
    network->inverse_mass = calloc(dofs + 1, sizeof(double));
    network->grain_dof = calloc(network->grains + 1, sizeof(long));
    network->wall_dof = calloc(network->walls + 1, sizeof(long));
    network->peeled = calloc(network->grains + 1, 1);
    if (!network->contact || !network->load || !network->inverse_mass || !network->grain_dof || !network->wall_dof ||
        !network->peeled)
        return error_memory("equilibrium equations");
    return 0;
}

/* The order matters: what is peeled has no equations, the unit of force needs the contacts, the loads need the unit. */
static int fill(const struct packing *packing, const struct contact_law *law, const struct network_options *options,
                struct network *network)
{
    unsigned char *live = calloc(packing->contacts.count + 1, 1);
    if (!live)
        return error_memory("equilibrium equations");
    for (size_t c = 0; c < packing->contacts.count; c++)
        live[c] = network_offers(packing, options, c) != 0;
    if (network_peel(packing, law, live, network->peeled)) {
        free(live);
        return -1;
    }
    number_dofs(packing, network);
    for (size_t c = 0; c < packing->contacts.count; c++)
        if (live[c])
            add_contact(packing, law, c, network);
    free(live);
    network->force = network_force(packing, law, network);
    network->virial /= network->force * network->radius;
    network_load_misfit(packing, network->misfit);
    network_loads(packing, network);
    return fill_masses(packing, options->wall_mass, network);
}

int network_build(const struct packing *packing, const struct contact_law *law, const struct network_options *options,
                  struct network *network)
{
    memset(network, 0, sizeof *network);
    if (!isfinite(law->mu) || law->mu < 0 || !isfinite(law->mu_wall) || law->mu_wall < 0)
        return error_input("no friction coefficient: give the scene contact.mu (and mu_wall), 0 or more");
    if (network_check(packing, options))
        return -1;
    network->radius = network_radius(&packing->grains);
    if (network_alloc(packing, network) || fill(packing, law, options, network)) {
        network_free(network);
        return -1;
    }
    return 0;
}

void network_free(struct network *network)
{
    free(network->contact);
    free(network->load);
    free(network->inverse_mass);
    free(network->grain_dof);
    free(network->wall_dof);
    free(network->peeled);
    memset(network, 0, sizeof *network);
}

void network_unbalance(const struct network *network, const double *f, double *out)
{
    memcpy(out, network->load, network->dofs * sizeof *out);
    for (size_t c = 0; c < network->count; c++)
        contact_push(&network->contact[c], f[2 * c], f[2 * c + 1], out);
}

void network_motion(const struct network *network, const double *motion, double *u)
{
    for (size_t c = 0; c < network->count; c++) {
        const struct network_contact *contact = &network->contact[c];
        double un = 0, ut = 0;
        for (int e = 0; e < NETWORK_WIDTH && contact->dof[e] >= 0; e++) {
            un += contact->n[e] * motion[contact->dof[e]];
            ut += contact->t[e] * motion[contact->dof[e]];
        }
        u[2 * c] = un;
        u[2 * c + 1] = ut;
    }
}

double network_mean_force(const struct network *network, const double *f)
{
    double mean = forces_mean(f, network->count, 2, NULL);
    return isnan(mean) ? 1 : mean;
}

double network_judge(const struct network *network, const double *f, double *work)
{
    double largest = 0;
    int known = 1;
    network_unbalance(network, f, work);
    for (size_t d = 0; d < network->dofs; d++) {
        largest = fmax(largest, fabs(work[d]));
        known &= !isnan(work[d]);
    }
    return known ? largest / network_mean_force(network, f) : NAN;
}

/* Each contact couples the degrees of freedom that it touches, and nothing else. */
struct sparse *network_matrix(const struct network *network)
{
    int *place = malloc((network->count * NETWORK_WIDTH + 1) * sizeof *place);
    if (!place) {
        error_set(EXIT_FAILED, "out of memory: equilibrium equations");
        return NULL;
    }
    for (size_t c = 0; c < network->count; c++)
        memcpy(place + c * NETWORK_WIDTH, network->contact[c].dof, sizeof network->contact[c].dof);
    struct sparse *matrix = sparse_create(network->dofs, network->count, NETWORK_WIDTH, place);
    free(place);
    return matrix;
}
