/* Discrete elements in the plane: rods seen from their end (discs of mass m = rho pi R^2 L), springs, dashpots and
 * Coulomb friction at their contacts, inside a box of four walls (theory.md sections 1 and 5).
 *
 * The box is a parallelogram with its lower left corner at the origin: width W along the bottom, height H, shear g
 * (the top is displaced by g H to the right, the side walls tilt). Its three numbers are its degrees of freedom.
 *
 * Contact (i, j): overlap x = R_i + R_j - |x_j - x_i|, the contact point in the middle of the overlap, so that the
 * lever arms are R - x/2. The force on j from i is fn n + ft t. */
#ifndef SIMULATION_DEM_H
#define SIMULATION_DEM_H

#include <stddef.h>

#include "pipeline/laws/contact_spring.h"
#include "pipeline/numbers/geometry.h"

enum { BOX_WIDTH, BOX_HEIGHT, BOX_SHEAR, BOX_FREEDOMS };
enum { SIDE_BOTTOM, SIDE_RIGHT, SIDE_TOP, SIDE_LEFT, SIDES };
enum { BOX_BOTTOM_LEFT, BOX_BOTTOM_RIGHT, BOX_TOP_RIGHT, BOX_TOP_LEFT, BOX_CORNERS }; /* side k goes from k to k + 1 */
enum { DEM_PARALLEL_FROM = 4000 }; /* fewer grains: one thread is faster */

struct dem_grain {
    double x, y, angle;    /* m, m, rad (cumulative) */
    double vx, vy, spin;   /* m/s, m/s, rad/s: at half steps */
    double fx, fy, moment; /* N, N, N m: everything that acts on it */
    double radius;         /* m */
    double mass, inertia;  /* kg, kg m2 */
    double load_x, load_y; /* N: from outside, without gravity */
    double load_m;         /* N m: from outside */
    double lost;           /* J: by friction and dashpots at its contacts with later grains and walls */
    int fixed;             /* 1: does not move */
};

struct dem_side {
    struct vec point, inward; /* a point of its line; unit normal into the box */
    struct vec velocity;      /* m/s of that point */
    double tilt_rate;         /* 1/s: velocity along x grows by this per metre of height above the point */
    struct vec force;         /* N: what the grains push it with */
};

/* A disc in a corner of the box, convex, without spin. */
struct dem_corner {
    struct vec at, velocity; /* m, m/s: of its centre, which is the corner */
    struct vec force;        /* N: what the grains push it with */
};

struct dem_box {
    int given;                 /* 0: no walls */
    double size[BOX_FREEDOMS]; /* m, m, 1 */
    double rate[BOX_FREEDOMS]; /* m/s, m/s, 1/s */
    double push[BOX_FREEDOMS]; /* N, N, N m: work of the grains' forces per unit of each freedom */
    double work;               /* J: done by the walls on the grains since the beginning (trapezoidal rule) */
    double worked_size[BOX_FREEDOMS];
    double corner_radius;        /* m; 0: no discs in the corners */
    struct dem_side side[SIDES]; /* follow from the above: dem_place_walls() */
    struct dem_corner corner[BOX_CORNERS];
};

/* Two grains (or a grain and a side, j = number of grains + side; or a corner, j = number of grains + SIDES + corner)
 * near enough to touch before the next search. */
struct dem_pair {
    int i, j;
    int touching, slips;          /* 0 or 1 */
    double fn;                    /* N: spring and dashpot */
    double nx, ny;                /* from i to j */
    double overlap;               /* m; touching only where positive */
    double damping;               /* kg^1/2: of the normal dashpot, per square root of the stiffness */
    struct contact_spring spring; /* its ft is the tangential force */
};

struct dem {
    size_t count;
    struct dem_grain *grains;
    struct dem_box box;
    struct dem_pair *pairs;        /* grain pairs sorted by (i, j), then walls sorted by (i, side) */
    struct contact_pair *pair_law; /* per pair, where the law depends on the radii; else NULL */
    size_t pair_count, pair_capacity;
    size_t *first, *wall_first; /* count + 1: first grain pair, first wall pair of each grain i */
    size_t *back_first, *back;  /* count + 1; grain pairs in which a grain is the second: for threads */
    struct vec *searched_at;    /* where each grain was at the last search */
    double searched_size[BOX_FREEDOMS];
    double skin; /* m: pairs nearer than this are kept */
    struct contact_law law;
    struct contact_pair linear; /* of the linear law: one for all */
    double mu, mu_wall;         /* as used now: a preparation may use another friction than the law */
    double damping_ratio;       /* of critical, at the contacts */
    double stiffest;            /* N/m: of the contacts at the last forces */
    double dust;                /* N: mean normal forces below this are none: the packing carries nothing */
    struct vec gravity;         /* m/s2 */
    size_t parallel_from;       /* grains */
    size_t searches;
};

int dem_alloc(struct dem *dem, size_t count);
void dem_free(struct dem *dem);
/* Another packing in the same state; `to` is empty before. */
int dem_copy(const struct dem *from, struct dem *to);
/* Another contact law for the same grains. Overlaps and histories (tangential force, stiffness, largest force) stay as
 * they are; normal forces follow the new law from the next forces on. -1: no memory. */
int dem_change_law(struct dem *dem, const struct contact_law *law);

/* Damping ratio of a linear spring and dashpot that is never pulled, for a normal restitution e in [0.14, 1]:
 * e = exp(-(pi - 2 a) tan a), ratio = sin a (the contact ends when its force vanishes, not its overlap). */
double dem_damping_ratio(double restitution);

/* Sides and corners from the box's size and rate. */
void dem_place_walls(struct dem *dem);
/* Where corner k of the box is. */
struct vec dem_corner_at(const struct dem_box *box, int k);
/* All forces at the present positions; the friction springs have moved by the relative velocities times dt. Searches
 * for new pairs when grains have moved far enough. dem_forces_static leaves the dashpots out. Do not depend on the
 * number of threads. */
int dem_forces(struct dem *dem, double dt);
int dem_forces_static(struct dem *dem, double dt);
/* sqrt(m/k) of the lightest grain: the unit of time steps. */
double dem_time_unit(const struct dem *dem, double stiffness);
/* What the law makes of pair p. */
const struct contact_pair *dem_pair_law(const struct dem *dem, size_t p);

struct dem_energy {
    double kinetic, stored, lost; /* J: lost since the beginning, by friction and dashpots */
};
struct dem_energy dem_energy(const struct dem *dem);

/* The pairs (neighbours.c). 1: searched anew; 0: not needed; -1: failed. */
int dem_find_pairs(struct dem *dem);

#endif
