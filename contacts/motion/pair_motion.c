/* Differences of two states. Along n the two centres come closer; across it the material points at the contact slide,
 * each carried by its grain's rotation times its arm. Errors: each photo's own, and those of the reference cancel since
 * both states were compared with the same one. */
#include "contacts/motion/pair_motion.h"

/* The second body: how its point at the contact moved, its old normal, and how far the centres came closer. */
struct partner_motion {
    struct vec moved, normal_before;
    double closed, spin; /* m; a_j theta_j, m */
    double variance_n, variance_t;
};

static double square(double value)
{
    return value * value;
}

static double turned(const struct grains *grains, const struct state_before *before, size_t k)
{
    return column_or_zero(grains->angle, k) - column_or_zero(before->angle, k);
}

/* Of a motion between two photos, from the errors of the motions since the reference: half of the smaller variance is
 * the noise of the reference photo, which is in both and drops out. */
static double between(const double *now, const double *before, size_t k)
{
    double a = square(column_or_zero(now, k)), b = square(column_or_zero(before, k));
    return a + b - fmin(a, b);
}

/* Variances of a grain's motion along n and t; arm: to the contact point. */
static void grain_variance(const struct grains *grains, const struct state_before *before, size_t k, struct vec n,
                           double arm, double *along_n, double *along_t)
{
    double x2 = between(grains->s_x, before->s_x, k), y2 = between(grains->s_y, before->s_y, k);
    double a2 = between(grains->s_angle, before->s_angle, k);
    *along_n += n.x * n.x * x2 + n.y * n.y * y2;
    *along_t += n.y * n.y * x2 + n.x * n.x * y2 + arm * arm * a2;
}

static struct partner_motion grain_partner(const struct grains *grains, const struct pair *pair,
                                           const struct state_before *before)
{
    size_t i = (size_t)pair->i, j = (size_t)pair->j;
    struct vec now = vec(grains->x[j], grains->y[j]);
    struct vec branch_before = vec_sub(before->at[j], before->at[i]);
    struct vec branch = vec_sub(now, vec(grains->x[i], grains->y[i]));
    double arm = vec_norm(vec_sub(now, pair->at));
    struct partner_motion partner = {.moved = vec_sub(now, before->at[j]),
                                     .normal_before = vec_unit(branch_before),
                                     .closed = vec_norm(branch_before) - vec_norm(branch),
                                     .spin = arm * turned(grains, before, j)};
    grain_variance(grains, before, j, pair->n, arm, &partner.variance_n, &partner.variance_t);
    return partner;
}

static struct partner_motion disc_partner(const struct grains *grains, const struct walls *walls, size_t w,
                                          const struct pair *pair, const struct state_before *before)
{
    size_t i = (size_t)pair->i;
    struct vec now = vec(walls->x0[w], walls->y0[w]), was = vec(before->walls->x0[w], before->walls->y0[w]);
    struct vec branch_before = vec_sub(was, before->at[i]);
    double distance = vec_norm(vec_sub(now, vec(grains->x[i], grains->y[i])));
    return (struct partner_motion){.moved = vec_sub(now, was),
                                   .normal_before = vec_unit(branch_before),
                                   .closed = vec_norm(branch_before) - distance};
}

static struct partner_motion segment_partner(const struct grains *grains, const struct walls *walls, size_t w,
                                             const struct pair *pair, const struct state_before *before)
{
    size_t i = (size_t)pair->i;
    struct vec is = wall_direction(walls, w), was = wall_direction(before->walls, w);
    struct vec middle = wall_middle(walls, w), middle_before = wall_middle(before->walls, w);
    double angle = atan2(vec_cross(was, is), vec_dot(was, is));
    struct vec arm = vec_sub(pair->at, middle), arm_before = vec_rotate(arm, -angle);
    struct vec inward_before = wall_inward(before->walls, w);
    double depth = -vec_dot(vec_sub(vec(grains->x[i], grains->y[i]), middle), pair->n);
    double depth_before = vec_dot(vec_sub(before->at[i], middle_before), inward_before);
    return (struct partner_motion){.moved = vec_add(vec_sub(middle, middle_before), vec_sub(arm, arm_before)),
                                   .normal_before = vec_scale(-1, inward_before),
                                   .closed = depth_before - depth};
}

static struct partner_motion partner_motion(const struct grains *grains, const struct walls *walls,
                                            const struct pair *pair, const struct state_before *before)
{
    if ((size_t)pair->j < grains->count)
        return grain_partner(grains, pair, before);
    size_t w = (size_t)pair->j - grains->count;
    struct partner_motion partner = wall_is_disc(walls, w) ? disc_partner(grains, walls, w, pair, before)
                                                           : segment_partner(grains, walls, w, pair, before);
    partner.variance_n = partner.variance_t = square(before->s_wall[w]);
    return partner;
}

struct contact_motion contact_motion(const struct grains *grains, const struct walls *walls, const struct pair *pair,
                                     const struct state_before *before)
{
    size_t i = (size_t)pair->i;
    struct vec centre = vec(grains->x[i], grains->y[i]);
    struct partner_motion partner = partner_motion(grains, walls, pair, before);
    struct vec relative = vec_sub(partner.moved, vec_sub(centre, before->at[i]));
    struct vec n = vec_unit(vec_add(pair->n, partner.normal_before));
    double arm = vec_norm(vec_sub(pair->at, centre));
    double variance_n = partner.variance_n, variance_t = partner.variance_t;
    grain_variance(grains, before, i, n, arm, &variance_n, &variance_t);
    return (struct contact_motion){.un = vec_dot(relative, n),
                                   .ut =
                                       vec_dot(relative, vec_turn(n)) - arm * turned(grains, before, i) - partner.spin,
                                   .s_un = sqrt(variance_n),
                                   .s_ut = sqrt(variance_t),
                                   .overlap_before = pair->overlap - partner.closed};
}
