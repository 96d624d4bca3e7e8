/* Interior point for map. The cones become mu fn - ft = s1 >= 0 and mu fn + ft = s2 >= 0 (fn = s1 where there is no
 * friction) with multipliers q; each step solves the same sparse system as semismooth Newton, the 2 x 2 compliance of a
 * contact being (W + G' diag(q / s) G)^-1. The number of steps hardly depends on the problem. */
#include "forces/map.h"

#include <stdlib.h>
#include <string.h>

#include "pipeline/error.h"

enum { INTERIOR_STEPS = 120, INTERIOR_PATIENCE = 12 /* steps in which the imbalance must halve */ };
#define INTERIOR_BALANCE 1e-9 /* in <fn> */
#define INTERIOR_GAP 1e-8     /* mean of s q */
#define INTERIOR_FIRST_GAP 10 /* the same at the start: about that of overlaps wrong by a few <fn> */
#define INTERIOR_SHIFT 1e-10  /* times the gap, on the diagonal only (proximal): pivots of mechanisms */
#define BOUNDARY 0.995        /* share of the way to the boundary that a step may go */

struct interior {
    struct map *map;
    double softness;
    double (*s)[2], (*q)[2];   /* slacks and multipliers */
    double (*ds)[2], (*dq)[2]; /* their steps */
    double (*target)[2];       /* what s q should become, less s q */
    double (*compliance)[3];   /* in edge coordinates: ds = compliance (what y, l and targets push) */
    double (*push_s)[2];       /* what the targets push, in edge coordinates */
    double *f, *dual, *push;   /* forces, W (f - f0) - A' y - l - G' q, and push_s as a force */
    double balance, data, dual_left, gap, length;
};

static int used(const struct map *map, size_t c)
{
    return !map->evidence->open[c];
}

static int sides(const struct map *map, size_t c)
{
    return map->network->contact[c].mu > 0 ? 2 : 1;
}

/* Between (fn, ft) and the edge coordinates s = G f: s1 = mu fn - ft, s2 = mu fn + ft. Steps are computed in s, where
 * nothing cancels when a contact comes close to an edge. */
static void from_edges(double mu, const double s[2], double f[2])
{
    f[0] = mu > 0 ? (s[0] + s[1]) / (2 * mu) : s[0];
    f[1] = mu > 0 ? (s[1] - s[0]) / 2 : 0;
}

static void edges(double mu, double fn, double ft, double out[2])
{
    out[0] = mu > 0 ? mu * fn - ft : fn;
    out[1] = mu > 0 ? mu * fn + ft : 1;
}

/* G' a, and the inverse of G' times v. */
static void edges_transposed(double mu, const double a[2], double out[2])
{
    out[0] = mu > 0 ? mu * (a[0] + a[1]) : a[0];
    out[1] = mu > 0 ? a[1] - a[0] : 0;
}

static void to_edges_transposed(double mu, double vn, double vt, double out[2])
{
    out[0] = mu > 0 ? vn / (2 * mu) - vt / 2 : vn;
    out[1] = mu > 0 ? vn / (2 * mu) + vt / 2 : 0;
}

static void interior_free(struct interior *in)
{
    free(in->s), free(in->q), free(in->ds), free(in->dq), free(in->target);
    free(in->compliance), free(in->push_s), free(in->f), free(in->dual), free(in->push);
}

static int interior_begin(struct map *map, struct interior *in)
{
    size_t n = map->count + 1;
    in->s = calloc(n, sizeof *in->s), in->q = calloc(n, sizeof *in->q);
    in->ds = calloc(n, sizeof *in->ds), in->dq = calloc(n, sizeof *in->dq);
    in->target = calloc(n, sizeof *in->target);
    in->compliance = calloc(n, sizeof *in->compliance), in->push_s = calloc(n, sizeof *in->push_s);
    in->f = calloc(2 * n, sizeof(double));
    in->dual = calloc(2 * n, sizeof(double)), in->push = calloc(2 * n, sizeof(double));
    if (!in->s || !in->q || !in->ds || !in->dq || !in->target || !in->compliance || !in->push_s || !in->f ||
        !in->dual || !in->push)
        return error_memory("interior point");
    memset(map->point, 0, (map->dofs + map->count) * sizeof(double));
    for (size_t c = 0; c < map->count; c++) { /* the mean force, no friction, multipliers that balance the belief */
        in->f[2 * c] = used(map, c) ? 1 : 0;
        edges(map->network->contact[c].mu, 1, 0, in->s[c]);
        for (int k = 0; k < 2; k++)
            in->q[c][k] = INTERIOR_FIRST_GAP / in->s[c][k];
    }
    return 0;
}

