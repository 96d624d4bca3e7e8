/* Primal-dual interior point for map (Mehrotra 1992: a predictor towards the boundary tells how much centring the
 * corrector needs). The cones are sides with multipliers (cone.h); it ends where side times press is the weight on
 * every side, so that the barrier -weight log side is part of the objective. Eliminating f, side and press contact by
 * contact leaves a 2 x 2 compliance
 *
 *     D = (W + G' diag(press / side) G)^-1,   W = 1 / variance,
 *
 * and one sparse system in (y, l) per step (map_system.c). Steps are computed in side coordinates, where nothing
 * cancels when a contact comes close to an edge. The number of steps hardly depends on the problem. */
#include "forces/methods/map.h"

#include <stdlib.h>
#include <string.h>

#include "forces/algebra/cone.h"
#include "pipeline/speak/error.h"

enum { INTERIOR_STEPS = 60, INTERIOR_PATIENCE = 6 /* steps in which the imbalance must halve, unless `feasible` */ };
#define INTERIOR_STALL 1e-3     /* while it is larger than this, in <fn> */
#define INTERIOR_BALANCE 0.1    /* of the tolerance */
#define INTERIOR_DATA 1e-6      /* in <fn>, and in 1 / <fn> for the multipliers */
#define INTERIOR_ROUNDING 1e-15 /* of the largest multiplier: near mechanisms have large ones */
#define INTERIOR_OFF 1e-2       /* how well side press is its weight, as a share of it */
#define INTERIOR_ROUGH_OFF 0.3  /* of a rough solution */
#define FAR 2                   /* mean weights: gaps that are larger are aimed straight at the boundary */
#define BOUNDARY 0.995          /* share of the way to the boundary that a step may go */

static double friction(const struct map *map, size_t c)
{
    return map->network->contact[c].mu;
}

static int sides(const struct map *map, size_t c)
{
    return cone_sides(friction(map, c));
}

void map_set_force(struct map *map, size_t c, double fn)
{
    const double f[2] = {fn, 0};
    cone_side(friction(map, c), f, map->side[c]);
    cone_force(friction(map, c), map->side[c], &map->forces[2 * c]);
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
        cone_transposed(friction(map, c), map->press[c], pull);
        map->dual[2 * c] = (f[0] - f0[0]) / v[0] - map->relative[2 * c] - map->l[c] - pull[0];
        map->dual[2 * c + 1] = sides(map, c) < 2 ? 0 : (f[1] - f0[1]) / v[1] - map->relative[2 * c + 1] - pull[1];
        map->data = fmax(map->data, fmax(fabs(map->dual[2 * c]), fabs(map->dual[2 * c + 1])));
        for (int k = 0; k < sides(map, c); k++, count++) {
            double product = map->side[c][k] * map->press[c][k];
            sum += product;
            map->off = fmax(map->off, fabs(product / map->weight[c] - 1));
        }
    }
    map->gap = count > 0 ? sum / count : 0;
}

/* The compliance of each contact in side coordinates, (G^-T W G^-1 + diag(q / s))^-1, and from it that of (fn, ft). */
static void compliances(struct map *map)
{
    for (size_t c = 0; c < map->count; c++) {
        const double *v = &map->variance[2 * c];
        double mu = friction(map, c), *curve = map->curve[c], *d = map->compliance[c];
        double p = map->press[c][0] / map->side[c][0], m = map->press[c][1] / map->side[c][1];
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
            a[k] = map->target[c][k] / map->side[c][k];
        cone_transposed_inverse(contact->mu, map->dual[2 * c], map->dual[2 * c + 1], pull);
        a[0] -= pull[0], a[1] -= pull[1];
        map->push_side[c][0] = d[0] * a[0] + d[1] * a[1];
        map->push_side[c][1] = d[1] * a[0] + d[2] * a[1];
        cone_force(contact->mu, map->push_side[c], &map->push[2 * c]);
        contact_push(contact, map->push[2 * c], map->push[2 * c + 1], map->left);
        if (map_measured(map, c))
            map->left[map->dofs + c] += map->push[2 * c];
    }
}

