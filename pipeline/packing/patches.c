#include "pipeline/packing/patches.h"

#include "pipeline/packing/grains.h"

#define DOUBLE(member, units, text) COLUMN(struct patches, member, COLUMN_DOUBLE, units, text)
static const struct column columns[] = {
    COLUMN(struct patches, kind, COLUMN_NAME, "1", "drift (fixed paper) or wall (marker)"),
    COLUMN(struct patches, name, COLUMN_NAME, "1", "the wall that carries the marker; paper"),
    DOUBLE(x_px, "px", "centre in this photo, to the right"),
    DOUBLE(y_px, "px", "centre in this photo, downwards"),
    DOUBLE(dx_px, "px", "motion since the reference, to the right"),
    DOUBLE(dy_px, "px", "motion since the reference, downwards"),
    DOUBLE(angle, "rad", "rotation since the reference, counter-clockwise as seen"),
    DOUBLE(s_x, "px", "standard error of dx_px"),
    DOUBLE(s_y, "px", "standard error of dy_px"),
    DOUBLE(s_angle, "rad", "standard error of angle"),
    DOUBLE(zncc, "1", "zero-mean normalised cross-correlation with the reference"),
    COLUMN(struct patches, flags, COLUMN_UINT32, "1", "bits 0-15: do not trust this row; 16-31: information"),
};
#undef DOUBLE

const struct table_kind PATCHES = {columns, sizeof columns / sizeof *columns, offsetof(struct patches, count),
                                   GRAIN_FLAG_NAMES};
