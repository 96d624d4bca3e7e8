/* A photo and its averages over 2 x 2, 4 x 4 and 8 x 8 pixels: where a blind search looks first. */
#ifndef TRACKER_PYRAMID_H
#define TRACKER_PYRAMID_H

#include "pipeline/scene/photo.h"
#include "tracker/subset/rigid_motion.h"
#include "tracker/subset/subset.h"

enum { PYRAMID_LEVELS = 4 };

struct pyramid {
    int count;
    struct photo levels[PYRAMID_LEVELS]; /* level 0 is borrowed; 8-bit photos are 256 times brighter above it */
};

/* Levels until one is smaller than 16 px. The photo is borrowed and must outlive the pyramid. 0, or -1 when memory is
 * gone; nothing is to be freed then. */
int pyramid_build(const struct photo *photo, struct pyramid *pyramid);
void pyramid_free(struct pyramid *pyramid); /* accepts a zeroed struct */

/* Pixel i of level k holds the pixels 2^k i to 2^k i + 2^k - 1: position x is (x + 1/2) / 2^k - 1/2 there. */
static inline double pyramid_down(double x, int level)
{
    return ldexp(x + 0.5, -level) - 0.5;
}

static inline struct motion pyramid_motion_down(struct motion motion, int level)
{
    return (struct motion){ldexp(motion.u, -level), ldexp(motion.v, -level), motion.angle};
}

static inline struct motion pyramid_motion_up(struct motion motion, int level)
{
    return (struct motion){ldexp(motion.u, level), ldexp(motion.v, level), motion.angle};
}

static inline struct shape pyramid_shape(const struct shape *shape, int level)
{
    return (struct shape){.cx = pyramid_down(shape->cx, level),
                          .cy = pyramid_down(shape->cy, level),
                          .radius = ldexp(shape->radius, -level),
                          .half_w = ldexp(shape->half_w, -level),
                          .half_h = ldexp(shape->half_h, -level)};
}

#endif
