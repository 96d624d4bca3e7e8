/* Two lenses that differ by a shift, a rotation or a scale show the same world: such a part of a difference is taken
 * out (least squares over a grid of points) before the rest is measured. */
#include "calibration/lens/lens_map.h"

#include <string.h>

#include "pipeline/numbers/dense.h"

enum { MAP_STEPS = 12 };

/* Take the best rigid motion and scale (least squares) out of a field on a regular grid; returns the mean square per
 * component. */
static double without_similarity(const struct vec *place, struct vec *field, size_t count, double *largest)
{
    struct vec centre = {0, 0}, mean = {0, 0};
    double stretch = 0, turn = 0, arm = 0, square = 0;
    for (size_t k = 0; k < count; k++) {
        centre = vec_add(centre, vec_scale(1.0 / (double)count, place[k]));
        mean = vec_add(mean, vec_scale(1.0 / (double)count, field[k]));
    }
    for (size_t k = 0; k < count; k++) {
        struct vec d = vec_sub(place[k], centre);
        stretch += vec_dot(d, field[k]);
        turn += vec_cross(d, field[k]);
        arm += vec_dot(d, d);
    }
    *largest = 0;
    for (size_t k = 0; k < count; k++) {
        struct vec d = vec_sub(place[k], centre);
        struct vec rigid = vec_add(mean, vec_add(vec_scale(stretch / arm, d), vec_scale(turn / arm, vec_turn(d))));
        field[k] = vec_sub(field[k], rigid);
        square += vec_dot(field[k], field[k]) / (2 * (double)count);
        *largest = fmax(*largest, vec_norm(field[k]));
    }
    return square;
}

enum { MAP_POINTS = (MAP_STEPS + 1) * (MAP_STEPS + 1) };

static void map_places(int width, int height, struct vec place[MAP_POINTS])
{
    for (int k = 0; k < MAP_POINTS; k++)
        place[k] = vec((width - 1) * (k % (MAP_STEPS + 1)) / (double)MAP_STEPS,
                       (height - 1) * (k / (MAP_STEPS + 1)) / (double)MAP_STEPS);
}

double lens_difference(const struct lens *a, const struct lens *b, int width, int height, double *largest)
{
    struct vec place[MAP_POINTS], field[MAP_POINTS];
    double most;
    map_places(width, height, place);
    for (int k = 0; k < MAP_POINTS; k++)
        field[k] = vec_sub(lens_corrected(a, place[k]), lens_corrected(b, place[k]));
    double square = without_similarity(place, field, MAP_POINTS, &most);
    if (largest)
        *largest = most;
    return sqrt(square);
}

/* Standard error of the map: the covariance carried to the fields of its principal parts. With C = L L', the map's
 * mean variance is the sum over the columns of L of the mean square of their fields. */
double map_error(const struct problem *problem, const double *q, double covariance[LENS_UNKNOWNS][LENS_UNKNOWNS])
{
    struct vec place[MAP_POINTS], slopes[MAP_POINTS][LENS_UNKNOWNS], field[MAP_POINTS];
    double factor[LENS_UNKNOWNS * LENS_UNKNOWNS], total = 0, most;
    memcpy(factor, covariance, sizeof factor);
    if (dense_factorise(factor, LENS_UNKNOWNS, LENS_UNKNOWNS, 0))
        return NAN;
    map_places(problem->points->width, problem->points->height, place);
    for (int k = 0; k < MAP_POINTS; k++)
        slopes_of(problem, q, place[k], slopes[k]);
    for (int column = 0; column < LENS_UNKNOWNS; column++) {
        for (int k = 0; k < MAP_POINTS; k++) {
            field[k] = vec(0, 0);
            for (int a = column; a < LENS_UNKNOWNS; a++)
                field[k] = vec_add(field[k], vec_scale(factor[a * LENS_UNKNOWNS + column], slopes[k][a]));
        }
        total += without_similarity(place, field, MAP_POINTS, &most);
    }
    return sqrt(total);
}
