/* The most likely admissible forces (docs/forces.md): minimise
 *
 *     1/2 |f - f0|^2 / variance + 1/2 |e|^2 + 1/2 |r|^2 / slack + 1/2 |d|^2 / soft - sum weight log s
 *     with  A f + b + d = 0,  fn + B e + r = m,  s = mu fn -+ ft > 0 (fn > 0 without friction),
 *
 * a convex problem, solved by the interior point in a few rounds. What a round learns about a contact (does it carry at
 * all? how much friction can it have?) or about a grain (does something push it that is not in the network?) sets the
 * variances of the next, which starts from its solution. */
#include "forces/methods/map.h"

#include <stdlib.h>
#include <string.h>

/* When the network as it is cannot be balanced: the unknown load on a grain has Student's distribution of this scale
 * and degree (Cauchy), so that few grains miss much and the others nothing. */
#define SOFT_BALANCE 0.01 /* <fn>: what one calls balanced in the experiment (thesis Fig. 4.41) */
#define SOFT_DEGREE 1
#define LEAST_FRICTION 1e-4 /* <fn>^2, variance of ft where fn vanishes */
#define NO_BARRIER 1e-20    /* a weight that moves no force by more than 1e-10 <fn> */
enum { HARD_TRIES = 3, SOFT_ROUNDS = 5 };

/* The weight of log s. A density exp(-c . f) over a cone of n dimensions has the mean <c . f> = n; the minimum of
 * c . f - weight sum log s over m edges has c . f = m weight. So with weight = n / m the most likely forces lie where
 * the mean of the posterior lies, not in the cone's corners. n: force components less equations. A contact that is
 * closed with probability p counts p times. */
static void set_weights(struct map *map)
{
    double edges = 0, probable = 0;
    for (size_t c = 0; c < map->count; c++) {
        double sides = map->network->contact[c].mu > 0 ? 2 : 1;
        edges += sides;
        probable += sides * map->evidence->probability[c];
    }
    double weight = map->evidence->barrier ? fmax(1, probable - (double)map->dofs) / fmax(1, probable) : NO_BARRIER;
    for (size_t c = 0; c < map->count; c++)
        map->weight[c] = weight * fmax(1 / (1 + edges), map->evidence->probability[c]);
}

/* A contact that may be open and whose gap is larger than its force is believed to have that gap: with the probability
 * that it is open, its overlap says nothing. At first the gap is the measured one. */
static void set_slack(struct map *map, int first)
{
    for (size_t c = 0; c < map->count; c++) {
        double gap = -map->evidence->measured[c] + (first ? 0 : map_error_at(map, c));
        int opens = gap > 0 && (first || map->forces[2 * c] < gap);
        map->slack[c] = map->evidence->slack[c] + (opens ? (1 - map->evidence->probability[c]) * gap * gap : 0);
    }
}

/* Once fn is known, ft is believed to be as large as Coulomb allows. */
static void set_friction(struct map *map)
{
    for (size_t c = 0; c < map->count && map->evidence->friction; c++) {
        double limit = map->network->contact[c].mu * map->forces[2 * c];
        map->variance[2 * c + 1] = fmax(LEAST_FRICTION, limit * limit);
    }
}

/* The same variance everywhere, more where a partner of the grain is missing. */
static void set_soft(struct map *map, double least)
{
    for (size_t d = 0; d < map->dofs; d++)
        map->soft[d] = fmax(least, map->evidence->soft[d]);
}

/* Expectation step for Student's distribution in three dimensions: the variance of each grain's unknown load, from the
 * load d = soft y that was found. */
static void set_soft_again(struct map *map)
{
    const double least = SOFT_DEGREE * SOFT_BALANCE * SOFT_BALANCE;
    for (size_t k = 0; k < map->network->grains; k++) {
        long dof = map->network->grain_dof[k];
        double square = 0;
        for (long d = dof; dof >= 0 && d < dof + 3; d++)
            square += pow(map->soft[d] * map->y[d], 2);
        for (long d = dof; dof >= 0 && d < dof + 3; d++)
            map->soft[d] = fmax(map->evidence->soft[d], (least + square) / (SOFT_DEGREE + 3));
    }
}

/* What the round has told about each contact, for the next one. */
static void learn(struct map *map)
{
    set_slack(map, 0);
    set_friction(map);
}

/* The largest load that no grain but those of doubtful neighbourhood should need. */
static double largest_load(const struct map *map)
{
    double largest = 0;
    for (size_t d = 0; d < map->dofs; d++)
        if (map->evidence->soft[d] == 0)
            largest = fmax(largest, fabs(map->soft[d] * map->y[d]) + map->balance);
    return largest;
}

/* Equilibrium is exact but for a variance that leaves less than the tolerance where the cones of a grain's contacts
 * touch only in their corners: there the load is sqrt(weight soft). Near mechanisms have large y, so that a smaller
 * variance is tried when the load is too large. 1: the loads cannot be balanced. */
static int solve_hard(struct map *map, struct outcome *outcome)
{
    const double tolerance = map->options->tolerance;
    double least = 0.1 * tolerance * tolerance;
    set_slack(map, 1);
    for (int k = 0; k < HARD_TRIES; k++) {
        set_soft(map, least);
        int status = map_interior(map, &outcome->iterations);
        if (status)
            return status;
        double largest = largest_load(map);
        if (largest <= tolerance)
            break;
        least *= pow(0.3 * tolerance / largest, 2);
    }
    learn(map);
    int status = largest_load(map) > tolerance ? 1 : map_interior(map, &outcome->iterations);
    return status ? status : largest_load(map) > tolerance;
}

/* Reweighted SOFT_ROUNDS times, from scratch: the last point was that of another problem. */
static int solve_soft(struct map *map, struct outcome *outcome)
{
    map->warm = 0;
    map->feasible = 1;
    set_slack(map, 1);
    set_soft(map, SOFT_BALANCE * SOFT_BALANCE);
    for (int k = 0; k <= SOFT_ROUNDS; k++) {
        if (map_interior(map, &outcome->iterations) < 0)
            return -1;
        if (k < SOFT_ROUNDS) {
            set_soft_again(map);
            learn(map);
        }
    }
    return 0;
}

/* With equilibrium exact; where that has no solution, with an unknown load on every grain. */
int map_rounds(struct map *map, struct outcome *outcome)
{
    *outcome = (struct outcome){0};
    set_weights(map);
    int status = solve_hard(map, outcome);
    return status < 0 || (status > 0 && solve_soft(map, outcome)) ? -1 : 0;
}

int map_solve(const struct network *network, const struct force_options *options, const struct evidence *evidence,
              double *f, struct outcome *outcome)
{
    struct map map;
    int status = map_begin(network, options, evidence, &map) || map_rounds(&map, outcome) ? -1 : 0;
    if (!status) {
        memcpy(f, map.forces, 2 * map.count * sizeof *f);
        outcome->imbalance = network_judge(network, f, map.left);
        outcome->converged = outcome->imbalance <= options->tolerance;
    }
    map_free(&map);
    return status;
}
