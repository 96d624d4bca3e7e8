/* Interior point for map. The cones become mu fn - ft = s1 >= 0 and mu fn + ft = s2 >= 0 (fn = s1 where there is no
 * friction) with multipliers q; it ends where s q = weight for every edge, so that the barrier -weight log s is part of
 * the objective. Each step solves one sparse system, the 2 x 2 compliance of a contact being
 * (W + G' diag(q / s) G)^-1. The number of steps hardly depends on the problem. */
#include "forces/methods/map.h"

#include <stdlib.h>
#include <string.h>

#include "pipeline/speak/error.h"

enum { INTERIOR_STEPS = 60, INTERIOR_PATIENCE = 6 /* steps in which the imbalance must halve, unless `feasible` */ };
#define INTERIOR_STALL 1e-3     /* while it is larger than this, in <fn> */
#define INTERIOR_BALANCE 0.1    /* of the tolerance */
#define INTERIOR_DATA 1e-6      /* in <fn>, and in 1 / <fn> for the multipliers */
#define INTERIOR_ROUNDING 1e-15 /* of the largest multiplier: near mechanisms have large ones */
#define INTERIOR_OFF 1e-2       /* how well s q is its weight, as a share of it */
#define INTERIOR_ROUGH_OFF 0.3  /* of a rough solution */
#define BOUNDARY 0.995          /* share of the way to the boundary that a step may go */

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

void map_set_edges(struct map *map, size_t c, double fn, double ft)
{
    double mu = map->network->contact[c].mu;
    edges(mu, fn, ft, map->s[c]);
    from_edges(mu, map->s[c], &map->forces[2 * c]);
}

/* What the present point leaves of each equation. */
static void residuals(struct map *map)
{
    const struct evidence *evidence = map->evidence;
    double *balance = map->left, *data = map->left + map->dofs, sum = 0, count = 0;
    map->data = map->balance = map->off = map->rounding = 0;
    map_errors(map);
    network_unbalance(map->network, map->forces, balance);
    for (size_t d = 0; d < map->dofs; d++) {
        balance[d] += map->soft[d] * map->y[d];
        map->balance = fmax(map->balance, fabs(balance[d]));
        map->rounding = fmax(map->rounding, INTERIOR_ROUNDING * fabs(map->y[d]));
    }
    network_motion(map->network, map->y, map->relative);
    for (size_t c = 0; c < map->count; c++) {
        const double *f = &map->forces[2 * c], *f0 = &evidence->prior[2 * c], *v = &map->variance[2 * c];
        double pull[2];
        data[c] =
            map_measured(map, c) ? f[0] + map_error_at(map, c) + map->slack[c] * map->l[c] - evidence->measured[c] : 0;
        map->data = fmax(map->data, fabs(data[c]));
        edges_transposed(map->network->contact[c].mu, map->q[c], pull);
        map->dual[2 * c] = (f[0] - f0[0]) / v[0] - map->relative[2 * c] - map->l[c] - pull[0];
        map->dual[2 * c + 1] = sides(map, c) < 2 ? 0 : (f[1] - f0[1]) / v[1] - map->relative[2 * c + 1] - pull[1];
        map->data = fmax(map->data, fmax(fabs(map->dual[2 * c]), fabs(map->dual[2 * c + 1])));
        for (int k = 0; k < sides(map, c); k++, count++) {
            double product = map->s[c][k] * map->q[c][k];
            sum += product;
            map->off = fmax(map->off, fabs(product / map->weight[c] - 1));
        }
    }
    map->gap = count > 0 ? sum / count : 0;
}

