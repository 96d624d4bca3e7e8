/* A rigid body of some size through a smooth map: its centre goes through the map, its covariance through the map's
 * Jacobian, its angle by the rotation in the Jacobian (the polar decomposition of a 2 x 2 matrix: atan2 of its skew
 * over its trace), its rim by magnification and stretch. Bending of the map within a grain is left out: a lens of some
 * px over the photo bends by 1e-3 px over a grain. */
#include "tracker/follow/correct.h"

/* Rotation (counter-clockwise as seen, y down) that a map with this Jacobian gives to a small body. */
static double turn_of(double j[2][2])
{
    return atan2(j[0][1] - j[1][0], j[0][0] + j[1][1]);
}

struct corrected correct_lens(const struct lens *lens, const struct shape *shape, const struct fit *fit)
{
    struct vec before = vec(shape->cx, shape->cy), now = vec(shape->cx + fit->motion.u, shape->cy + fit->motion.v);
    struct corrected body = {before.x,
                             before.y,
                             now.x,
                             now.y,
                             fit->motion.angle,
                             fit->covariance[0][0],
                             fit->covariance[1][1],
                             fit->covariance[2][2]};
    double j_before[2][2], j[2][2];
    if (!lens)
        return body;
    lens_jacobian(lens, before, j_before);
    lens_jacobian(lens, now, j);
    before = lens_corrected(lens, before);
    now = lens_corrected(lens, now);
    body.x_ref = before.x;
    body.y_ref = before.y;
    body.x = now.x;
    body.y = now.y;
    body.angle += turn_of(j) - turn_of(j_before);
    const double(*c)[3] = fit->covariance;
    body.xx = j[0][0] * j[0][0] * c[0][0] + 2 * j[0][0] * j[0][1] * c[0][1] + j[0][1] * j[0][1] * c[1][1];
    body.yy = j[1][0] * j[1][0] * c[0][0] + 2 * j[1][0] * j[1][1] * c[0][1] + j[1][1] * j[1][1] * c[1][1];
    return body;
}

struct stretch correct_stretch(const struct lens *lens, double x, double y)
{
    double j[2][2];
    if (!lens)
        return (struct stretch){1, 0, 0};
    lens_jacobian(lens, vec(x, y), j);
    /* J = magnification (1 + E), E symmetric and without trace to first order, y down: a rim r(phi), phi
     * counter-clockwise as seen, gets the second harmonic ((J_xx - J_yy) / 2, -(J_xy + J_yx) / 2). */
    double magnification = sqrt(fabs(j[0][0] * j[1][1] - j[0][1] * j[1][0]));
    return (struct stretch){magnification, (j[0][0] - j[1][1]) / 2, -(j[0][1] + j[1][0]) / 2};
}
