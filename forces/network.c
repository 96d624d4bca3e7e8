#include "forces/network.h"

#include <stdlib.h>
#include <string.h>

#include "pipeline/error.h"

static int load_given(double normal, double component)
{
    return isfinite(component) || fabs(normal) < 1e-6;
}

/* Load on a segment along its inward normal; NaN: not given, the wall is fixed. A component at right angles to the
 * normal may be missing. */
static double wall_load(const struct walls *walls, size_t w)
{
    struct vec in = wall_inward(walls, w);
    if (wall_is_disc(walls, w) || !load_given(in.x, walls->fx[w]) || !load_given(in.y, walls->fy[w]))
        return NAN;
    return (isfinite(walls->fx[w]) ? in.x * walls->fx[w] : 0) + (isfinite(walls->fy[w]) ? in.y * walls->fy[w] : 0);
}

static int wall_loaded(const struct walls *walls, const char *name)
{
    long w = walls_find(walls, name);
    return w >= 0 && isfinite(wall_load(walls, (size_t)w));
}

/* Opposite walls that are both loaded could drift away together: left and bottom become reactions. */
static int wall_free(const struct walls *walls, size_t w)
{
    if (!isfinite(wall_load(walls, w)))
        return 0;
    if (!strncmp(walls->name[w], "left", NAME_LENGTH))
        return !wall_loaded(walls, "right");
    if (!strncmp(walls->name[w], "bottom", NAME_LENGTH))
        return !wall_loaded(walls, "top");
    return 1;
}

static double grain_load(const double *column, size_t k)
{
    return column ? column[k] : 0;
}

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
        sum = vec_add(sum, vec(grain_load(grains->load_x, k), grain_load(grains->load_y, k)));
    misfit[0] = sum.x, misfit[1] = sum.y;
    return largest > 0 ? vec_norm(sum) / largest : 0;
}

/* ---- what takes part ---- */

static int contact_offered(const struct packing *packing, const struct network_options *options, size_t c)
{
    uint32_t flags = packing->contacts.flags ? packing->contacts.flags[c] : 0;
    return !(flags & CONTACT_NOT_FINITE) && (options->candidates || !(flags & CONTACT_CANDIDATE));
}

static int grain_fixed(const struct packing *packing, size_t k)
{
    return packing->grains.flags && (packing->grains.flags[k] & GRAIN_FIXED);
}

static int check_contacts(const struct packing *packing, const struct network_options *options)
{
    const struct contacts *c = &packing->contacts;
    int64_t bodies = (int64_t)(packing->grains.count + packing->walls.count);
    for (size_t k = 0; k < c->count; k++) {
        if (!contact_offered(packing, options, k))
            continue;
        if (c->i[k] < 0 || c->i[k] >= (int64_t)packing->grains.count || c->j[k] <= c->i[k] || c->j[k] >= bodies)
            return error_input("contact %zu joins %lld and %lld: give 0 <= i < j below the number of grains and walls",
                               k, (long long)c->i[k], (long long)c->j[k]);
        if (!isfinite(c->nx[k]) || !isfinite(c->ny[k]) || fabs(hypot(c->nx[k], c->ny[k]) - 1) > 1e-6)
            return error_input("contact %zu has no unit normal: run contacts again, or flag the row", k);
        if (!isfinite(c->x[k]) || !isfinite(c->y[k]))
            return error_input(
                "contact %zu has a contact point that is not finite: run contacts again, or flag the row", k);
    }
    return 0;
}

static int check_grains(const struct packing *packing)
{
    const struct grains *g = &packing->grains;
    for (size_t k = 0; k < g->count; k++) {
        if (g->flags && (g->flags[k] & GRAIN_DISTRUST))
            continue; /* its contacts are flagged, or were made of numbers that are finite */
        if (!isfinite(g->x[k]) || !isfinite(g->y[k]) || !(g->radius[k] > 0))
            return error_input("grain %zu has no finite place or radius: run contacts again, or flag the row", k);
        if (!isfinite(grain_load(g->load_x, k)) || !isfinite(grain_load(g->load_y, k)) ||
            !isfinite(grain_load(g->load_m, k)))
            return error_input("grain %zu has a load that is not finite: give its density, or leave gravity out", k);
    }
    return 0;
}

static int check_held(const struct packing *packing)
{
    if (packing->walls.count > 0)
        return 0;
    for (size_t k = 0; k < packing->grains.count; k++)
        if (grain_fixed(packing, k))
            return 0;
    return error_input("nothing holds the packing: give the scene a frame, or flag a grain as fixed");
}

