#include "pipeline/packing/stress.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "pipeline/speak/error.h"

/* Area times the rods' length, m3; the area, m2, where it is not known: stresses are then N/m. */
static double volume(const struct packing *packing, double area)
{
    return isnan(packing->length_m) ? area : area * packing->length_m;
}

void stress_weber(const struct packing *packing, const double *fn, const double *ft, double area, double sigma[2][2])
{
    const struct contacts *contacts = &packing->contacts;
    memset(sigma, 0, 4 * sizeof sigma[0][0]);
    for (size_t c = 0; c < contacts->count; c++) {
        struct vec n = vec(contacts->nx[c], contacts->ny[c]);
        struct vec force = vec_add(vec_scale(fn[c], n), vec_scale(ft[c], vec_turn(n)));
        if (!isnan(force.x) && !isnan(force.y))
            tensor_add(sigma, force, packing_branch(packing, c));
    }
    tensor_scale(sigma, 1 / volume(packing, area));
}

/* ---- applied stress ---- */

/* The walls whose load along their normal is not known, told apart by the axis nearest to that normal. */
struct reactions {
    size_t count[2];
    size_t wall[2];    /* the last one of each axis */
    struct vec sum;    /* of everything that is known */
    struct vec middle; /* of the specimen */
};

/* 0: the normal is nearest to x, 1: to y. */
static int wall_axis(const struct walls *walls, size_t w)
{
    struct vec n = wall_inward(walls, w);
    return fabs(n.y) > fabs(n.x);
}

/* The load of a wall whose normal part is known; a tangential part that is not known counts as none. */
static int known_load(const struct walls *walls, size_t w, struct vec *load)
{
    double x = walls->fx[w], y = walls->fy[w];
    if (isnan(wall_axis(walls, w) ? y : x))
        return 0;
    *load = vec(isnan(x) ? 0 : x, isnan(y) ? 0 : y);
    return 1;
}

static void add_body_loads(const struct grains *grains, struct vec middle, struct vec *sum, double moment[2][2])
{
    for (size_t k = 0; k < grains->count && grains->load_x && grains->load_y; k++) {
        struct vec load = vec(grains->load_x[k], grains->load_y[k]), at = vec(grains->x[k], grains->y[k]);
        if (!isfinite(load.x) || !isfinite(load.y) || !isfinite(at.x) || !isfinite(at.y))
            continue;
        *sum = vec_add(*sum, load);
        tensor_add(moment, load, vec_sub(at, middle));
    }
}

/* Add what is known to `moment` = sum F_a x_b, and note what is not. */
static struct reactions add_known(const struct packing *packing, double moment[2][2])
{
    const struct walls *walls = &packing->walls;
    struct reactions r = {0};
    size_t segments = 0;
    for (size_t w = 0; w < walls->count; w++)
        if (!wall_is_disc(walls, w)) {
            r.middle = vec_add(r.middle, wall_middle(walls, w));
            segments++;
        }
    r.middle = vec_scale(1 / (double)segments, r.middle);
    for (size_t w = 0; w < walls->count; w++) {
        struct vec load;
        if (wall_is_disc(walls, w))
            continue;
        if (known_load(walls, w, &load)) {
            r.sum = vec_add(r.sum, load);
            tensor_add(moment, load, vec_sub(wall_middle(walls, w), r.middle));
        } else {
            int axis = wall_axis(walls, w);
            r.count[axis]++;
            r.wall[axis] = w;
        }
    }
    add_body_loads(&packing->grains, r.middle, &r.sum, moment);
    return r;
}

/* One unknown reaction per axis, along the wall's normal, follows from the balance of forces. With two on one axis
 * the other axis still balances by itself, as far as walls stand upright. */
static void add_reactions(const struct walls *walls, const struct reactions *r, double moment[2][2])
{
    struct vec n[2] = {vec(1, 0), vec(0, 1)};
    for (int axis = 0; axis < 2; axis++)
        if (r->count[axis] == 1)
            n[axis] = wall_inward(walls, r->wall[axis]);
    double determinant = vec_cross(n[0], n[1]);
    double size[2] = {-vec_cross(r->sum, n[1]) / determinant, -vec_cross(n[0], r->sum) / determinant};
    for (int axis = 0; axis < 2; axis++)
        if (r->count[axis] == 1)
            tensor_add(moment, vec_scale(size[axis], n[axis]), vec_sub(wall_middle(walls, r->wall[axis]), r->middle));
}

