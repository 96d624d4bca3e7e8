/* What a blurred edge looks like, as functions of t = rho / s (distance outside the rim over blur), from a table: the
 * fit asks for them at every pixel of every rim. */
#ifndef FINDGRAINS_EDGE_PROFILE_H
#define FINDGRAINS_EDGE_PROFILE_H

/* Depths below the rim, in blurs, where the grain's own level is allowed to change (edge_fit.h). */
#define PROFILE_NEAR 1.25
#define PROFILE_DEEP 3.0

enum { PROFILE_PER_UNIT = 256, PROFILE_REACH = 8 };

struct profile {
    double step;     /* Phi(-t) */
    double bell;     /* phi(t): the step's derivative */
    double near_rim; /* the part of the step between the rim and the near depth */
    double deeper;   /* the part between the near and the deep depth */
};

/* Fills the table, once, whichever thread comes first; before the first profile_at(). */
void profile_prepare(void);

extern struct profile profile_table[2 * PROFILE_REACH * PROFILE_PER_UNIT + 2];

/* Linear interpolation: right to 1e-6. */
static inline struct profile profile_at(double t)
{
    double at = (t + PROFILE_REACH) * PROFILE_PER_UNIT;
    at = at < 0 ? 0 : at > 2 * PROFILE_REACH * PROFILE_PER_UNIT ? 2 * PROFILE_REACH * PROFILE_PER_UNIT : at;
    int k = (int)at;
    double f = at - k;
    const struct profile *a = &profile_table[k], *b = a + 1;
    return (struct profile){a->step + f * (b->step - a->step), a->bell + f * (b->bell - a->bell),
                            a->near_rim + f * (b->near_rim - a->near_rim), a->deeper + f * (b->deeper - a->deeper)};
}

#endif
