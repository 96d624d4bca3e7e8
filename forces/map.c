/* The most likely admissible forces: minimise 1/2 |f - f0|^2_W over f in the Coulomb cones with A f + b = 0, W the
 * inverse variances. In 2D the cones are wedges, so this is a convex quadratic programme. Its dual is unconstrained:
 *
 *     minimise phi(y) = 1/2 |P(z)|^2_W + b . y,   z = f0 + V A' y,   V = 1 / W,
 *
 * P the projection onto the wedge in the norm of W, in closed form; the gradient A P(z) + b is what is out of balance.
 * phi is once differentiable and piecewise quadratic: semismooth Newton (Qi and Sun 1993) with a proximal shift and a
 * line search on the slope converges from anywhere in a few tens of steps (docs/forces.md). */
#include "forces/method.h"

#include <stdlib.h>
#include <string.h>

#include "forces/sparse.h"
#include "pipeline/error.h"

#define MAP_FIRST_SHIFT 1e-5 /* of the largest diagonal entry */
#define MAP_SLOPE 0.5
#define MAP_LEAST_SHIFT 1e-11
enum { MAP_STEPS = 500, MAP_LOOKS = 30, MAP_LONGEST = 1024 };

struct map {
    const struct network *network;
    const struct force_options *options;
    const double *variance, *prior;
    struct sparse *matrix;
    double *y, *step, *trial, *gradient, *trial_gradient;
    double *relative; /* A' y */
    double *forces;   /* P(z) */
};

static void map_free(struct map *map)
{
    sparse_free(map->matrix);
    free(map->y), free(map->step), free(map->trial), free(map->gradient), free(map->trial_gradient);
    free(map->relative), free(map->forces);
}

static int map_begin(const struct network *network, const struct force_options *options, const double *variance,
                     const double *prior, struct map *map)
{
    size_t dofs = network->dofs + 1, unknowns = 2 * network->count + 1;
    *map = (struct map){.network = network, .options = options, .variance = variance, .prior = prior};
    map->y = calloc(dofs, sizeof(double));
    map->step = calloc(dofs, sizeof(double));
    map->trial = calloc(dofs, sizeof(double));
    map->gradient = calloc(dofs, sizeof(double));
    map->trial_gradient = calloc(dofs, sizeof(double));
    map->relative = calloc(unknowns, sizeof(double));
    map->forces = calloc(unknowns, sizeof(double));
    int *place = malloc((network->count * NETWORK_WIDTH + 1) * sizeof *place);
    if (!map->y || !map->step || !map->trial || !map->gradient || !map->trial_gradient || !map->relative ||
        !map->forces || !place) {
        free(place);
        return error_memory("map");
    }
    for (size_t c = 0; c < network->count; c++)
        memcpy(place + c * NETWORK_WIDTH, network->contact[c].dof, sizeof network->contact[c].dof);
    map->matrix = sparse_create(network->dofs, network->count, NETWORK_WIDTH, place);
    free(place);
    return map->matrix ? 0 : -1;
}

/* Projection of (n, t) onto the wedge |t| <= mu n in the norm n^2 / vn + t^2 / vt. `curve` receives V times its
 * derivative: the symmetric matrix {nn, nt, tt}. */
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

/* The gradient of phi at y and the forces P(z); assembles the Newton matrix when asked. */
static void evaluate(struct map *map, const double *y, double *gradient, int assemble)
{
    const struct network *network = map->network;
    network_motion(network, y, map->relative);
    if (assemble)
        sparse_clear(map->matrix);
    for (size_t c = 0; c < network->count; c++) {
        const struct network_contact *contact = &network->contact[c];
        const double *v = &map->variance[2 * c];
        double *f = &map->forces[2 * c], curve[3];
        project(contact->mu, v, map->prior[2 * c] + v[0] * map->relative[2 * c],
                map->prior[2 * c + 1] + v[1] * map->relative[2 * c + 1], f, curve);
        if (!assemble || curve[0] + curve[2] <= 0)
            continue;
        double block[NETWORK_WIDTH * NETWORK_WIDTH];
        for (int i = 0; i < NETWORK_WIDTH; i++) {
            double a = contact->n[i] * curve[0] + contact->t[i] * curve[1];
            double b = contact->n[i] * curve[1] + contact->t[i] * curve[2];
            for (int j = 0; j <= i; j++)
                block[i * NETWORK_WIDTH + j] = a * contact->n[j] + b * contact->t[j];
        }
        sparse_add(map->matrix, c, block);
    }
    network_unbalance(network, map->forces, gradient);
}