/* Can one contact alone hold this grain? Its force must be opposite to the load and push. */
static int load_along(const struct packing *packing, size_t k, size_t c, double mu)
{
    const struct grains *g = &packing->grains;
    struct vec load = vec(grain_load(g->load_x, k), grain_load(g->load_y, k));
    struct vec n = vec(packing->contacts.nx[c], packing->contacts.ny[c]);
    double push = vec_dot(load, n) * (packing->contacts.i[c] == (int64_t)k ? 1 : -1);
    return push > 0 && fabs(vec_cross(n, load)) <= fmax(mu, 1e-6) * push;
}

/* Grains with fewer than two contacts carry nothing and go, then those that leaned on them, and so on. A loaded grain
 * that stands on one contact stays. */
static int peel(const struct packing *packing, const struct contact_law *law, unsigned char *live,
                unsigned char *peeled)
{
    const struct contacts *contacts = &packing->contacts;
    size_t grains = packing->grains.count;
    size_t *degree = calloc(grains + 1, sizeof *degree), *last = calloc(grains + 1, sizeof *last);
    if (!degree || !last) {
        free(degree), free(last);
        return error_memory("rattlers");
    }
    for (int again = 1; again;) {
        again = 0;
        memset(degree, 0, grains * sizeof *degree);
        for (size_t c = 0; c < contacts->count; c++) {
            if (!live[c])
                continue;
            size_t ends[2] = {(size_t)contacts->i[c], (size_t)contacts->j[c]};
            for (int e = 0; e < 2; e++)
                if (ends[e] < grains)
                    degree[ends[e]]++, last[ends[e]] = c;
        }
        for (size_t k = 0; k < grains; k++) {
            if (peeled[k] || grain_fixed(packing, k) || degree[k] > 1)
                continue;
            if (degree[k] == 1 && load_along(packing, k, last[k], law->mu))
                continue;
            peeled[k] = 1;
            again |= degree[k] == 1;
            if (degree[k] == 1)
                live[last[k]] = 0;
        }
    }
    free(degree), free(last);
    return 0;
}

/* ---- units ---- */

static double mean_radius(const struct grains *grains)
{
    double sum = 0;
    size_t count = 0;
    for (size_t k = 0; k < grains->count; k++)
        if (isfinite(grains->radius[k]))
            sum += grains->radius[k], count++;
    return count && sum > 0 ? sum / (double)count : 1;
}

/* Where the lines of the fixed walls meet: their reactions, along their normals, have no virial about it. A direction
 * without a fixed wall is counted from the far end of the packing. 0: a reaction cannot be left out so (two opposite
 * walls or a grain are fixed). */
static int far_corner(const struct packing *packing, const struct network *network, double corner[2])
{
    const struct grains *g = &packing->grains;
    int held[2] = {0, 0}, exact = 1;
    for (size_t w = 0; w < packing->walls.count; w++) {
        if (network->wall_dof[w] >= 0 || wall_is_disc(&packing->walls, w))
            continue;
        int upright = fabs(wall_inward(&packing->walls, w).x) > 0.7;
        double x = 0.5 * (packing->walls.x0[w] + packing->walls.x1[w]);
        corner[!upright] = upright ? x : 0.5 * (packing->walls.y0[w] + packing->walls.y1[w]);
        exact &= ++held[!upright] < 2;
    }
    double low[2] = {INFINITY, INFINITY};
    for (size_t k = 0; k < g->count; k++) {
        exact &= !grain_fixed(packing, k);
        low[0] = fmin(low[0], isfinite(g->x[k]) ? g->x[k] - g->radius[k] : INFINITY);
        low[1] = fmin(low[1], isfinite(g->y[k]) ? g->y[k] - g->radius[k] : INFINITY);
    }
    for (int d = 0; d < 2; d++)
        if (held[d] != 1)
            corner[d] = isfinite(low[d]) ? low[d] : 0;
    return exact;
}

/* The sum of fn times branch length over the contacts, from the loads: -sum F . x about the far corner. */
static double virial_of_loads(const struct packing *packing, const struct network *network, int *exact)
{
    const struct grains *g = &packing->grains;
    double corner[2], virial = 0;
    *exact = far_corner(packing, network, corner);
    for (size_t w = 0; w < packing->walls.count; w++) {
        if (network->wall_dof[w] < 0)
            continue;
        struct vec in = wall_inward(&packing->walls, w);
        struct vec middle = vec(0.5 * (packing->walls.x0[w] + packing->walls.x1[w]) - corner[0],
                                0.5 * (packing->walls.y0[w] + packing->walls.y1[w]) - corner[1]);
        virial -= wall_load(&packing->walls, w) * vec_dot(in, middle);
    }
    for (size_t k = 0; k < g->count; k++)
        if (network->grain_dof[k] >= 0)
            virial -=
                grain_load(g->load_x, k) * (g->x[k] - corner[0]) + grain_load(g->load_y, k) * (g->y[k] - corner[1]);
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
            sum += hypot(grain_load(g->load_x, k), grain_load(g->load_y, k));
    return network->count ? sum / (double)network->count : 0;
}

