/* The most likely admissible forces (docs/forces.md): minimise
 *
 *     1/2 |f - f0|^2_W + 1/2 |e|^2 + 1/2 |r|^2 / slack     with  A f + b = 0,  fn + B e + r = m,  f in the cones,
 *
 * a convex quadratic programme, as the cones are wedges in 2D. With the multipliers y (equilibrium) and l (overlaps)
 * its dual is unconstrained:
 *
 *     minimise phi(y, l) = 1/2 |P(z)|^2_W + b . y - m . l + 1/2 |B' l|^2 + 1/2 slack l^2,  z = f0 + V (A' y + (l, 0)),
 *
 * V = 1 / W, P the projection onto the wedge in the norm of W, in closed form. phi is once differentiable and piecewise
 * quadratic: semismooth Newton (Qi and Sun 1993) with a proximal shift and a line search on the slope converges from
 * anywhere in a few tens of steps. l is eliminated contact by contact, which leaves a quasi-definite system in (y, e)
 * with the pattern of the network. */
#include "forces/map.h"

#include <stdlib.h>
#include <string.h>

#include "forces/sparse.h"
#include "pipeline/error.h"

#define MAP_FIRST_SHIFT 1e-5 /* of the largest diagonal entry */
#define MAP_LEAST_SHIFT 1e-11
#define MAP_SLOPE 0.5     /* of the first slope: what the line search leaves */
#define SOFT_BALANCE 0.01 /* <fn> */
#define MAP_OPEN 1e-4     /* <fn>: carries nothing */
#define MAP_OPTIMAL 1e-5  /* how well the overlap equations are solved, in <fn> */
enum { MAP_STEPS = 30, MAP_LOOKS = 30, MAP_LONGEST = 1024, MAP_ROUNDS = 6 };

static void map_free(struct map *map)
{
    sparse_free(map->matrix);
    free(map->point), free(map->step), free(map->trial), free(map->slope), free(map->trial_slope);
    free(map->relative), free(map->forces), free(map->error), free(map->curve), free(map->slack);
    free(map->diagonal), free(map->right), free(map->solution);
}

static struct sparse *network_matrix(const struct map *map)
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

static int map_begin(const struct network *network, const struct force_options *options, struct evidence *evidence,
                     struct map *map)
{
    *map = (struct map){.network = network,
                        .options = options,
                        .evidence = evidence,
                        .dofs = network->dofs,
                        .count = network->count,
                        .errors = evidence->errors};
    size_t size = map->dofs + map->count + 1, system = map->dofs + map->errors + 1;
    map->point = calloc(size, sizeof(double));
    map->step = calloc(size, sizeof(double));
    map->trial = calloc(size, sizeof(double));
    map->slope = calloc(size, sizeof(double));
    map->trial_slope = calloc(size, sizeof(double));
    map->relative = calloc(2 * map->count + 1, sizeof(double));
    map->forces = calloc(2 * map->count + 1, sizeof(double));
    map->error = calloc(map->errors + 1, sizeof(double));
    map->curve = calloc(map->count + 1, sizeof *map->curve);
    map->slack = calloc(map->count + 1, sizeof(double));
    map->diagonal = calloc(system, sizeof(double));
    map->right = calloc(system, sizeof(double));
    map->solution = calloc(system, sizeof(double));
    if (!map->point || !map->step || !map->trial || !map->slope || !map->trial_slope || !map->relative ||
        !map->forces || !map->error || !map->curve || !map->slack || !map->diagonal || !map->right || !map->solution)
        return error_memory("map");
    map->matrix = network_matrix(map);
    return map->matrix ? 0 : -1;
}

