#include "pipeline/packing/contacts.h"

const char *const CONTACT_FLAG_NAMES[32] = {
    [0] = "not_finite", [16] = "new", [17] = "candidate", [18] = "promoted", [19] = "wall", [20] = "opened",
};

#define DOUBLE(member, units, text) COLUMN(struct contacts, member, COLUMN_DOUBLE, units, text)
static const struct column columns[] = {
    COLUMN(struct contacts, i, COLUMN_INT64, "1", "grain"),
    COLUMN(struct contacts, j, COLUMN_INT64, "1", "grain > i, or number of grains + wall"),
    DOUBLE(nx, "1", "unit normal from i to j, to the right"),
    DOUBLE(ny, "1", "unit normal from i to j, upwards"),
    DOUBLE(x, "m", "contact point (middle of the overlap), to the right"),
    DOUBLE(y, "m", "contact point (middle of the overlap), upwards"),
    DOUBLE(overlap, "m", "sum of the radii less the distance; negative: a gap"),
    DOUBLE(s_overlap, "m", "standard error of overlap"),
    DOUBLE(probability, "1", "that the true overlap is positive"),
    DOUBLE(un, "m", "relative motion of j since the reference, along the normal"),
    DOUBLE(ut, "m", "relative motion of j since the reference, along the tangent, rotations included"),
    DOUBLE(dun, "m", "relative motion of j since the previous state, along the normal"),
    DOUBLE(dut, "m", "relative motion of j since the previous state, along the tangent, rotations included"),
    DOUBLE(s_un, "m", "standard error of un"),
    DOUBLE(s_ut, "m", "standard error of ut"),
    DOUBLE(s_dun, "m", "standard error of dun"),
    DOUBLE(s_dut, "m", "standard error of dut"),
    COLUMN(struct contacts, flags, COLUMN_UINT32, "1", "bits 0-15: do not trust this row; 16-31: information"),
};
#undef DOUBLE

const struct table_kind CONTACTS = {columns, sizeof columns / sizeof *columns, offsetof(struct contacts, count),
                                    CONTACT_FLAG_NAMES};