void stress_applied(const struct packing *packing, double area, double sigma[2][2])
{
    double moment[2][2] = {{0}};
    struct reactions r = add_known(packing, moment);
    add_reactions(&packing->walls, &r, moment);
    memcpy(sigma, moment, sizeof moment);
    for (int axis = 0; axis < 2; axis++)
        if (r.count[axis] > 1)
            sigma[axis][axis] = sigma[0][1] = sigma[1][0] = NAN;
    sigma[0][1] = sigma[1][0] = 0.5 * (sigma[0][1] + sigma[1][0]);
    tensor_scale(sigma, packing->walls.count ? -1 / volume(packing, area) : NAN);
}

/* ---- area ---- */

enum { HULL_POINTS_PER_RIM = 64 };

/* For the convex hull. */
static int by_x_then_y(const void *left, const void *right)
{
    const struct vec *a = left, *b = right;
    if (a->x != b->x)
        return a->x < b->x ? -1 : 1;
    return (a->y > b->y) - (a->y < b->y);
}

/* Twice the area of the triangle a b c; positive: counter-clockwise. */
static double turn(struct vec a, struct vec b, struct vec c)
{
    return vec_cross(vec_sub(b, a), vec_sub(c, a));
}

/* Area of the convex hull of sorted points (Andrew's monotone chain, 1979); hull has room for 2 count points. */
static double hull_area(const struct vec *points, size_t count, struct vec *hull)
{
    size_t size = 0;
    for (size_t k = 0; k < count; k++) {
        while (size >= 2 && turn(hull[size - 2], hull[size - 1], points[k]) <= 0)
            size--;
        hull[size++] = points[k];
    }
    size_t lower = size + 1;
    for (size_t k = count - 1; k-- > 0;) {
        while (size >= lower && turn(hull[size - 2], hull[size - 1], points[k]) <= 0)
            size--;
        hull[size++] = points[k];
    }
    double twice = 0; /* hull[size - 1] is hull[0] again; measured from there, so that far origins cost no digits */
    for (size_t k = 0; k + 1 < size; k++)
        twice += turn(hull[0], hull[k], hull[k + 1]);
    return 0.5 * twice;
}

/* Convex hull of the rims, each drawn as a polygon of equal area. */
static int rims_area(const struct grains *grains, double *area)
{
    const double step = 2 * M_PI / HULL_POINTS_PER_RIM, equal_area = sqrt(step / sin(step));
    size_t count = 0;
    struct vec *points = malloc(3 * (grains->count * HULL_POINTS_PER_RIM + 1) * sizeof *points);
    if (!points)
        return error_memory("the rims of the grains");
    for (size_t k = 0; k < grains->count; k++)
        for (int p = 0; p < HULL_POINTS_PER_RIM; p++) {
            double r = equal_area * grains->radius[k];
            struct vec point = vec(grains->x[k] + r * cos(p * step), grains->y[k] + r * sin(p * step));
            if (isfinite(point.x) && isfinite(point.y))
                points[count++] = point;
        }
    *area = NAN;
    if (count) {
        qsort(points, count, sizeof *points, by_x_then_y);
        *area = hull_area(points, count, points + count);
    }
    free(points);
    return 0;
}

int packing_area(const struct packing *packing, double *area)
{
    *area = walls_area(&packing->walls);
    return isnan(*area) ? rims_area(&packing->grains, area) : 0;
}

/* ---- overlaps and loads ---- */

double stress_overlaps_over_loads(const struct packing *packing, double kn)
{
    const struct contacts *contacts = &packing->contacts;
    double sum = 0, applied[2][2];
    for (size_t c = 0; c < contacts->count; c++)
        if (isfinite(contacts->overlap[c]) && !(contacts->flags && contacts->flags[c] & CONTACT_CANDIDATE))
            sum +=
                kn * contacts->overlap[c] * vec_dot(vec(contacts->nx[c], contacts->ny[c]), packing_branch(packing, c));
    stress_applied(packing, 1, applied); /* times the volume but for the length of the rods */
    double loads = (applied[0][0] + applied[1][1]) * volume(packing, 1);
    return loads > 0 ? sum / loads : NAN;
}
