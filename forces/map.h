/* Inside of map: the state that its two solvers share (map.c: semismooth Newton, interior.c: interior point). */
#ifndef FORCES_MAP_H
#define FORCES_MAP_H

#include "forces/evidence.h"
#include "forces/sparse.h"

enum { MAP_WIDTH = NETWORK_WIDTH + EVIDENCE_WIDTH };

struct map {
    const struct network *network;
    const struct force_options *options;
    struct evidence *evidence;
    struct sparse *matrix;
    size_t dofs, count, errors;                         /* sizes of y, l, e */
    double *point, *step, *trial, *slope, *trial_slope; /* (y, l) and gradients of phi */
    double *relative;                                   /* A' y */
    double *forces;                                     /* P(z) */
    double *error;                                      /* e = B' l */
    double (*curve)[3];                                 /* V times the derivative of P: nn, nt, tt */
    double *slack;                                      /* of this round */
    double *diagonal, *right, *solution;                /* of the system in (y, e) */
};

/* Does contact c have an overlap that counts? */
int map_measured(const struct map *map, size_t c);
/* e = B' l of all open and closed contacts; then B e of contact c. */
void map_errors(struct map *map, const double *l);
double map_error_at(const struct map *map, size_t c);
/* The system of Newton's step for the compliance `curve` (2 x 2 per contact), `shift` on the diagonal of y. */
int map_factorise(struct map *map, double shift);
/* `step` in (y, l) for the gradient `slope`, with the last factor. */
int map_back_solve(struct map *map);

/* A primal-dual interior point (Mehrotra 1992) from scratch: leaves its multipliers in `point`, admissible forces in
 * `forces`. 0: done; 1: not within the limit, so the loads can hardly be balanced; -1: failed. */
int map_interior(struct map *map, double softness, int *iterations);

#endif