/* What the present point leaves of each equation. */
static void residuals(struct interior *in)
{
    struct map *map = in->map;
    const struct evidence *evidence = map->evidence;
    const double *y = map->point, *l = map->point + map->dofs;
    double sum = 0, count = 0;
    in->data = in->dual_left = in->balance = 0;
    map_errors(map, l);
    network_unbalance(map->network, in->f, map->slope);
    for (size_t d = 0; d < map->dofs; d++) {
        map->slope[d] += in->softness * y[d];
        in->balance = fmax(in->balance, fabs(map->slope[d]));
    }
    network_motion(map->network, y, map->relative);
    for (size_t c = 0; c < map->count; c++) {
        double pull[2];
        map->slope[map->dofs + c] = 0;
        if (!used(map, c))
            continue;
        if (map_measured(map, c))
            map->slope[map->dofs + c] =
                in->f[2 * c] + map_error_at(map, c) + map->slack[c] * l[c] - evidence->measured[c];
        in->data = fmax(in->data, fabs(map->slope[map->dofs + c]));
        edges_transposed(map->network->contact[c].mu, in->q[c], pull);
        in->dual[2 * c] =
            (in->f[2 * c] - evidence->prior[2 * c]) / evidence->variance[2 * c] - map->relative[2 * c] - l[c] - pull[0];
        in->dual[2 * c + 1] = sides(map, c) < 2
                                  ? 0
                                  : (in->f[2 * c + 1] - evidence->prior[2 * c + 1]) / evidence->variance[2 * c + 1] -
                                        map->relative[2 * c + 1] - pull[1];
        in->dual_left = fmax(in->dual_left, fmax(fabs(in->dual[2 * c]), fabs(in->dual[2 * c + 1])));
        for (int k = 0; k < sides(map, c); k++)
            sum += in->s[c][k] * in->q[c][k], count++;
    }
    in->gap = count > 0 ? sum / count : 0;
}

/* The compliance of each contact in edge coordinates, (G^-T W G^-1 + diag(q / s))^-1, and from it that of (fn, ft). */
static void compliances(struct interior *in)
{
    struct map *map = in->map;
    for (size_t c = 0; c < map->count; c++) {
        const double *v = &map->evidence->variance[2 * c];
        double mu = map->network->contact[c].mu, *curve = map->curve[c], *d = in->compliance[c];
        curve[0] = curve[1] = curve[2] = d[0] = d[1] = d[2] = 0;
        if (!used(map, c))
            continue;
        double p = in->q[c][0] / in->s[c][0], m = in->q[c][1] / in->s[c][1];
        if (sides(map, c) < 2) {
            curve[0] = d[0] = 1 / (1 / v[0] + p);
            continue;
        }
        double wn = 1 / (4 * mu * mu * v[0]), wt = 1 / (4 * v[1]), w = wn + wt;
        double determinant = 4 * wn * wt + w * (p + m) + p * m;
        d[0] = (w + m) / determinant, d[1] = (wt - wn) / determinant, d[2] = (w + p) / determinant;
        curve[0] = (d[0] + 2 * d[1] + d[2]) / (4 * mu * mu);
        curve[1] = (d[2] - d[0]) / (4 * mu);
        curve[2] = (d[0] - 2 * d[1] + d[2]) / 4;
    }
}

/* The step towards s q = s q + target. */
static int solve_step(struct interior *in, int factorise)
{
    struct map *map = in->map;
    double *rhs = map->trial; /* what remains, kept for the second solve */
    memcpy(rhs, map->slope, (map->dofs + map->count) * sizeof(double));
    for (size_t c = 0; c < map->count; c++) {
        if (!used(map, c)) {
            in->push[2 * c] = in->push[2 * c + 1] = 0;
            continue;
        }
        double a[2] = {0, 0}, pull[2];
        for (int k = 0; k < sides(map, c); k++)
            a[k] = in->target[c][k] / in->s[c][k];
        double mu = map->network->contact[c].mu, *d = in->compliance[c];
        to_edges_transposed(mu, in->dual[2 * c], in->dual[2 * c + 1], pull);
        a[0] -= pull[0], a[1] -= pull[1];
        in->push_s[c][0] = d[0] * a[0] + d[1] * a[1];
        in->push_s[c][1] = d[1] * a[0] + d[2] * a[1];
        from_edges(mu, in->push_s[c], &in->push[2 * c]);
        const struct network_contact *contact = &map->network->contact[c];
        for (int e = 0; e < NETWORK_WIDTH && contact->dof[e] >= 0; e++)
            map->slope[contact->dof[e]] += contact->n[e] * in->push[2 * c] + contact->t[e] * in->push[2 * c + 1];
        if (map_measured(map, c))
            map->slope[map->dofs + c] += in->push[2 * c];
    }
    int status = factorise ? map_factorise(map, fmax(in->softness, INTERIOR_SHIFT * fmax(1e-6, fmin(1, in->gap)))) : 0;
    status = status || map_back_solve(map);
    memcpy(map->slope, rhs, (map->dofs + map->count) * sizeof(double));
    return status ? -1 : 0;
}

