/* The rigid motion of a wall from the speckled markers that it carries. */
#ifndef CONTACTS_MARKER_H
#define CONTACTS_MARKER_H

#include "contacts/walls/support.h"
#include "pipeline/packing/patches.h"
#include "pipeline/scene/scene.h"

struct wall_motion {
    struct vec about, shift; /* m: mean position of the markers in the reference, their mean motion since */
    double angle;            /* rad */
    double s_shift, s_angle; /* m, rad */
};

/* 1 and the motion of the wall since the reference when it has a trusted marker, else 0. The rotation is the weighted
 * mean of what the markers' own rotations say and what their different motions say (two or more of them). */
int marker_motion(const struct scene *scene, const struct patches *patches, const char *wall,
                  struct wall_motion *motion);
/* Move a reference line; the errors of the motion add to those of the line. */
void marker_move(const struct wall_motion *motion, struct wall_line *line);

#endif