/* Projection of (n, t) onto the wedge |t| <= mu n in the norm n^2 / vn + t^2 / vt; curve: V times its derivative. */
static void project(double mu, const double v[2], double n, double t, double out[2], double curve[3])
{
    if (!(mu > 0) || v[1] <= 0) { /* a half line */
        int pushes = n > 0;
        out[0] = pushes ? n : 0, out[1] = 0;
        curve[0] = pushes ? v[0] : 0, curve[1] = curve[2] = 0;
        return;
    }
    if (fabs(t) <= mu * n) {
        out[0] = n, out[1] = t;
        curve[0] = v[0], curve[1] = 0, curve[2] = v[1];
        return;
    }
    /* the edge in the direction (1, s): its coefficient is <z, edge> / <edge, edge> */
    double s = copysign(mu, t), norm = 1 / v[0] + s * s / v[1], along = (n / v[0] + s * t / v[1]) / norm;
    int pushes = along > 0;
    out[0] = pushes ? along : 0, out[1] = pushes ? s * along : 0;
    curve[0] = pushes ? 1 / norm : 0, curve[1] = s * curve[0], curve[2] = s * s * curve[0];
}

int map_measured(const struct map *map, size_t c)
{
    return isfinite(map->evidence->measured[c]) && !map->evidence->open[c];
}

double map_error_at(const struct map *map, size_t c)
{
    double sum = 0;
    for (int k = 0; k < EVIDENCE_WIDTH && map->evidence->place[c][k] >= 0; k++)
        sum += map->evidence->share[c][k] * map->error[map->evidence->place[c][k]];
    return sum;
}

void map_errors(struct map *map, const double *l)
{
    memset(map->error, 0, map->errors * sizeof(double));
    for (size_t c = 0; c < map->count; c++)
        for (int k = 0; k < EVIDENCE_WIDTH && map->evidence->place[c][k] >= 0; k++)
            map->error[map->evidence->place[c][k]] += map->evidence->share[c][k] * l[c];
}

/* The gradient of phi at (y, l); leaves P(z), its curve and e. */
static void evaluate(struct map *map, const double *point, double *slope)
{
    const struct evidence *evidence = map->evidence;
    const double *l = point + map->dofs;
    network_motion(map->network, point, map->relative);
    map_errors(map, l);
    for (size_t c = 0; c < map->count; c++) {
        const double *v = &evidence->variance[2 * c];
        double *f = &map->forces[2 * c], *curve = map->curve[c];
        if (evidence->open[c]) {
            f[0] = f[1] = curve[0] = curve[1] = curve[2] = 0;
            continue;
        }
        project(map->network->contact[c].mu, v, evidence->prior[2 * c] + v[0] * (map->relative[2 * c] + l[c]),
                evidence->prior[2 * c + 1] + v[1] * map->relative[2 * c + 1], f, curve);
    }
    network_unbalance(map->network, map->forces, slope);
    for (size_t c = 0; c < map->count; c++)
        slope[map->dofs + c] = map_measured(map, c) ? map->forces[2 * c] + map_error_at(map, c) + map->slack[c] * l[c] -
                                                          evidence->measured[c]
                                                    : 0;
}

