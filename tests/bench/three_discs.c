#include "tests/bench/three_discs.h"

#include <stdlib.h>
#include <string.h>

#include "forces/infer_forces.h"
#include "forces/methods/cdm.h"
#include "pipeline/numbers/random.h"

static const double HALF = 0.70710678118654752440; /* sin 45 = cos 45 */

double three_fy(double p, double fn, double ft)
{
    return 2 * HALF * (fn + ft) - p;
}

double three_mobilised(double mu, double fn, double ft)
{
    return mu > 0 && fn > 0 ? ft / (mu * fn) : 0;
}

void three_start(double spread, double mu, size_t k, double *fn, double *ft)
{
    double most = spread * THREE_P * HALF;
    *fn = most * random_uniform(2059, 2 * k);
    *ft = mu * most * (2 * random_uniform(2059, 2 * k + 1) - 1);
}

static int finished(struct three_path *path, double p, double fn, double ft)
{
    int k = path->count;
    path->fn[k] = fn, path->ft[k] = ft, path->fy[k] = three_fy(p, fn, ft);
    if (fabs(path->fy[k]) < 1e-15 * p || k == THREE_LIMIT)
        return 1;
    /* Rounding: a few units in the last place of P are the end of what doubles can tell. */
    if (k > 2 && fabs(path->fy[k]) < 1e-12 * p && fabs(path->fy[k]) >= fabs(path->fy[k - 1]))
        return 1;
    path->count++;
    return 0;
}

/* Both contacts are corrected at once; with m = I / (R^2 / 2) = 1 the inverse masses are 1 and 3 (thesis 2.57). */
void three_dynamics(double mu, double fn, double ft, struct three_path *path)
{
    const double w[3] = {1, 0, 3};
    path->count = 0;
    while (!finished(path, THREE_P, fn, ft)) {
        double along = HALF * three_fy(THREE_P, fn, ft);
        cdm_contact(w, mu, along, along, 1, &fn, &ft);
    }
}

static void onto_statics(double p, double *fn, double *ft)
{
    double missing = 0.5 * (p / (2 * HALF) - *fn - *ft); /* kn = kt: the nearest point of the line (2.54) */
    *fn += missing;
    *ft += missing;
}

/* The judged point of an iteration is plastically admissible, as in the program. */
void three_projections(double p, double mu, double fn, double ft, int plastic_first, struct three_path *path)
{
    path->count = 0;
    if (plastic_first)
        coulomb_clip(mu, &fn, &ft);
    while (!finished(path, p, fn, ft)) {
        onto_statics(p, &fn, &ft);
        coulomb_clip(mu, &fn, &ft);
    }
}

/* ---- the same by the program ---- */

static int build(struct packing *packing)
{
    static const char *const columns[] = {"x",      "y",      "radius", "mass",  "inertia",
                                          "load_x", "load_y", "load_m", "flags", NULL};
    static const char *const touching[] = {"i", "j", "nx", "ny", "x", "y", "overlap", "flags", NULL};
    const double x[] = {-2 * THREE_R * HALF, 2 * THREE_R * HALF, 0}, y[] = {0, 0, 2 * THREE_R * HALF};
    memset(packing, 0, sizeof *packing);
    if (table_alloc(&GRAINS, &packing->grains, 3, columns) || table_alloc(&CONTACTS, &packing->contacts, 2, touching))
        return -1;
    struct grains *g = &packing->grains;
    struct contacts *c = &packing->contacts;
    for (int k = 0; k < 3; k++) {
        g->x[k] = x[k], g->y[k] = y[k], g->radius[k] = THREE_R;
        g->mass[k] = THREE_P / 9.81, g->inertia[k] = 0.5 * g->mass[k] * THREE_R * THREE_R;
        g->flags[k] = k < 2 ? GRAIN_FIXED : 0;
    }
    for (int k = 0; k < 3; k++)
        g->load_x[k] = g->load_y[k] = g->load_m[k] = 0;
    g->load_y[2] = -THREE_P;
    for (int k = 0; k < 2; k++) {
        c->i[k] = k, c->j[k] = 2;
        c->nx[k] = k ? -HALF : HALF, c->ny[k] = HALF;
        c->x[k] = 0.5 * (x[k] + x[2]), c->y[k] = 0.5 * (y[k] + y[2]);
    }
    return 0;
}

int three_by_program(enum force_method method, double mu, double fn, double ft, double *fn_end, double *ft_end)
{
    struct packing packing;
    struct network network;
    struct network_options network_options = {.wall_mass = 100};
    struct force_options options = FORCE_OPTIONS_DEFAULT;
    struct outcome outcome;
    options.law.kn = THREE_KN, options.law.mu = mu;
    options.tolerance = 1e-13;
    options.anderson = 0;
    if (build(&packing) || network_build(&packing, &options.law, &network_options, &network)) {
        packing_free(&packing);
        return -1;
    }
    double f[4] = {fn / network.force, ft / network.force, fn / network.force, -ft / network.force};
    int status = method_row(method)->solve(&(struct problem){&packing, &network, &options}, f, &outcome);
    *fn_end = f[0] * network.force;
    *ft_end = f[1] * network.force;
    network_free(&network);
    packing_free(&packing);
    return status;
}

/* ---- molecular dynamics ---- */

/* One degree of freedom: the height of disc 3. Springs kn = kt, time step sqrt(m / kn) / 100, at rest when the
 * resultant stays below 1e-9 P for 200 steps. */
struct three_rest three_molecular(double damping, double noise, struct chart_line *line)
{
    const double m = THREE_P / 9.81, dt = sqrt(m / THREE_KN) / 100, c = damping * sqrt(m * THREE_KN), mu = 0.5;
    struct three_rest rest = {0};
    double speed = -noise * dt / m, elastic = 0, ft = 0; /* speed downwards; an upward impulse: negative */
    int quiet = 0;
    for (long step = 0; step < 2000000 && quiet < 200; step++) {
        double approach = HALF * speed * dt;
        rest.down += speed * dt;
        elastic = THREE_KN * HALF * rest.down;
        double fn = elastic + c * HALF * speed;
        if (elastic <= 0)
            fn = 0;
        ft += THREE_KN * approach;
        coulomb_clip(mu, &fn, &ft);
        double force = -three_fy(THREE_P, fn, ft); /* downwards */
        speed += force / m * dt;
        quiet = fabs(force) < 1e-9 * THREE_P ? quiet + 1 : 0;
        rest.fn = fn, rest.ft = ft;
        if (line && step % 4 == 0 && step < 6000)
            chart_put(line, fn, ft);
    }
    rest.rests = quiet >= 200;
    return rest;
}
