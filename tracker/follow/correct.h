/* From what is seen to what a lens without distortion would show (pipeline/scene/lens.h). */
#ifndef TRACKER_CORRECT_H
#define TRACKER_CORRECT_H

#include "pipeline/scene/lens.h"
#include "tracker/search/icgn.h"

/* A body in this photo with the lens undone. */
struct corrected {
    double x_ref, y_ref; /* px, in the reference */
    double x, y, angle;  /* px, rad: now, and turned since the reference */
    double xx, yy, aa;   /* variances of the motion */
};

/* `lens` NULL: what is seen. The angle loses the difference of the lens's own rotations here and in the reference. */
struct corrected correct_lens(const struct lens *lens, const struct shape *shape, const struct fit *fit);

/* A circle at (x, y) as seen: by how much it is larger when corrected, and the ellipse that it becomes (rim of
 * r(phi) = radius + shape_c cos 2 phi + shape_s sin 2 phi, in units of its radius). */
struct stretch {
    double magnification, shape_c, shape_s;
};
struct stretch correct_stretch(const struct lens *lens, double x, double y);

#endif
