/* The line of a wall found from the grains that lie on it. The outermost rims of a side pile up on the wall exactly as
 * overlaps pile up at zero between grains, so the density of pair_statistics.h, read as a likelihood of the line's
 * offset and tilt, is sharp at the wall: with n touching grains of mean overlap m the offset is known to about m / n.
 * How hard this wall is pressed is not known: the scale of its overlaps is integrated over.
 * It is multiplied by a Gaussian prior (the frame's corners as given in the scene, or the predicted line), and the
 * mean and standard deviation of the product over a grid that is refined where the weight is are the line and its
 * errors. Without a grain near the line the prior stays. */
#ifndef CONTACTS_SUPPORT_H
#define CONTACTS_SUPPORT_H

#include "contacts/radii/pair_statistics.h"
#include "pipeline/numbers/geometry.h"
#include "pipeline/packing/grains.h"

struct wall_line {
    struct vec middle, along; /* m, unit vector; the interior is on the left */
    double half_length;       /* m: to the ends of the segment, about */
    double s_offset, s_angle; /* m, rad: errors along the normal at the middle, and of the direction */
};

/* How rims near a wall are spread: of grains that are held, and of idle ones (NULL: none is), which lie at zero when
 * they touch the wall at all. */
struct rim_statistics {
    const struct pair_statistics *bearing, *idle_pairs;
    const unsigned char *idle;
};

static inline struct vec wall_line_inward(const struct wall_line *line)
{
    return vec_turn(line->along);
}

/* Move the line outwards by `offset` and turn it so that the end of positive arm moves out by tilt per metre. */
void wall_line_shift(struct wall_line *line, double offset, double tilt);

/* Refine the line with the grains at these positions (NULL: where the table has them); its errors are the prior's. */
int support_fit(const struct grains *grains, const struct vec *positions, const struct rim_statistics *statistics,
                struct wall_line *line);

/* Predict where the line has moved from the motion of the grains that lay on it: the rigid motion whose rotation is the
 * median of those of the segments between two of them (as in Theil 1950, Sen 1968) and whose shift is the median of
 * theirs. The errors grow by what such a motion leaves open. */
int support_follow(const struct grains *grains, const struct vec *before, const struct rim_statistics *statistics,
                   struct wall_line *line);

#endif
