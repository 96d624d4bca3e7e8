/* Weighted means with weights 1 / s^2; one that has no error counts 1. Where measurements of one rod scatter more than
 * they state, the error grows by the root of chi^2 / (n - 1) (Birge's ratio, Phys. Rev. 40 (1932) 207). */
#include "contacts/radii/average.h"

/* A weighted mean as it grows. */
struct mean {
    double weight, sum, square, count;
};

static void mean_add(struct mean *mean, double value, double error)
{
    if (!isfinite(value))
        return;
    double weight = error > 0 && isfinite(error) ? 1 / (error * error) : 1;
    mean->weight += weight;
    mean->sum += weight * value;
    mean->square += weight * value * value;
    mean->count++;
}

static double mean_value(const struct mean *mean)
{
    return mean->weight > 0 ? mean->sum / mean->weight : NAN;
}

static double mean_error(const struct mean *mean)
{
    double value = mean_value(mean), scatter = 1;
    if (mean->count > 1)
        scatter = fmax(1, (mean->square - mean->weight * value * value) / (mean->count - 1));
    return mean->weight > 0 ? sqrt(scatter / mean->weight) : NAN;
}

/* Photo m of the set: 0 is the one that is being looked at. */
static const struct photo_grains *photo_of(const struct contact_input *input, size_t m)
{
    return m ? input->more_radii[m - 1] : input->grains;
}

static int counts(const struct contact_input *input, size_t m, size_t k)
{
    const struct photo_grains *photo = photo_of(input, m);
    return m == 0 || !photo->flags || !(photo->flags[k] & GRAIN_DISTRUST);
}

/* Mean over the photos of one column of grain k; `which` picks it. */
enum column_of { RADIUS, SHAPE_C, SHAPE_S };

static struct mean mean_of(const struct contact_input *input, size_t k, enum column_of which)
{
    struct mean mean = {0};
    for (size_t m = 0; m <= input->more_count; m++) {
        const struct photo_grains *photo = photo_of(input, m);
        const double *values = which == RADIUS ? photo->radius_px : which == SHAPE_C ? photo->shape_c : photo->shape_s;
        const double *errors = which == RADIUS ? photo->s_radius : photo->s_shape;
        if (values && counts(input, m, k))
            mean_add(&mean, values[k], column_or_zero(errors, k));
    }
    return mean;
}

int average_rims(const struct contact_input *input, struct grains *grains)
{
    double scale = input->scene->scale;
    if (input->more_count && table_add(&GRAINS, grains, "s_radius"))
        return -1;
    for (size_t k = 0; k < grains->count; k++) {
        struct mean radius = mean_of(input, k, RADIUS);
        grains->radius[k] = scale * (input->more_count ? mean_value(&radius) : input->grains->radius_px[k]);
        if (!input->more_count)
            continue;
        grains->s_radius[k] = scale * mean_error(&radius);
        if (!grains->shape_c || !grains->shape_s)
            continue;
        struct mean c = mean_of(input, k, SHAPE_C), s = mean_of(input, k, SHAPE_S);
        grains->shape_c[k] = scale * mean_value(&c);
        grains->shape_s[k] = scale * mean_value(&s);
        if (grains->s_shape)
            grains->s_shape[k] = scale * mean_error(&c);
    }
    return 0;
}
