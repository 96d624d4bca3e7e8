#include "pipeline/packing/grains.h"

const char *const GRAIN_FLAG_NAMES[32] = {
    [0] = "cut",          [1] = "weak_edge",      [2] = "not_converged", [3] = "low_zncc",    [4] = "lost",
    [5] = "ambiguous",    [6] = "out_of_view",    [7] = "saturated",     [8] = "no_contrast", [9] = "not_finite",
    [10] = "overlapping", [11] = "outside_range", [16] = "fixed",        [18] = "rattler",    [19] = "floating",
    [20] = "rescued",     [21] = "masked",        [22] = "flank",        [23] = "by_hand",    [24] = "speckled_fine",
    [25] = "vague",
};

#define DOUBLE(member, units, text) COLUMN(struct photo_grains, member, COLUMN_DOUBLE, units, text)
static const struct column photo_columns[] = {
    DOUBLE(x_px, "px", "centre, to the right"),
    DOUBLE(y_px, "px", "centre, downwards"),
    DOUBLE(radius_px, "px", "mean radius of the rim"),
    DOUBLE(angle, "rad", "rotation since the reference, counter-clockwise as seen"),
    DOUBLE(s_x, "px", "standard error of x_px; tracker: of the motion since the reference"),
    DOUBLE(s_y, "px", "standard error of y_px; tracker: of the motion since the reference"),
    DOUBLE(s_radius, "px", "standard error of radius_px"),
    DOUBLE(s_angle, "rad", "standard error of angle"),
    DOUBLE(shape_c, "px", "rim: cosine of twice the angle"),
    DOUBLE(shape_s, "px", "rim: sine of twice the angle"),
    DOUBLE(s_shape, "px", "standard error of shape_c and shape_s"),
    DOUBLE(zncc, "1", "zero-mean normalised cross-correlation with the reference"),
    DOUBLE(iterations, "1", "iterations of the refinement"),
    DOUBLE(x_seen_px, "px", "centre in this photo as it is, to the right"),
    DOUBLE(y_seen_px, "px", "centre in this photo as it is, downwards"),
    DOUBLE(angle_seen, "rad", "rotation since the reference in this photo as it is"),
    DOUBLE(x_ref_px, "px", "centre in the reference, corrected, to the right"),
    DOUBLE(y_ref_px, "px", "centre in the reference, corrected, downwards"),
    DOUBLE(s_x_ref, "px", "standard error of x_ref_px, constant through the series"),
    DOUBLE(s_y_ref, "px", "standard error of y_ref_px, constant through the series"),
    DOUBLE(dx_px, "px", "motion since the previous photo, to the right"),
    DOUBLE(dy_px, "px", "motion since the previous photo, downwards"),
    DOUBLE(dangle, "rad", "rotation since the previous photo"),
    COLUMN(struct photo_grains, flags, COLUMN_UINT32, "1", "bits 0-15: do not trust this row; 16-31: information"),
};
#undef DOUBLE

#define DOUBLE(member, units, text) COLUMN(struct grains, member, COLUMN_DOUBLE, units, text)
static const struct column si_columns[] = {
    DOUBLE(x, "m", "centre, to the right"),
    DOUBLE(y, "m", "centre, upwards"),
    DOUBLE(radius, "m", "mean radius of the rim"),
    DOUBLE(angle, "rad", "rotation since the reference, counter-clockwise"),
    DOUBLE(s_x, "m", "standard error of the motion of this photo alone, x"),
    DOUBLE(s_y, "m", "standard error of the motion of this photo alone, y"),
    DOUBLE(s_angle, "rad", "standard error of angle"),
    DOUBLE(s_x_ref, "m", "standard error of the reference position, constant through the series, x"),
    DOUBLE(s_y_ref, "m", "standard error of the reference position, constant through the series, y"),
    DOUBLE(s_radius, "m", "standard error of radius, constant through the series"),
    DOUBLE(shape_c, "m", "rim: cosine of twice the angle"),
    DOUBLE(shape_s, "m", "rim: sine of twice the angle"),
    DOUBLE(s_shape, "m", "standard error of shape_c and shape_s"),
    DOUBLE(mass, "kg", "mass (without a density: proportional to radius squared)"),
    DOUBLE(inertia, "kg m2", "moment of inertia about the centre"),
    DOUBLE(load_x, "N", "force from outside on the grain, to the right"),
    DOUBLE(load_y, "N", "force from outside on the grain, upwards"),
    DOUBLE(load_m, "N m", "moment from outside on the grain, counter-clockwise"),
    COLUMN(struct grains, flags, COLUMN_UINT32, "1", "bits 0-15: do not trust this row; 16-31: information"),
};
#undef DOUBLE

const struct table_kind PHOTO_GRAINS = {photo_columns, sizeof photo_columns / sizeof *photo_columns,
                                        offsetof(struct photo_grains, count), GRAIN_FLAG_NAMES};
const struct table_kind GRAINS = {si_columns, sizeof si_columns / sizeof *si_columns, offsetof(struct grains, count),
                                  GRAIN_FLAG_NAMES};
