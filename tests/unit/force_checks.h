/* What the tests of hard cases share: a virtual packing whose forces are known, results held to what they say about
 * themselves, and the balance of every grain added up again, from the file's columns alone. */
#ifndef TESTS_FORCE_CHECKS_H
#define TESTS_FORCE_CHECKS_H

#include <stdlib.h>

#include "tests/unit/discs.h"

#include "forces/infer_forces.h"
#include "simulation/dem/simulate.h"

#define KN 1.09e7

static inline void copy_packing(const struct packing *from, struct packing *to)
{
    memset(to, 0, sizeof *to);
    to->length_m = from->length_m;
    check_done(table_copy(&GRAINS, &to->grains, &from->grains));
    check_done(table_copy(&WALLS, &to->walls, &from->walls));
    check_done(table_copy(&CONTACTS, &to->contacts, &from->contacts));
    to->forces = calloc(from->force_count + 1, sizeof *to->forces);
    to->force_count = from->force_count;
    for (size_t k = 0; k < from->force_count; k++) {
        to->forces[k] = from->forces[k];
        memset(&to->forces[k].contact, 0, sizeof to->forces[k].contact);
        memset(&to->forces[k].residual, 0, sizeof to->forces[k].residual);
        check_done(table_copy(&CONTACT_FORCES, &to->forces[k].contact, &from->forces[k].contact));
        check_done(table_copy(&RESIDUALS, &to->forces[k].residual, &from->forces[k].residual));
    }
}

static inline struct force_options usual(void)
{
    struct force_options options = FORCE_OPTIONS_DEFAULT;
    options.law.kn = KN;
    options.law.mu = 0.5;
    return options;
}

/* Largest unbalanced component (moments over the mean radius) on a grain or a free wall, over the mean pushing force.
 */
static inline double add_up(const struct packing *packing, const struct forces *forces)
{
    const struct contacts *c = &packing->contacts;
    const struct grains *g = &packing->grains;
    double *sum = calloc(3 * (g->count + packing->walls.count), sizeof *sum), largest = 0, mean = 0, pushing = 0;
    double radius = 0;
    for (size_t k = 0; k < g->count; k++)
        radius += g->radius[k] / (double)g->count;
    for (size_t k = 0; k < c->count; k++) {
        double fn = forces->contact.fn[k], ft = forces->contact.ft[k];
        double fx = fn * c->nx[k] - ft * c->ny[k], fy = fn * c->ny[k] + ft * c->nx[k];
        size_t i = (size_t)c->i[k], j = (size_t)c->j[k];
        assert_true(isfinite(fn) && isfinite(ft) && fn >= 0);
        if (fn > 0)
            mean += fn, pushing++;
        sum[3 * i] -= fx, sum[3 * i + 1] -= fy;
        sum[3 * i + 2] -= (c->x[k] - g->x[i]) * fy - (c->y[k] - g->y[i]) * fx;
        sum[3 * j] += fx, sum[3 * j + 1] += fy;
        if (j < g->count)
            sum[3 * j + 2] += (c->x[k] - g->x[j]) * fy - (c->y[k] - g->y[j]) * fx;
    }
    mean = pushing > 0 ? mean / pushing : 1;
    for (size_t k = 0; k < g->count; k++) {
        if (g->flags[k] & GRAIN_FIXED)
            continue;
        sum[3 * k] += g->load_x ? g->load_x[k] : 0;
        sum[3 * k + 1] += g->load_y ? g->load_y[k] : 0;
        sum[3 * k + 2] += g->load_m ? g->load_m[k] : 0;
        check_near(sum[3 * k], forces->residual.residual_x[k], 1e-9 * mean);
        check_near(sum[3 * k + 1], forces->residual.residual_y[k], 1e-9 * mean);
        check_near(sum[3 * k + 2], forces->residual.residual_m[k], 1e-9 * mean * g->radius[k]);
        largest = fmax(largest, fmax(fabs(sum[3 * k]), fabs(sum[3 * k + 1])));
        largest = fmax(largest, fabs(sum[3 * k + 2]) / radius);
    }
    for (size_t w = 0; w < packing->walls.count; w++) {
        const double *wall = &sum[3 * (g->count + w)];
        const char *name = packing->walls.name[w];
        double fx = packing->walls.fx[w], fy = packing->walls.fy[w];
        struct vec in = wall_inward(&packing->walls, w); /* a load at right angles to the normal may be missing */
        double load =
            (isnan(fx) && fabs(in.x) < 1e-6 ? 0 : fx * in.x) + (isnan(fy) && fabs(in.y) < 1e-6 ? 0 : fy * in.y);
        if (isfinite(load) && strncmp(name, "left", 5) && strncmp(name, "bottom", 7))
            largest = fmax(largest, fabs(wall[0] * in.x + wall[1] * in.y + load));
    }
    free(sum);
    return largest / mean;
}

static inline double pearson(size_t count, const double *a, const double *b)
{
    double ma = 0, mb = 0, ab = 0, aa = 0, bb = 0;
    for (size_t k = 0; k < count; k++)
        ma += a[k] / (double)count, mb += b[k] / (double)count;
    for (size_t k = 0; k < count; k++)
        ab += (a[k] - ma) * (b[k] - mb), aa += (a[k] - ma) * (a[k] - ma), bb += (b[k] - mb) * (b[k] - mb);
    return ab / sqrt(aa * bb);
}

static inline double r_fn(const struct packing *packing, const struct forces *forces)
{
    return pearson(forces->contact.count, forces->contact.fn, packing->forces[0].contact.fn);
}

static inline double r_ft(const struct packing *packing, const struct forces *forces)
{
    return pearson(forces->contact.count, forces->contact.ft, packing->forces[0].contact.ft);
}

/* Infer, and hold the result to what it says about itself: admissible, finite, and exactly as far out
 * of balance as it says. */
static inline void infer_and_check(const struct packing *packing, const struct force_options *options,
                                   enum force_method method, struct forces *forces)
{
    check_done(infer_forces(packing, options, method, forces));
    for (size_t c = 0; c < forces->contact.count; c++) {
        double mu = packing->contacts.j[c] < (int64_t)packing->grains.count ? options->law.mu : options->law.mu_wall;
        check_at_most(fabs(forces->contact.ft[c]), mu * forces->contact.fn[c] * (1 + 1e-12));
    }
    assert_true(isfinite(forces->imbalance));
    check_at_most(forces->violation, 1e-12);
    check_at_most(forces->imbalance_mean, 1.5 * forces->imbalance); /* hypot of two components each */
    double balance = add_up(packing, forces);
    check_near(balance, forces->imbalance, 1e-6 * forces->imbalance + 1e-12);
    assert_int_equal(forces->converged, forces->imbalance <= options->tolerance);
}

#endif
