/* Relative motion at a contact between an earlier state and now (docs/theory.md section 1):
 *
 *     un = (U_j - U_i).n,   ut = (U_j - U_i).t - a_i theta_i - a_j theta_j,
 *
 * n the mean of the old and the new normal, t = n turned by +90 degrees, a the distances from the centres to the
 * contact point. A wall moves with its middle and turns about it. */
#ifndef CONTACTS_MOTION_H
#define CONTACTS_MOTION_H

#include "contacts/network/pair.h"

/* An earlier state of the same rows. */
struct state_before {
    const struct vec *at;              /* m: centres */
    const double *angle;               /* rad; NULL: 0 */
    const struct walls *walls;         /* the same rows as now */
    const double *s_x, *s_y, *s_angle; /* errors of the motion until then; NULL: exact */
    double s_wall[8];                  /* m: errors of the walls' motion from then until now */
};

struct contact_motion {
    double un, ut, s_un, s_ut; /* m */
    double overlap_before;     /* m: with today's rim radii */
};

/* Of one pair of this state, of two grains or of a grain and a wall (pair->j from grains->count on), since the state
 * `before`, which holds the same rows. NaN where a position was not known. */
struct contact_motion contact_motion(const struct grains *grains, const struct walls *walls, const struct pair *pair,
                                     const struct state_before *before);

#endif
