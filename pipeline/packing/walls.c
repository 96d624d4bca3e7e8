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

/* The component along the axis nearest to the normal must be given; a wall that is not quite upright or level, as a
 * fitted one never is, takes next to nothing of the other. */
static int load_given(double normal, double component)
{
    return isfinite(component) || fabs(normal) < 0.7;
}

double wall_load(const struct walls *walls, size_t w)
{
    struct vec in = wall_inward(walls, w);
    if (wall_is_disc(walls, w) || !load_given(in.x, walls->fx[w]) || !load_given(in.y, walls->fy[w]))
        return NAN;
    return (isfinite(walls->fx[w]) ? in.x * walls->fx[w] : 0) + (isfinite(walls->fy[w]) ? in.y * walls->fy[w] : 0);
}

static int wall_loaded(const struct walls *walls, const char *name)
{
    long w = walls_find(walls, name);
    return w >= 0 && isfinite(wall_load(walls, (size_t)w));
}

int wall_moves(const struct walls *walls, size_t w)
{
    if (!isfinite(wall_load(walls, w)))
        return 0;
    if (!strncmp(walls->name[w], "left", NAME_LENGTH))
        return !wall_loaded(walls, "right");
    if (!strncmp(walls->name[w], "bottom", NAME_LENGTH))
        return !wall_loaded(walls, "top");
    return 1;
}