/* The compliance of each contact in edge coordinates, (G^-T W G^-1 + diag(q / s))^-1, and from it that of (fn, ft). */
static void compliances(struct map *map)
{
    for (size_t c = 0; c < map->count; c++) {
        const double *v = &map->variance[2 * c];
        double mu = map->network->contact[c].mu, *curve = map->curve[c], *d = map->compliance[c];
        double p = map->q[c][0] / map->s[c][0], m = map->q[c][1] / map->s[c][1];
        if (sides(map, c) < 2) {
            curve[0] = d[0] = 1 / (1 / v[0] + p);
            curve[1] = curve[2] = d[1] = d[2] = 0;
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

/* What the targets and the dual residual push, as a change of the forces, goes into the equations that are left. */
static void push(struct map *map)
{
    for (size_t c = 0; c < map->count; c++) {
        const struct network_contact *contact = &map->network->contact[c];
        const double *d = map->compliance[c];
        double a[2] = {0, 0}, pull[2];
        for (int k = 0; k < sides(map, c); k++)
            a[k] = map->target[c][k] / map->s[c][k];
        to_edges_transposed(contact->mu, map->dual[2 * c], map->dual[2 * c + 1], pull);
        a[0] -= pull[0], a[1] -= pull[1];
        map->push_s[c][0] = d[0] * a[0] + d[1] * a[1];
        map->push_s[c][1] = d[1] * a[0] + d[2] * a[1];
        from_edges(contact->mu, map->push_s[c], &map->push[2 * c]);
        for (int e = 0; e < NETWORK_WIDTH && contact->dof[e] >= 0; e++)
            map->left[contact->dof[e]] += contact->n[e] * map->push[2 * c] + contact->t[e] * map->push[2 * c + 1];
        if (map_measured(map, c))
            map->left[map->dofs + c] += map->push[2 * c];
    }
}

/* df, ds, dq from dy, dl. */
static void follow(struct map *map)
{
    const double *dl = map->step + map->dofs;
    network_motion(map->network, map->step, map->relative);
    for (size_t c = 0; c < map->count; c++) {
        const double *d = map->compliance[c];
        double h[2];
        to_edges_transposed(map->network->contact[c].mu, map->relative[2 * c] + dl[c], map->relative[2 * c + 1], h);
        map->ds[c][0] = d[0] * h[0] + d[1] * h[1] + map->push_s[c][0];
        map->ds[c][1] = d[1] * h[0] + d[2] * h[1] + map->push_s[c][1];
        for (int k = 0; k < sides(map, c); k++)
            map->dq[c][k] = (map->target[c][k] - map->q[c][k] * map->ds[c][k]) / map->s[c][k];
    }
}

/* The step towards s q = s q + target, with the last factor; `keep` holds what is left. */
static int solve_step(struct map *map, const double *keep)
{
    memcpy(map->left, keep, (map->dofs + map->count) * sizeof(double));
    push(map);
    if (map_back_solve(map))
        return -1;
    follow(map);
    return 0;
}

/* How far s and q stay positive along the step. */
static double longest(const struct map *map)
{
    double length = 1 / BOUNDARY;
    for (size_t c = 0; c < map->count; c++)
        for (int k = 0; k < sides(map, c); k++) {
            if (map->ds[c][k] < 0)
                length = fmin(length, -map->s[c][k] / map->ds[c][k]);
            if (map->dq[c][k] < 0)
                length = fmin(length, -map->q[c][k] / map->dq[c][k]);
        }
    return fmin(1, BOUNDARY * length);
}

static double mean_weight(const struct map *map)
{
    double sum = 0, count = 0;
    for (size_t c = 0; c < map->count; c++)
        sum += sides(map, c) * map->weight[c], count += sides(map, c);
    return count > 0 ? sum / count : 0;
}

/* Targets of the predictor: far away straight to the boundary, near the end to the weights. */
static void aim(struct map *map, int far)
{
    for (size_t c = 0; c < map->count; c++)
        for (int k = 0; k < sides(map, c); k++)
            map->target[c][k] = (far ? 0 : map->weight[c]) - map->s[c][k] * map->q[c][k];
}

/* How much centring the predictor shows to be needed. */
static double centring(const struct map *map, double weight)
{
    double length = longest(map), after = 0, count = 0;
    for (size_t c = 0; c < map->count; c++)
        for (int k = 0; k < sides(map, c); k++, count++)
            after += (map->s[c][k] + length * map->ds[c][k]) * (map->q[c][k] + length * map->dq[c][k]);
    double share = map->gap > 0 && count > 0 ? fmin(1, fabs(after / count - weight) / map->gap) : 0;
    double centre = pow(share, 3) * map->gap;
    /* the last step was cut short: away from the boundary first */
    return map->length < 0.3 ? fmax(centre, 0.2 * map->gap) : centre;
}

/* Targets of the corrector, with the second-order term of the predictor (share 1) or without (0). */
static void aim_again(struct map *map, double centre, double share)
{
    for (size_t c = 0; c < map->count; c++)
        for (int k = 0; k < sides(map, c); k++)
            map->target[c][k] =
                fmax(centre, map->weight[c]) - map->s[c][k] * map->q[c][k] - share * map->ds[c][k] * map->dq[c][k];
}

static void move(struct map *map)
{
    map->length = longest(map);
    for (size_t d = 0; d < map->dofs + map->count; d++)
        map->y[d] += map->length * map->step[d];
    for (size_t c = 0; c < map->count; c++) {
        for (int k = 0; k < sides(map, c); k++) {
            map->s[c][k] += map->length * map->ds[c][k];
            map->q[c][k] += map->length * map->dq[c][k];
        }
        from_edges(map->network->contact[c].mu, map->s[c], &map->forces[2 * c]);
    }
}

static int advance(struct map *map, double *keep)
{
    double weight = mean_weight(map);
    int far = map->gap > 2 * weight;
    memcpy(keep, map->left, (map->dofs + map->count) * sizeof(double));
    compliances(map);
    aim(map, far);
    if (map_factorise(map) || solve_step(map, keep))
        return -1;
    double centre = centring(map, far ? 0 : weight), reach = longest(map);
    aim_again(map, centre, 1);
    if (solve_step(map, keep))
        return -1;
    if (longest(map) < 0.5 * reach) { /* the second-order term misleads */
        aim_again(map, fmax(centre, 0.2 * map->gap), 0);
        if (solve_step(map, keep))
            return -1;
    }
    move(map);
    return 0;
}

int map_interior(struct map *map, int *iterations)
{
    double *keep = malloc((map->dofs + map->count + 1) * sizeof *keep);
    if (!keep)
        return error_memory("map");
    int status = map->warm ? 1 : map_cold_start(map) ? -1 : 1;
    double history[INTERIOR_PATIENCE];
    for (int k = 0; status == 1; k++, ++*iterations) {
        residuals(map);
        double before = k < INTERIOR_PATIENCE ? INFINITY : history[k % INTERIOR_PATIENCE];
        history[k % INTERIOR_PATIENCE] = map->balance;
        if (map->balance <= INTERIOR_BALANCE * map->options->tolerance * map->rough &&
            map->data <= INTERIOR_DATA * map->rough + map->rounding &&
            map->off <= (map->rough > 1 ? INTERIOR_ROUGH_OFF : INTERIOR_OFF))
            status = 0;
        else if (k >= INTERIOR_STEPS || !isfinite(map->gap) ||
                 (!map->feasible && map->balance > INTERIOR_STALL && map->balance > 0.5 * before))
            break;
        else if (advance(map, keep))
            status = -1;
    }
    map->warm = status == 0;
    free(keep);
    return status;
}
