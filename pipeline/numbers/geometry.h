/* Small plane vectors and the frame of a contact (docs/theory.md section 1): the normal n points from i to j, the
 * tangent t is n turned by +90 degrees, counter-clockwise is positive, y is up. */
#ifndef PIPELINE_GEOMETRY_H
#define PIPELINE_GEOMETRY_H

#include <math.h>

struct vec {
    double x, y;
};

static inline struct vec vec(double x, double y)
{
    return (struct vec){x, y};
}

static inline struct vec vec_add(struct vec a, struct vec b)
{
    return vec(a.x + b.x, a.y + b.y);
}

static inline struct vec vec_sub(struct vec a, struct vec b)
{
    return vec(a.x - b.x, a.y - b.y);
}

static inline struct vec vec_scale(double s, struct vec a)
{
    return vec(s * a.x, s * a.y);
}

static inline double vec_dot(struct vec a, struct vec b)
{
    return a.x * b.x + a.y * b.y;
}

/* The z component of a x b. */
static inline double vec_cross(struct vec a, struct vec b)
{
    return a.x * b.y - a.y * b.x;
}

static inline double vec_norm(struct vec a)
{
    return hypot(a.x, a.y);
}

/* a turned by +90 degrees. */
static inline struct vec vec_turn(struct vec a)
{
    return vec(-a.y, a.x);
}

static inline struct vec vec_rotate(struct vec a, double angle)
{
    double c = cos(angle), s = sin(angle);
    return vec(c * a.x - s * a.y, s * a.x + c * a.y);
}

/* tensor += a b' (the dyad: element (x, y) is a.x b.y). */
static inline void tensor_add(double tensor[2][2], struct vec a, struct vec b)
{
    tensor[0][0] += a.x * b.x;
    tensor[0][1] += a.x * b.y;
    tensor[1][0] += a.y * b.x;
    tensor[1][1] += a.y * b.y;
}

static inline void tensor_scale(double tensor[2][2], double factor)
{
    for (int a = 0; a < 2; a++)
        for (int b = 0; b < 2; b++)
            tensor[a][b] *= factor;
}

/* a / |a|; the zero vector stays zero. */
static inline struct vec vec_unit(struct vec a)
{
    double norm = vec_norm(a);
    return norm > 0 ? vec_scale(1 / norm, a) : a;
}

/* Where the line through p along u meets that through q along v; not finite for parallels. */
static inline struct vec vec_meet(struct vec p, struct vec u, struct vec q, struct vec v)
{
    return vec_add(p, vec_scale(vec_cross(vec_sub(q, p), v) / vec_cross(u, v), u));
}

#endif
