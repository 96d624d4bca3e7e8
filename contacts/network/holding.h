/* Can the contacts of a grain hold it? Each contact pushes within its friction cone, so every set of contact forces is
 * a combination with weights >= 0 of two generators per contact, the cone's edges:
 *
 *     g = (-n + mu t, mu)  and  (-n - mu t, -mu)        (force, moment over the radius),
 *
 * n from the grain to the contact, t = n turned by +90 degrees. A grain with a load stands when such a combination is
 * the opposite of the load; one without can be squeezed when a combination that is not zero vanishes. Both are one
 * problem of non-negative least squares (Lawson and Hanson 1974, ch. 23) with three or four rows. Two contacts hold a
 * grain without load when the chord between them lies in both friction cones. */
#ifndef CONTACTS_HOLDING_H
#define CONTACTS_HOLDING_H

#include <stddef.h>

#include "pipeline/numbers/geometry.h"

struct hold {
    struct vec n; /* unit, from the grain's centre to the contact */
    double mu;    /* of this contact; NaN: not known, then any two contacts hold */
};

/* load: force and moment over the radius, any unit; all zero: none. More than HOLDS_MOST contacts always hold. */
enum { HOLDS_MOST = 16 };
int grain_is_held(const struct hold *holds, size_t count, struct vec load, double moment_over_radius);

#endif