/* Newton direction; the shift keeps the matrix positive definite where contacts are open, and vanishes with the
 * gradient, so that the last steps are exact. */
static int direction(struct map *map, double shift)
{
    sparse_add_diagonal(map->matrix, NULL, shift);
    if (sparse_factorise(map->matrix) < 0 || sparse_solve(map->matrix, map->gradient, map->step))
        return -1;
    for (size_t d = 0; d < map->network->dofs; d++)
        map->step[d] = -map->step[d];
    return 0;
}

static double slope_at(struct map *map, double length)
{
    size_t n = map->network->dofs;
    double slope = 0;
    for (size_t d = 0; d < n; d++)
        map->trial[d] = map->y[d] + length * map->step[d];
    evaluate(map, map->trial, map->trial_gradient, 0);
    for (size_t d = 0; d < n; d++)
        slope += map->trial_gradient[d] * map->step[d];
    return slope;
}

/* The minimum of phi along the step, from its slope, which grows along the line: bracketed by doubling, closed in by
 * regula falsi (Illinois) until half of the first slope is left. An evaluation costs a small part of a
 * factorisation. Moves y and returns the length; 0: no decrease. */
static double search(struct map *map)
{
    size_t n = map->network->dofs;
    double first = 0, low = 0, high = 1, at_low, at_high, length = 1;
    for (size_t d = 0; d < n; d++)
        first += map->gradient[d] * map->step[d];
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
        map->y[d] += length * map->step[d];
    return length;
}

static int iterate(struct map *map, double *f, struct outcome *outcome)
{
    const struct network *network = map->network;
    size_t size = 2 * network->count * sizeof(double);
    int limit = map->options->iterations > 0 ? map->options->iterations : MAP_STEPS;
    double best = INFINITY, shift = MAP_FIRST_SHIFT;
    for (outcome->iterations = 0;; outcome->iterations++) {
        double largest = 0;
        evaluate(map, map->y, map->gradient, 1);
        for (size_t d = 0; d < network->dofs; d++)
            largest = fmax(largest, fabs(map->gradient[d]));
        double imbalance = largest / network_mean_force(network, map->forces);
        if (imbalance < best) {
            best = imbalance;
            memcpy(f, map->forces, size);
        }
        if (imbalance <= map->options->tolerance || outcome->iterations >= limit)
            break;
        double scale = sparse_largest(map->matrix);
        if (direction(map, (scale > 0 ? scale : 1) * shift))
            return -1;
        double length = search(map);
        if (length == 0)
            break;
        shift = length > 0.5 ? fmax(MAP_LEAST_SHIFT, shift / 10) : length < 0.1 ? fmin(1, shift * 4) : shift;
    }
    outcome->imbalance = best;
    outcome->converged = best <= map->options->tolerance;
    return 0;
}

int map_solve(const struct network *network, const struct force_options *options, const double *variance, double *f,
              struct outcome *outcome)
{
    struct map map;
    double *prior = malloc((2 * network->count + 1) * sizeof *prior);
    if (!prior)
        return error_memory("map");
    memcpy(prior, f, 2 * network->count * sizeof *prior);
    int status = map_begin(network, options, variance, prior, &map) || iterate(&map, f, outcome) ? -1 : 0;
    map_free(&map);
    free(prior);
    return status;
}
