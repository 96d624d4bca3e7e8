/* Coulomb's cone fn >= 0, |ft| <= mu fn as edges, for the interior points: with friction the distances to its two
 * sides,
 *
 *     side = G f:  side1 = mu fn - ft >= 0,  side2 = mu fn + ft >= 0,
 *
 * without it the one side fn >= 0. Each side has a multiplier, `press` >= 0: how hard the side presses on f, by
 * G' press. An interior point ends where side times press is what its barrier asks for. */
#ifndef FORCES_CONE_H
#define FORCES_CONE_H

static inline int cone_sides(double mu)
{
    return mu > 0 ? 2 : 1;
}

/* side = G f; a side that is not there has distance 1. */
static inline void cone_side(double mu, const double f[2], double side[2])
{
    side[0] = mu > 0 ? mu * f[0] - f[1] : f[0];
    side[1] = mu > 0 ? mu * f[0] + f[1] : 1;
}

/* f = G^-1 side: nothing cancels when a force comes close to an edge. */
static inline void cone_force(double mu, const double side[2], double f[2])
{
    f[0] = mu > 0 ? (side[0] + side[1]) / (2 * mu) : side[0];
    f[1] = mu > 0 ? (side[1] - side[0]) / 2 : 0;
}

/* out = G' a. */
static inline void cone_transposed(double mu, const double a[2], double out[2])
{
    out[0] = mu > 0 ? mu * (a[0] + a[1]) : a[0];
    out[1] = mu > 0 ? a[1] - a[0] : 0;
}

/* out = G'^-1 (vn, vt). */
static inline void cone_transposed_inverse(double mu, double vn, double vt, double out[2])
{
    out[0] = mu > 0 ? vn / (2 * mu) - vt / 2 : vn;
    out[1] = mu > 0 ? vn / (2 * mu) + vt / 2 : 0;
}

/* The share of the step (dside, dpress) after which the first of them is zero, `length` at most. */
static inline double cone_reach(double mu, const double side[2], const double dside[2], const double press[2],
                                const double dpress[2], double length)
{
    for (int k = 0; k < cone_sides(mu); k++) {
        double to_side = dside[k] < 0 ? -side[k] / dside[k] : length;
        double to_press = dpress[k] < 0 ? -press[k] / dpress[k] : length;
        length = to_side < length ? to_side : length;
        length = to_press < length ? to_press : length;
    }
    return length;
}

#endif
