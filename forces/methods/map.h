/* Inside of map: one state that its parts share. map.c: the rounds; map_system.c: the linear system of a step;
 * interior.c: the interior point; map_start.c: where it begins. */
#ifndef FORCES_MAP_H
#define FORCES_MAP_H

#include "forces/algebra/sparse.h"
#include "forces/methods/method.h"
#include "forces/network/evidence.h"

enum { MAP_WIDTH = NETWORK_WIDTH + EVIDENCE_WIDTH };

struct map {
    const struct network *network;
    const struct force_options *options;
    const struct evidence *evidence;
    struct sparse *matrix;
    size_t dofs, count, errors; /* sizes of y, l, e */
    double *store;              /* all arrays below */
    size_t size;                /* of the store */

    double *soft;                   /* variance of the unknown load on each degree of freedom, in this round */
    double *slack;                  /* variance of r of each contact, in this round */
    double *variance;               /* of f about the belief, 2 per contact, in this round */
    double *weight;                 /* of the barrier at each contact's edges */
    double *y, *l;                  /* multipliers of equilibrium and overlaps, side by side */
    double *forces;                 /* 2 per contact */
    double (*side)[2], (*press)[2]; /* distances to the sides of the cone, and their multipliers (cone.h) */
    int warm;                       /* these are a solution of a problem like this one */
    double rough;                   /* 1: exact; more: what may be left, over what an exact solution may leave */
    int feasible;                   /* unknown loads on every grain can balance anything: there is a solution */

    double *error;                       /* e = B' l */
    double *left, *step, *right, *found; /* what the equations in (y, l) leave; the step; the system in (y, e) */
    double *relative;                    /* A' y */
    double *dual;                        /* W (f - f0) - A' y - l - G' press */
    double *push;                        /* what the targets push, as a force */
    double (*push_side)[2];              /* the same, in side coordinates */
    double (*dside)[2], (*dpress)[2];    /* steps */
    double (*target)[2];                 /* what the step aims at, less side times press */
    double (*compliance)[3];             /* in side coordinates: dside = compliance (what y, l and targets push) */
    double (*curve)[3];                  /* the same for (fn, ft): nn, nt, tt */
    double *diagonal;
    double balance, data, gap, off; /* largest left in equilibrium and overlaps; mean of side times press; largest
                                        |side press / weight - 1| */
    double rounding;                /* of the multipliers */
    double length;                  /* of the last step */
};

/* Without contacts or equations there is nothing to do, but everything is allocated. */
int map_begin(const struct network *network, const struct force_options *options, const struct evidence *evidence,
              struct map *map);
void map_free(struct map *map);
/* Take over the solution, and the variances of its last round, of another map of the same network. */
void map_copy(const struct map *from, struct map *to);
/* All rounds, from scratch; leaves the forces in `map->forces`. */
int map_rounds(struct map *map, struct outcome *outcome);

/* The most likely admissible forces for that evidence; f receives them. */
int map_solve(const struct network *network, const struct force_options *options, const struct evidence *evidence,
              double *f, struct outcome *outcome);

/* Does contact c have an overlap that counts? */
int map_measured(const struct map *map, size_t c);
/* e = B' l; then B e of contact c. */
void map_errors(struct map *map);
double map_error_at(const struct map *map, size_t c);
/* The system of a step for the compliance `curve`. */
int map_factorise(struct map *map);
/* `step` in (y, l) that takes away `left`, with the last factor. */
int map_back_solve(struct map *map);

/* The point at which an interior point without a last solution begins (map_start.c). */
int map_cold_start(struct map *map);
/* (fn, 0) on contact c, with its distances to the sides of the cone. */
void map_set_force(struct map *map, size_t c, double fn);
/* Primal-dual interior point (Mehrotra 1992) for soft, slack and weight, from the last solution when `warm`, else from
 * scratch. Leaves forces inside their cones, y, l, e. 0: done; 1: not within the limit; -1: failed. */
int map_interior(struct map *map, int *iterations);

#endif
