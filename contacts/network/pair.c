/* Overlaps by the rims' radii along the branch, R_i(n) + R_j(-n) - d. That is exact for circles; for ellipses it errs
 * by the square of the shape over the radius, since the normals then leave the branch. (A second harmonic has the same
 * radius along n and -n.) The variance is that of both rims and of both centres along n, each of which errs in the
 * reference and once more in this photo. */
#include "contacts/network/pair.h"

static double finite_or_zero(double value)
{
    return isfinite(value) ? value : 0;
}

static double square(double value)
{
    return value * value;
}

double rim_radius(const struct grains *grains, size_t k, struct vec n)
{
    double radius = grains->radius[k];
    if (!grains->shape_c || !grains->shape_s)
        return radius;
    double phi = atan2(n.y, n.x) - finite_or_zero(column_or_zero(grains->angle, k));
    return radius + finite_or_zero(grains->shape_c[k]) * cos(2 * phi) +
           finite_or_zero(grains->shape_s[k]) * sin(2 * phi);
}

double rim_variance(const struct grains *grains, size_t k, struct vec n)
{
    double across = square(finite_or_zero(column_or_zero(grains->s_x_ref, k))) +
                    square(finite_or_zero(column_or_zero(grains->s_x, k)));
    double along = square(finite_or_zero(column_or_zero(grains->s_y_ref, k))) +
                   square(finite_or_zero(column_or_zero(grains->s_y, k)));
    return square(finite_or_zero(column_or_zero(grains->s_radius, k))) +
           square(finite_or_zero(column_or_zero(grains->s_shape, k))) + n.x * n.x * across + n.y * n.y * along;
}

struct pair pair_of_grains(const struct grains *grains, size_t i, size_t j)
{
    struct vec a = vec(grains->x[i], grains->y[i]);
    struct vec branch = vec_sub(vec(grains->x[j], grains->y[j]), a);
    struct vec n = vec_unit(branch);
    double reach = rim_radius(grains, i, n);
    struct pair pair = {.i = (int64_t)i, .j = (int64_t)j, .n = n};
    pair.overlap = reach + rim_radius(grains, j, n) - vec_norm(branch);
    pair.s_overlap = sqrt(rim_variance(grains, i, n) + rim_variance(grains, j, n));
    pair.at = vec_add(a, vec_scale(reach - 0.5 * pair.overlap, n));
    return pair;
}

static struct pair pair_with_disc(const struct grains *grains, size_t i, const struct walls *walls, size_t wall)
{
    struct vec a = vec(grains->x[i], grains->y[i]);
    struct vec branch = vec_sub(vec(walls->x0[wall], walls->y0[wall]), a);
    struct vec n = vec_unit(branch);
    double reach = rim_radius(grains, i, n);
    struct pair pair = {.i = (int64_t)i, .j = (int64_t)(grains->count + wall), .n = n};
    pair.overlap = reach + walls->radius[wall] - vec_norm(branch);
    pair.s_overlap = sqrt(rim_variance(grains, i, n) + square(finite_or_zero(column_or_zero(walls->s_offset, wall))));
    pair.at = vec_add(a, vec_scale(reach - 0.5 * pair.overlap, n));
    return pair;
}

struct pair pair_with_wall(const struct grains *grains, size_t i, const struct walls *walls, size_t wall)
{
    if (wall_is_disc(walls, wall))
        return pair_with_disc(grains, i, walls, wall);
    struct vec inward = wall_inward(walls, wall), n = vec_scale(-1, inward);
    struct vec a = vec(grains->x[i], grains->y[i]);
    struct vec from_middle = vec_sub(a, wall_middle(walls, wall));
    double arm = vec_dot(from_middle, wall_direction(walls, wall));
    double reach = rim_radius(grains, i, n);
    struct pair pair = {.i = (int64_t)i, .j = (int64_t)(grains->count + wall), .n = n};
    pair.overlap = reach - vec_dot(from_middle, inward);
    pair.s_overlap = sqrt(rim_variance(grains, i, n) + square(finite_or_zero(column_or_zero(walls->s_offset, wall))) +
                          square(arm * finite_or_zero(column_or_zero(walls->s_angle, wall))));
    pair.at = vec_add(a, vec_scale(reach - 0.5 * pair.overlap, n));
    return pair;
}
