/* Lens distortion: eight parameters in Brown's form (Brown 1971), from what is seen to what a lens without distortion
 * would show, in px:
 *
 *     d = seen - centre, r = |d|
 *     corrected_x = centre_x + d_x (1 + K1 r^2 + K2 r^4 + K3 r^6) + (P1 (r^2 + 2 d_x^2) + 2 P2 d_x d_y)(1 + P3 r^2)
 *     corrected_y = centre_y + d_y (1 + K1 r^2 + K2 r^4 + K3 r^6) + (2 P1 d_x d_y + P2 (r^2 + 2 d_y^2))(1 + P3 r^2)
 *
 * A lens file (the scene's "lens") is
 *     {"schema": "film.lens/1", "map": "corrected from seen", "centre_px": [x, y], "K": [K1, K2, K3], "P": [P1, P2,
 * P3]} */
#ifndef PIPELINE_LENS_H
#define PIPELINE_LENS_H

#include "pipeline/numbers/geometry.h"

struct lens {
    struct vec centre; /* px */
    double k[3];       /* px^-2, px^-4, px^-6 */
    double p[3];       /* px^-1, px^-1, px^-2 */
};

int lens_read(const char *path, struct lens *lens);

struct vec lens_corrected(const struct lens *lens, struct vec seen);
/* The inverse, by Newton's method to 1e-10 px; NaN where the map folds back on itself. */
struct vec lens_seen(const struct lens *lens, struct vec corrected);
/* Derivatives of lens_corrected(): jacobian[a][b] = d corrected_a / d seen_b. */
void lens_jacobian(const struct lens *lens, struct vec seen, double jacobian[2][2]);

/* A straight edge, whose ends are seen at a and b, is seen bent: its largest distance from the chord, px. */
double lens_bend(const struct lens *lens, struct vec a, struct vec b);

#endif
