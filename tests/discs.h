/* Photos drawn by the tests themselves: discs and ellipses with exact pixel coverage along 64 chords per pixel row,
 * each with its own grey, dots and rings, blurred by a Gaussian, with noise. Independent of simulation/render. */
#ifndef TESTS_DISCS_H
#define TESTS_DISCS_H

#include <stddef.h>
#include <stdint.h>

#include "pipeline/scene/photo.h"

struct disc {
    double x, y, radius; /* px */
    double c2, s2;       /* rim: radius + c2 cos 2t + s2 sin 2t, t from x towards y */
    double grey;         /* of its face */
};

struct scenery {
    double void_grey;
    double blur;  /* px: standard deviation of the point spread */
    double noise; /* grey levels */
    double dots;  /* share of every face covered by black and white dots */
    double rings; /* grey levels: amplitude of the growth rings */
    uint64_t seed;
};

/* Draw onto a black photo of that size. */
int discs_draw(int width, int height, const struct disc *discs, size_t count, const struct scenery *scenery,
               struct photo *photo);
/* Discs of the given radii seated on each other from the middle outwards: every disc touches two others, none
 * overlap; all at least `margin` inside the photo (unless negative). Returns how many. grey, c2, s2 stay 0. */
size_t discs_pack(int width, int height, const double *radii, size_t radius_count, double margin, uint64_t seed,
                  struct disc *discs, size_t room);

#endif