/* The unit of force: from the loads, else from the overlaps, else 1 N. Loads on grains in all directions have next to
 * no virial, but need contact forces of their own size. */
static double force_unit(const struct packing *packing, const struct contact_law *law, struct network *network)
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

/* ---- equations ---- */

static void number_dofs(const struct packing *packing, struct network *network)
{
    size_t next = 0;
    for (size_t k = 0; k < network->grains; k++) {
        int moves = !grain_fixed(packing, k) && !network->peeled[k];
        network->grain_dof[k] = moves ? (long)next : -1;
        next += moves ? 3 : 0;
    }
    for (size_t w = 0; w < network->walls; w++)
        network->wall_dof[w] = wall_free(&packing->walls, w) ? (long)next++ : -1;
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

static void fill_loads(const struct packing *packing, struct network *network)
{
    const struct grains *g = &packing->grains;
    for (size_t k = 0; k < network->grains; k++) {
        long dof = network->grain_dof[k];
        if (dof < 0)
            continue;
        network->load[dof] = grain_load(g->load_x, k) / network->force;
        network->load[dof + 1] = grain_load(g->load_y, k) / network->force;
        network->load[dof + 2] = grain_load(g->load_m, k) / (network->force * network->radius);
    }
    for (size_t w = 0; w < network->walls; w++)
        if (network->wall_dof[w] >= 0)
            network->load[network->wall_dof[w]] = wall_load(&packing->walls, w) / network->force;
}

/* Masses as in the file; without them proportional to the square of the radius. */
static void fill_masses(const struct packing *packing, double wall_mass, struct network *network)
{
    const struct grains *g = &packing->grains;
    double mean = 0;
    int known = g->mass && g->inertia;
    for (size_t k = 0; k < network->grains && known; k++)
        known = network->grain_dof[k] < 0 || (g->mass[k] > 0 && g->inertia[k] > 0);
    for (size_t k = 0; k < network->grains; k++)
        if (network->grain_dof[k] >= 0)
            mean += known ? g->mass[k] : g->radius[k] * g->radius[k];
    size_t moving = 0;
    for (size_t k = 0; k < network->grains; k++)
        moving += network->grain_dof[k] >= 0;
    mean = moving ? mean / (double)moving : 1;
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
}

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

static int fill(const struct packing *packing, const struct contact_law *law, const struct network_options *options,
                struct network *network)
{
    unsigned char *live = calloc(packing->contacts.count + 1, 1);
    if (!live)
        return error_memory("equilibrium equations");
    for (size_t c = 0; c < packing->contacts.count; c++)
        live[c] = contact_offered(packing, options, c) != 0;
    if (peel(packing, law, live, network->peeled)) {
        free(live);
        return -1;
    }
    number_dofs(packing, network);
    for (size_t c = 0; c < packing->contacts.count; c++)
        if (live[c])
            add_contact(packing, law, c, network);
    free(live);
    network->force = force_unit(packing, law, network);
    network->virial /= network->force * network->radius;
    network_load_misfit(packing, network->misfit);
    fill_loads(packing, network);
    fill_masses(packing, options->wall_mass, network);
    return 0;
}

int network_build(const struct packing *packing, const struct contact_law *law, const struct network_options *options,
                  struct network *network)
{
    memset(network, 0, sizeof *network);
    if (!isfinite(law->mu) || law->mu < 0 || !isfinite(law->mu_wall) || law->mu_wall < 0)
        return error_input("no friction coefficient: give the scene contact.mu (and mu_wall), 0 or more");
    if (check_held(packing) || check_grains(packing) || check_contacts(packing, options))
        return -1;
    network->radius = mean_radius(&packing->grains);
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
    for (size_t c = 0; c < network->count; c++) {
        const struct network_contact *contact = &network->contact[c];
        for (int e = 0; e < NETWORK_WIDTH && contact->dof[e] >= 0; e++)
            out[contact->dof[e]] += contact->n[e] * f[2 * c] + contact->t[e] * f[2 * c + 1];
    }
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
    double sum = 0;
    size_t count = 0;
    for (size_t c = 0; c < network->count; c++)
        if (f[2 * c] > 0)
            sum += f[2 * c], count++;
    return count ? sum / (double)count : 1;
}

double network_judge(const struct network *network, const double *f, double *work)
{
    double largest = 0;
    network_unbalance(network, f, work);
    for (size_t d = 0; d < network->dofs; d++)
        largest = fmax(largest, fabs(work[d]));
    return largest / network_mean_force(network, f);
}
