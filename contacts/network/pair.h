/* The geometry of one pair: a grain and a second grain, a straight wall or a corner disc (docs/theory.md section 1). */
#ifndef CONTACTS_PAIR_H
#define CONTACTS_PAIR_H

#include "contacts/radii/pair_statistics.h"
#include "pipeline/numbers/geometry.h"
#include "pipeline/packing/grains.h"
#include "pipeline/packing/walls.h"

struct pair {
    int64_t i, j;     /* i < j; j - number of grains: a wall */
    struct vec n;     /* from i to j */
    struct vec at;    /* contact point: the middle of the overlap, m */
    double overlap;   /* R_i + R_j - d with the rim radii along the branch, m */
    double s_overlap; /* its standard error in this state: constant and photo errors together, m */
    struct pair_odds odds;
};

/* Rim radius of a grain in the direction n (mean radius + shape), m. */
double rim_radius(const struct grains *grains, size_t k, struct vec n);
/* Variance of the rim radius less the projection of the centre on n, m2. */
double rim_variance(const struct grains *grains, size_t k, struct vec n);

/* The pair of two grains, of which i < j; of a grain and wall `wall`, whose error counts along its normal and with the
 * arm of its tilt. `odds` is not set. Columns that are missing count as exact. */
struct pair pair_of_grains(const struct grains *grains, size_t i, size_t j);
struct pair pair_with_wall(const struct grains *grains, size_t i, const struct walls *walls, size_t wall);

#endif