/* dside, dpress from dy, dl. */
static void follow(struct map *map)
{
    const double *dl = map->step + map->dofs;
    network_motion(map->network, map->step, map->relative);
    for (size_t c = 0; c < map->count; c++) {
        const double *d = map->compliance[c];
        double h[2];
        cone_transposed_inverse(friction(map, c), map->relative[2 * c] + dl[c], map->relative[2 * c + 1], h);
        map->dside[c][0] = d[0] * h[0] + d[1] * h[1] + map->push_side[c][0];
        map->dside[c][1] = d[1] * h[0] + d[2] * h[1] + map->push_side[c][1];
        for (int k = 0; k < sides(map, c); k++)
            map->dpress[c][k] = (map->target[c][k] - map->press[c][k] * map->dside[c][k]) / map->side[c][k];
    }
}

/* The step towards side press = side press + target, with the last factor; `keep` holds what is left. */
static int solve_step(struct map *map, const double *keep)
{
    memcpy(map->left, keep, (map->dofs + map->count) * sizeof(double));
    push(map);
    if (map_back_solve(map))
        return -1;
    follow(map);
    return 0;
}

/* How far side and press stay positive along the step. */
static double longest(const struct map *map)
{
    double length = 1 / BOUNDARY;
    for (size_t c = 0; c < map->count; c++)
        length = cone_reach(friction(map, c), map->side[c], map->dside[c], map->press[c], map->dpress[c], length);
    return fmin(1, BOUNDARY * length);
}

/* What side times press shall be in the end, in the mean. */
static double mean_weight(const struct map *map)
{
    double sum = 0, count = 0;
    for (size_t c = 0; c < map->count; c++)
        sum += sides(map, c) * map->weight[c], count += sides(map, c);
    return count > 0 ? sum / count : 0;
}

/* Targets: side times press shall be `centre` and no less than the weights (near the end) or 0 (far away: straight to
 * the boundary). The second-order term of the last step, the predictor's, is taken into account by its share, 0 or 1.
 */
static void aim(struct map *map, int far, double centre, double share)
{
    for (size_t c = 0; c < map->count; c++)
        for (int k = 0; k < sides(map, c); k++)
            map->target[c][k] = fmax(centre, far ? 0 : map->weight[c]) - map->side[c][k] * map->press[c][k] -
                                share * map->dside[c][k] * map->dpress[c][k];
}

/* How much centring the predictor shows to be needed. */
static double centring(const struct map *map, double weight)
{
    double length = longest(map), after = 0, count = 0;
    for (size_t c = 0; c < map->count; c++)
        for (int k = 0; k < sides(map, c); k++, count++)
            after += (map->side[c][k] + length * map->dside[c][k]) * (map->press[c][k] + length * map->dpress[c][k]);
    double share = map->gap > 0 && count > 0 ? fmin(1, fabs(after / count - weight) / map->gap) : 0;
    double centre = pow(share, 3) * map->gap;
    /* the last step was cut short: away from the boundary first */
    return map->length < 0.3 ? fmax(centre, 0.2 * map->gap) : centre;
}

/* (y, l) and (side, press) go the same length; the forces follow from the sides. */
static void move(struct map *map)
{
    map->length = longest(map);
    for (size_t d = 0; d < map->dofs + map->count; d++)
        map->y[d] += map->length * map->step[d];
    for (size_t c = 0; c < map->count; c++) {
        for (int k = 0; k < sides(map, c); k++) {
            map->side[c][k] += map->length * map->dside[c][k];
            map->press[c][k] += map->length * map->dpress[c][k];
        }
        cone_force(friction(map, c), map->side[c], &map->forces[2 * c]);
    }
}

/* One step: predictor, centring, corrector; where the corrector's second-order term cuts the step to less than half of
 * the predictor's, once more without it. One factorisation, two or three solves. */
static int advance(struct map *map, double *keep)
{
    double weight = mean_weight(map);
    int far = map->gap > FAR * weight;
    memcpy(keep, map->left, (map->dofs + map->count) * sizeof(double));
    compliances(map);
    aim(map, far, 0, 0);
    if (map_factorise(map) || solve_step(map, keep))
        return -1;
    double centre = centring(map, far ? 0 : weight), reach = longest(map);
    aim(map, 0, centre, 1);
    if (solve_step(map, keep))
        return -1;
    if (longest(map) < 0.5 * reach) { /* the second-order term misleads */
        aim(map, 0, fmax(centre, 0.2 * map->gap), 0);
        if (solve_step(map, keep))
            return -1;
    }
    move(map);
    return 0;
}

/* Ends when equilibrium, data and products are all good enough, each by its own measure. A problem that may have no
 * solution is given up when its imbalance has not halved within INTERIOR_PATIENCE steps. */
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
