#include "pipeline/packing/walls.h"

#include <math.h>
#include <string.h>

#define DOUBLE(member, units, text) COLUMN(struct walls, member, COLUMN_DOUBLE, units, text)
static const struct column columns[] = {
    COLUMN(struct walls, name, COLUMN_NAME, "1", "top, bottom, left, right; corner discs top-left and so on"),
    DOUBLE(x0, "m", "start of the segment (centre of a corner disc), to the right"),
    DOUBLE(y0, "m", "start of the segment (centre of a corner disc), upwards"),
    DOUBLE(x1, "m", "end of the segment, to the right"),
    DOUBLE(y1, "m", "end of the segment, upwards"),
    DOUBLE(radius, "m", "radius of a corner disc; 0 for a segment"),
    DOUBLE(fx, "N", "force from outside on the wall, to the right; NaN: fixed"),
    DOUBLE(fy, "N", "force from outside on the wall, upwards; NaN: fixed"),
    DOUBLE(s_offset, "m", "standard error of the position along the normal"),
    DOUBLE(s_angle, "rad", "standard error of the direction"),
    DOUBLE(dx, "m", "motion of the middle since the previous state, to the right"),
    DOUBLE(dy, "m", "motion of the middle since the previous state, upwards"),
    DOUBLE(dangle, "rad", "rotation since the previous state"),
    COLUMN(struct walls, flags, COLUMN_UINT32, "1", "bits 0-15: do not trust this row; 16-31: information"),
};
#undef DOUBLE
static const char *const flag_names[32] = {[0] = "not_finite"};

const struct table_kind WALLS = {columns, sizeof columns / sizeof *columns, offsetof(struct walls, count), flag_names};

long walls_find(const struct walls *walls, const char *name)
{
    for (size_t w = 0; w < walls->count; w++)
        if (!strncmp(walls->name[w], name, NAME_LENGTH))
            return (long)w;
    return -1;
}

/* Where the lines of two segments meet; NaN when they are parallel. */
static struct vec meeting_point(const struct walls *walls, size_t a, size_t b)
{
    struct vec p = vec(walls->x0[a], walls->y0[a]), q = vec(walls->x0[b], walls->y0[b]);
    struct vec u = wall_direction(walls, a), v = wall_direction(walls, b);
    double determinant = vec_cross(u, v);
    if (determinant == 0)
        return vec(NAN, NAN);
    return vec_add(p, vec_scale(vec_cross(vec_sub(q, p), v) / determinant, u));
}

double walls_area(const struct walls *walls)
{
    static const char *const round[] = {"bottom", "right", "top", "left"};
    long w[4];
    struct vec corner[4];
    for (int k = 0; k < 4; k++)
        if ((w[k] = walls_find(walls, round[k])) < 0)
            return NAN;
    for (int k = 0; k < 4; k++)
        corner[k] = meeting_point(walls, (size_t)w[(k + 3) % 4], (size_t)w[k]);
    return 0.5 * vec_cross(vec_sub(corner[2], corner[0]), vec_sub(corner[3], corner[1]));
}