/* df, ds, dq from dy, dl. */
static void follow(struct interior *in)
{
    struct map *map = in->map;
    const double *dl = map->step + map->dofs;
    network_motion(map->network, map->step, map->relative);
    for (size_t c = 0; c < map->count; c++) {
        if (!used(map, c))
            continue;
        const double *d = in->compliance[c];
        double h[2];
        to_edges_transposed(map->network->contact[c].mu, map->relative[2 * c] + dl[c], map->relative[2 * c + 1], h);
        in->ds[c][0] = d[0] * h[0] + d[1] * h[1] + in->push_s[c][0];
        in->ds[c][1] = d[1] * h[0] + d[2] * h[1] + in->push_s[c][1];
        for (int k = 0; k < sides(map, c); k++)
            in->dq[c][k] = (in->target[c][k] - in->q[c][k] * in->ds[c][k]) / in->s[c][k];
    }
}

/* How far s and q stay positive along the step. */
static double longest(const struct interior *in)
{
    double length = 1 / BOUNDARY;
    for (size_t c = 0; c < in->map->count; c++)
        for (int k = 0; k < sides(in->map, c) && used(in->map, c); k++) {
            if (in->ds[c][k] < 0)
                length = fmin(length, -in->s[c][k] / in->ds[c][k]);
            if (in->dq[c][k] < 0)
                length = fmin(length, -in->q[c][k] / in->dq[c][k]);
        }
    return fmin(1, BOUNDARY * length);
}

/* Mehrotra: the affine step tells how much centring and which second-order correction the real one needs. */
static int step(struct interior *in)
{
    struct map *map = in->map;
    double after = 0, count = 0;
    compliances(in);
    for (size_t c = 0; c < map->count; c++)
        for (int k = 0; k < 2; k++)
            in->target[c][k] = -in->s[c][k] * in->q[c][k];
    if (solve_step(in, 1))
        return -1;
    follow(in);
    double length = longest(in);
    for (size_t c = 0; c < map->count; c++)
        for (int k = 0; k < sides(map, c) && used(map, c); k++) {
            after += (in->s[c][k] + length * in->ds[c][k]) * (in->q[c][k] + length * in->dq[c][k]);
            count++;
        }
    double centre = in->gap > 0 && count > 0 ? pow(fmin(1, after / count / in->gap), 3) * in->gap : 0;
    if (in->length < 0.3) /* the last step was cut short: away from the boundary first */
        centre = fmax(centre, 0.2 * in->gap);
    for (size_t c = 0; c < map->count; c++)
        for (int k = 0; k < sides(map, c) && used(map, c); k++)
            in->target[c][k] = centre - in->s[c][k] * in->q[c][k] - in->ds[c][k] * in->dq[c][k];
    if (solve_step(in, 0))
        return -1;
    follow(in);
    in->length = length = longest(in);
    for (size_t d = 0; d < map->dofs + map->count; d++)
        map->point[d] += length * map->step[d];
    for (size_t c = 0; c < map->count; c++) {
        if (!used(map, c))
            continue;
        for (int k = 0; k < sides(map, c); k++)
            in->s[c][k] += length * in->ds[c][k];
        from_edges(map->network->contact[c].mu, in->s[c], &in->f[2 * c]);
        for (int k = 0; k < sides(map, c); k++)
            in->q[c][k] += length * in->dq[c][k];
    }
    return 0;
}

int map_interior(struct map *map, double softness, int *iterations)
{
    struct interior in = {.map = map, .softness = softness, .length = 1};
    double history[INTERIOR_PATIENCE] = {0};
    int status = interior_begin(map, &in) ? -1 : 1;
    for (int k = 0; status == 1; k++, ++*iterations) {
        residuals(&in);
        double before = history[k % INTERIOR_PATIENCE];
        history[k % INTERIOR_PATIENCE] = in.balance;
        if (in.balance <= INTERIOR_BALANCE && in.data <= 1e-6 && in.gap <= INTERIOR_GAP)
            status = 0;
        else if (k >= INTERIOR_STEPS || !isfinite(in.gap) ||
                 (k >= INTERIOR_PATIENCE && in.balance > 1e-7 && in.balance > 0.5 * before))
            break;
        else if (step(&in))
            status = -1;
    }
    memcpy(map->forces, in.f, 2 * map->count * sizeof(double));
    interior_free(&in);
    return status;
}
