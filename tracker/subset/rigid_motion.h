/* A rigid motion in the photo: x right, y down, the angle counter-clockwise as seen. A point at (dx, dy) from the
 * centre of its grain in the reference is found at
 *
 *     x = cx + u + cos(angle) dx + sin(angle) dy
 *     y = cy + v - sin(angle) dx + cos(angle) dy
 *
 * Discs have no angle that is better than others: an angle is any real number, a grain that rolls on collects whole
 * turns. */
#ifndef TRACKER_RIGID_MOTION_H
#define TRACKER_RIGID_MOTION_H

#include <math.h>

struct motion {
    double u, v;  /* px, of the centre */
    double angle; /* rad */
};

/* How far two motions are turned against each other: whole turns do not count. */
static inline double motion_turn(const struct motion *a, const struct motion *b)
{
    return fabs(remainder(a->angle - b->angle, 2 * M_PI));
}

/* W(motion) o W(step)^-1: the update of inverse composition (Baker and Matthews 2004, eq. 15) for rigid warps. */
static inline struct motion motion_compose_inverse(struct motion motion, struct motion step)
{
    /* The step acts first, about the same centre: W(m) o W(s)^-1 turns by the difference of the angles, and takes the
     * step's shift, turned, off the motion's. */
    double angle = motion.angle - step.angle, c = cos(angle), s = sin(angle);
    return (struct motion){motion.u - (c * step.u + s * step.v), motion.v - (-s * step.u + c * step.v), angle};
}

#endif