/* What contact c adds to the system: its equilibrium part less what its overlap equation takes up (d its pivot). */
static void add_block(struct map *map, size_t c)
{
    const struct network_contact *contact = &map->network->contact[c];
    const double *curve = map->curve[c], *share = map->evidence->share[c];
    double block[MAP_WIDTH * MAP_WIDTH] = {0}, a[NETWORK_WIDTH], b[NETWORK_WIDTH];
    int measured = map_measured(map, c);
    double d = curve[0] + map->slack[c], gain = measured ? 1 / d : 0;
    for (int i = 0; i < NETWORK_WIDTH; i++) {
        a[i] = contact->n[i] * curve[0] + contact->t[i] * curve[1];
        b[i] = contact->n[i] * curve[1] + contact->t[i] * curve[2];
        for (int j = 0; j <= i; j++)
            block[i * MAP_WIDTH + j] = a[i] * contact->n[j] + b[i] * contact->t[j] - gain * a[i] * a[j];
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

int map_factorise(struct map *map, double shift)
{
    sparse_clear(map->matrix);
    for (size_t c = 0; c < map->count; c++)
        if (map->curve[c][0] + map->curve[c][2] > 0 || map_measured(map, c))
            add_block(map, c);
    for (size_t d = 0; d < map->dofs; d++)
        map->diagonal[d] = shift;
    for (size_t k = 0; k < map->errors; k++)
        map->diagonal[map->dofs + k] = -1;
    sparse_add_diagonal(map->matrix, map->diagonal, 0);
    return sparse_factorise_indefinite(map->matrix);
}

static double stroke(const struct map *map, size_t c, int dof)
{
    const struct network_contact *contact = &map->network->contact[c];
    return contact->n[dof] * map->curve[c][0] + contact->t[dof] * map->curve[c][1];
}

int map_back_solve(struct map *map)
{
    const struct evidence *evidence = map->evidence;
    memset(map->right, 0, (map->dofs + map->errors) * sizeof(double));
    for (size_t d = 0; d < map->dofs; d++)
        map->right[d] = -map->slope[d];
    for (size_t c = 0; c < map->count; c++) {
        const int *dof = map->network->contact[c].dof, *place = evidence->place[c];
        double g = map_measured(map, c) ? map->slope[map->dofs + c] / (map->curve[c][0] + map->slack[c]) : 0;
        for (int k = 0; k < NETWORK_WIDTH && dof[k] >= 0; k++)
            map->right[dof[k]] += stroke(map, c, k) * g;
        for (int k = 0; k < EVIDENCE_WIDTH && place[k] >= 0; k++)
            map->right[map->dofs + (size_t)place[k]] += evidence->share[c][k] * g;
    }
    if (sparse_solve(map->matrix, map->right, map->solution))
        return -1;
    memcpy(map->step, map->solution, map->dofs * sizeof(double));
    for (size_t c = 0; c < map->count; c++) {
        const int *dof = map->network->contact[c].dof, *place = evidence->place[c];
        double sum = map->slope[map->dofs + c];
        for (int k = 0; k < NETWORK_WIDTH && dof[k] >= 0; k++)
            sum += stroke(map, c, k) * map->solution[dof[k]];
        for (int k = 0; k < EVIDENCE_WIDTH && place[k] >= 0; k++)
            sum += evidence->share[c][k] * map->solution[map->dofs + (size_t)place[k]];
        map->step[map->dofs + c] = map_measured(map, c) ? -sum / (map->curve[c][0] + map->slack[c]) : 0;
    }
    return 0;
}

static double slope_at(struct map *map, double length)
{
    size_t n = map->dofs + map->count;
    double slope = 0;
    for (size_t d = 0; d < n; d++)
        map->trial[d] = map->point[d] + length * map->step[d];
    evaluate(map, map->trial, map->trial_slope);
    for (size_t d = 0; d < n; d++)
        slope += map->trial_slope[d] * map->step[d];
    return slope;
}

/* The minimum of phi along the step, from its slope, which grows along the line: bracketed by doubling, closed in by
 * regula falsi (Illinois) until half of the first slope is left. An evaluation costs a small part of a factorisation.
 * Moves the point and returns the length; 0: no decrease. */
static double search(struct map *map)
{
    size_t n = map->dofs + map->count;
    double first = 0, low = 0, high = 1, at_low, at_high, length;
    for (size_t d = 0; d < n; d++)
        first += map->slope[d] * map->step[d];
    if (!(first < 0))
        return 0;
    at_low = first;
    for (at_high = slope_at(map, high); at_high < MAP_SLOPE * first && high < MAP_LONGEST;
         at_high = slope_at(map, high))
        low = high, at_low = at_high, high *= 2;
    length = high;
    double here = at_high;
    for (int k = 0, side = 0; k < MAP_LOOKS && at_high > 0 && fabs(here) > -MAP_SLOPE * first; k++) {
        length = (low * at_high - high * at_low) / (at_high - at_low);
        here = slope_at(map, length);
        if (here > 0) {
            high = length, at_high = here;
            at_low /= side == 1 ? 2 : 1;
            side = 1;
        } else {
            low = length, at_low = here;
            at_high /= side == -1 ? 2 : 1;
            side = -1;
        }
    }
    for (size_t d = 0; d < n; d++)
        map->point[d] += length * map->step[d];
    return length;
}

static double largest_of(size_t n, const double *a)
{
    double largest = 0;
    for (size_t k = 0; k < n; k++)
        largest = fmax(largest, fabs(a[k]));
    return largest;
}

static double stiffest(const struct map *map)
{
    double largest = 0;
    for (size_t c = 0; c < map->count; c++)
        largest = fmax(largest, map->curve[c][0] + map->curve[c][2]);
    return largest > 0 ? largest : 1;
}

/* Newton steps for the present set of closed contacts; f keeps the best forces. *imbalance: of f. */
static int newton(struct map *map, double *f, int limit, struct outcome *outcome)
{
    double shift = MAP_FIRST_SHIFT;
    outcome->imbalance = INFINITY;
    for (;; outcome->iterations++) {
        evaluate(map, map->point, map->slope);
        double imbalance = largest_of(map->dofs, map->slope) / network_mean_force(map->network, map->forces);
        double left = largest_of(map->count, map->slope + map->dofs);
        if (imbalance < outcome->imbalance || (imbalance <= map->options->tolerance && left <= MAP_OPTIMAL)) {
            outcome->imbalance = imbalance;
            memcpy(f, map->forces, 2 * map->count * sizeof *f);
        }
        if ((imbalance <= map->options->tolerance && left <= MAP_OPTIMAL) || outcome->iterations >= limit)
            return 0;
        if (map_factorise(map, shift * stiffest(map)) || map_back_solve(map))
            return -1;
        double length = search(map);
        if (length == 0)
            return 0;
        shift = length > 0.5 ? fmax(MAP_LEAST_SHIFT, shift / 10) : length < 0.1 ? fmin(1, shift * 4) : shift;
    }
}

/* First a gap is believed only to its own size, so that lost contacts can come in. Then a contact that carries nothing
 * and whose most likely overlap is negative is open: its overlap is believed only to the size of that gap, which hardly
 * costs or pulls any more. Returns how many contacts the rule found. */
static size_t set_slack(struct map *map, int round, const double *f)
{
    size_t open = 0;
    for (size_t c = 0; c < map->count; c++) {
        double gap = round == 0 ? map->evidence->measured[c] : map->evidence->measured[c] - map_error_at(map, c);
        int opens = isfinite(gap) && gap < 0 && (round == 0 || f[2 * c] <= MAP_OPEN);
        map->slack[c] = map->evidence->slack[c] + (opens ? gap * gap : 0);
        open += (size_t)opens;
    }
    return open;
}

/* Interior point for the present set of closed contacts. When the loads cannot be balanced, again with equilibrium as
 * an equation with an error of SOFT_BALANCE: the least unbalanced forces that the overlaps support. */
static int interior(struct map *map, double *f, struct outcome *outcome)
{
    int status = map_interior(map, 0, &outcome->iterations);
    if (status == 1)
        status = map_interior(map, SOFT_BALANCE * SOFT_BALANCE, &outcome->iterations);
    if (status < 0)
        return -1;
    for (size_t c = 0; c < map->count; c++)
        if (map->forces[2 * c] < 0.1 * map->options->tolerance)
            map->forces[2 * c] = map->forces[2 * c + 1] = 0;
    outcome->imbalance = network_judge(map->network, map->forces, map->trial_slope);
    memcpy(f, map->forces, 2 * map->count * sizeof *f);
    return 0;
}

static int solve(struct map *map, double *f, struct outcome *outcome)
{
    int limit = map->options->iterations > 0 ? map->options->iterations : map->errors > 0 ? 0 : MAP_STEPS;
    if (limit > 0 && newton(map, f, limit, outcome))
        return -1;
    if (limit > 0 && outcome->imbalance <= map->options->tolerance)
        return 0;
    return interior(map, f, outcome);
}

static int rounds(struct map *map, double *f, struct outcome *outcome)
{
    *outcome = (struct outcome){0};
    set_slack(map, 0, f);
    if (solve(map, f, outcome))
        return -1;
    map_errors(map, map->point + map->dofs);
    if (set_slack(map, 1, f) > 0 && solve(map, f, outcome))
        return -1;
    outcome->converged = outcome->imbalance <= map->options->tolerance;
    return 0;
}

int map_solve(const struct network *network, const struct force_options *options, struct evidence *evidence, double *f,
              struct outcome *outcome)
{
    struct map map;
    int status = map_begin(network, options, evidence, &map) || rounds(&map, f, outcome) ? -1 : 0;
    map_free(&map);
    return status;
}
