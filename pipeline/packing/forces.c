#include "pipeline/packing/forces.h"

#include <math.h>
#include <string.h>

const char *const VERDICT_NAMES[] = {"", "balanced", "doubtful", "void", NULL};

#define DOUBLE(member, units, text) COLUMN(struct contact_forces, member, COLUMN_DOUBLE, units, text)
static const struct column force_columns[] = {
    DOUBLE(fn, "N", "normal force on j from i, compression positive"),
    DOUBLE(ft, "N", "tangential force on j from i, along the normal turned by +90 degrees"),
    DOUBLE(s_fn, "N", "standard deviation of fn"),
    DOUBLE(s_ft, "N", "standard deviation of ft"),
    DOUBLE(fn_min, "N", "lower end of the stated 90 % interval of fn"),
    DOUBLE(fn_max, "N", "upper end of the stated 90 % interval of fn"),
    DOUBLE(fn_low, "N", "smallest fn of all admissible states"),
    DOUBLE(fn_high, "N", "largest fn of all admissible states"),
    COLUMN(struct contact_forces, status, COLUMN_UINT32, "1", "0 open, 1 stick, 2 slip, 3 not used"),
};
#undef DOUBLE

static const struct column residual_columns[] = {
    COLUMN(struct residuals, residual_x, COLUMN_DOUBLE, "N", "unbalanced force on the grain, to the right"),
    COLUMN(struct residuals, residual_y, COLUMN_DOUBLE, "N", "unbalanced force on the grain, upwards"),
    COLUMN(struct residuals, residual_m, COLUMN_DOUBLE, "N m", "unbalanced moment on the grain, counter-clockwise"),
};

static const struct column ray_columns[] = {
    COLUMN(struct rays, ray_x, COLUMN_DOUBLE, "1",
           "motion of the grain that proves the loads infeasible, to the right"),
    COLUMN(struct rays, ray_y, COLUMN_DOUBLE, "1", "the same, upwards"),
    COLUMN(struct rays, ray_m, COLUMN_DOUBLE, "1", "the same, rotation times mean radius"),
};

static const struct column softest_columns[] = {
    COLUMN(struct softest, soft_x, COLUMN_DOUBLE, "1",
           "motion of the grain that meets the least resistance, to the right"),
    COLUMN(struct softest, soft_y, COLUMN_DOUBLE, "1", "the same, upwards"),
    COLUMN(struct softest, soft_m, COLUMN_DOUBLE, "1", "the same, rotation times mean radius"),
};

const struct table_kind CONTACT_FORCES = {force_columns, sizeof force_columns / sizeof *force_columns,
                                          offsetof(struct contact_forces, count), NULL};
const struct table_kind RESIDUALS = {residual_columns, sizeof residual_columns / sizeof *residual_columns,
                                     offsetof(struct residuals, count), NULL};

const struct table_kind RAYS = {ray_columns, sizeof ray_columns / sizeof *ray_columns, offsetof(struct rays, count),
                                NULL};

const struct table_kind SOFTEST = {softest_columns, sizeof softest_columns / sizeof *softest_columns,
                                   offsetof(struct softest, count), NULL};

void forces_free(struct forces *forces)
{
    table_free(&CONTACT_FORCES, &forces->contact);
    table_free(&RESIDUALS, &forces->residual);
    table_free(&RAYS, &forces->ray);
    table_free(&SOFTEST, &forces->softest);
    memset(forces, 0, sizeof *forces);
}

double forces_mean(const double *fn, size_t count, size_t apart, size_t *loaded)
{
    double sum = 0;
    size_t carry = 0;
    for (size_t c = 0; c < count; c++)
        if (fn[c * apart] > 0) {
            sum += fn[c * apart];
            carry++;
        }
    if (loaded)
        *loaded = carry;
    return carry ? sum / (double)carry : NAN;
}
