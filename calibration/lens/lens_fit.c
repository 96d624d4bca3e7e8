/* The lens is what makes a plate that only moves look bent. Unknowns: eight of the lens (lens_model.h) and three per
 * photo; the residual of a point is its corrected position less where the photo's motion carries the corrected
 * reference position. Marquardt's method (J. Soc. Indust. Appl. Math. 11 (1963) 431): the diagonal of the normal
 * equations times 1 + damping, a tenth of it after a step that lowers the sum of squares, ten times it after one that
 * does not.
 *
 * After each fit, points more than LENS_OUTLIER robust standard deviations off are left out (or come back), and it is
 * fitted again until none changes. The covariance is the inverse of the undamped matrix, times chi^2 per degree of
 * freedom where that exceeds 1. */
#include "calibration/lens/lens_fit.h"

#include <stdlib.h>
#include <string.h>

#include "calibration/lens/lens_map.h"
#include "pipeline/numbers/dense.h"
#include "pipeline/numbers/quantiles.h"
#include "pipeline/speak/error.h"

enum { ITERATIONS = 60 };

/* Always -1: motions that are too small or all alike do not tell the lens. */
static int singular(void)
{
    return error_input("lens: the equations of the plate are singular: take photos with larger motions");
}

/* Marquardt's damping of the diagonal until the sum of squares stands still. Leaves the factor of the last undamped
 * matrix in `matrix`. */
static int minimise(const struct problem *problem, double *q, double *matrix)
{
    const size_t n = problem->unknowns;
    double right[SIZE_MAX_UNKNOWNS], trial[SIZE_MAX_UNKNOWNS], damping = 1e-3;
    double square = normal_equations(problem, q, matrix, right);
    for (int iteration = 0; iteration < ITERATIONS; iteration++) {
        for (size_t i = 0; i < n; i++)
            matrix[i * n + i] *= 1 + damping;
        if (dense_factorise(matrix, n, n, 0))
            return singular();
        dense_substitute(matrix, n, n, right);
        for (size_t i = 0; i < n; i++)
            trial[i] = q[i] + right[i];
        double next = normal_equations(problem, trial, NULL, NULL);
        int better = next <= square;
        double gain = square - next;
        if (better) {
            memcpy(q, trial, n * sizeof *q);
            damping = fmax(damping / 10, 1e-12);
        } else {
            damping *= 10;
        }
        square = normal_equations(problem, q, matrix, right);
        if ((better && gain <= 1e-10 * square) || damping > 1e10)
            break;
    }
    return dense_factorise(matrix, n, n, 0) ? singular() : 0;
}

/* Covariance of the unknowns of the lens: columns of the inverse. */
static void lens_covariance(const double *factor, size_t n, double scale, double out[LENS_UNKNOWNS][LENS_UNKNOWNS])
{
    for (size_t a = 0; a < LENS_UNKNOWNS; a++) {
        double column[SIZE_MAX_UNKNOWNS] = {0};
        column[a] = 1;
        dense_substitute(factor, n, n, column);
        for (size_t b = 0; b < LENS_UNKNOWNS; b++)
            out[a][b] = scale * column[b];
    }
}

/* Leave out what is more than LENS_OUTLIER errors (of this fit) off. Returns how many changed. */
static size_t sort_out(const struct problem *problem, const double *q, double scale, char *inside)
{
    const struct lens_points *points = problem->points;
    size_t changed = 0;
    for (size_t m = 0; m < points->photos * points->count; m++) {
        if (isnan(points->sigma[m]))
            continue;
        struct row row = row_of(problem, q, m, 0);
        char in = vec_norm(row.residual) <= LENS_OUTLIER * scale * points->sigma[m];
        changed += in != inside[m];
        inside[m] = in;
    }
    return changed;
}

/* Robust size of the residuals in units of their errors, at least 1: the median of a Rayleigh variable is 1.177. */
static double residual_scale(const struct problem *problem, const double *q, double *work)
{
    const struct lens_points *points = problem->points;
    size_t n = 0;
    for (size_t m = 0; m < points->photos * points->count; m++)
        if (!isnan(points->sigma[m])) {
            struct row row = row_of(problem, q, m, 0);
            work[n++] = vec_norm(row.residual) / points->sigma[m];
        }
    return n ? fmax(1, select_rank(work, n, n / 2) / 1.177) : 1;
}

/* Start of a photo's motion: the median shift is enough, Marquardt does the rest. */
static void start_motions(const struct problem *problem, double *work, double *q)
{
    const struct lens_points *points = problem->points;
    for (size_t p = 0; p < points->photos; p++)
        for (int axis = 0; axis < 2; axis++) {
            size_t n = 0;
            for (size_t k = 0; k < points->count; k++)
                if (!isnan(points->sigma[p * points->count + k])) {
                    struct vec d = vec_sub(points->seen[p * points->count + k], points->reference[k]);
                    work[n++] = axis ? d.y : d.x;
                }
            q[LENS_UNKNOWNS + MOTION * p + (size_t)axis] = n ? select_rank(work, n, n / 2) : 0;
        }
}

static void describe(const struct problem *problem, const double *q, const double *factor, struct lens_fitted *fitted)
{
    const struct lens_points *points = problem->points;
    double square = 0, weighted = 0;
    fitted->lens = lens_of(problem, q);
    fitted->used = 0;
    for (size_t m = 0; m < points->photos * points->count; m++)
        if (problem->inside[m]) {
            struct row row = row_of(problem, q, m, 0);
            double e = vec_dot(row.residual, row.residual);
            square += e / 2;
            weighted += e / (points->sigma[m] * points->sigma[m]);
            fitted->used++;
        }
    memset(fitted->motions, 0, sizeof fitted->motions);
    memcpy(fitted->motions, q + LENS_UNKNOWNS, MOTION * points->photos * sizeof *q);
    fitted->rms = sqrt(square / (double)fitted->used);
    double freedom = 2 * (double)fitted->used - (double)problem->unknowns;
    lens_covariance(factor, problem->unknowns, fmax(1, weighted / freedom), fitted->covariance);
    fitted->s_map = map_error(problem, q, fitted->covariance);
    struct lens none = {.centre = problem->middle};
    lens_difference(&fitted->lens, &none, points->width, points->height, &fitted->largest);
    const double r = problem->half;
    const double unit[LENS_UNKNOWNS] = {r, r, 1 / pow(r, 2), 1 / pow(r, 4), 1 / pow(r, 6), 1 / r, 1 / r, 1 / pow(r, 2)};
    for (int a = 0; a < LENS_UNKNOWNS; a++)
        for (int b = 0; b < LENS_UNKNOWNS; b++)
            fitted->covariance[a][b] *= unit[a] * unit[b];
}

static int fit(struct problem *problem, char *inside, double *work, double *matrix, struct lens_fitted *fitted)
{
    double q[SIZE_MAX_UNKNOWNS] = {0};
    start_motions(problem, work, q);
    for (int round = 0; round < 8; round++) {
        if (minimise(problem, q, matrix))
            return -1;
        if (!sort_out(problem, q, residual_scale(problem, q, work), inside))
            break;
    }
    describe(problem, q, matrix, fitted);
    return 0;
}

/* Points that were followed, over all photos. */
static size_t measured(const struct lens_points *points)
{
    size_t n = 0;
    for (size_t m = 0; m < points->photos * points->count; m++)
        n += !isnan(points->sigma[m]);
    return n;
}

int lens_fit(const struct lens_points *points, struct lens_fitted *fitted)
{
    struct problem problem = {.points = points,
                              .half = hypot(points->width, points->height) / 2,
                              .middle = vec((points->width - 1) / 2.0, (points->height - 1) / 2.0),
                              .unknowns = LENS_UNKNOWNS + MOTION * points->photos};
    size_t all = points->photos * points->count, there = measured(points);
    if (points->photos < LENS_FEWEST_PHOTOS || points->photos > LENS_PHOTOS_MAX)
        return error_input("lens: %zu moved photos: give %d to %d beside the reference", points->photos,
                           LENS_FEWEST_PHOTOS, LENS_PHOTOS_MAX);
    if (there < LENS_FEWEST_POINTS * points->photos)
        return error_input("lens: only %zu points were followed in %zu photos: is the plate in focus and speckled "
                           "over the whole photo?",
                           there, points->photos);
    char *inside = malloc(all);
    double *work = malloc(all * sizeof *work);
    double *matrix = malloc(problem.unknowns * problem.unknowns * sizeof *matrix);
    problem.inside = inside;
    int status = inside && work && matrix ? 0 : error_memory("the lens");
    for (size_t m = 0; !status && m < all; m++)
        inside[m] = !isnan(points->sigma[m]);
    if (!status)
        status = fit(&problem, inside, work, matrix, fitted);
    if (!status) {
        fitted->left_out = there - fitted->used;
        if (!(fitted->s_map <= LENS_USEFUL))
            status = error_input("lens: these motions leave %.2g px of doubt in the map: move and turn the plate by a "
                                 "tenth of the photo or more between photos",
                                 fitted->s_map);
    }
    free(inside);
    free(work);
    free(matrix);
    return status;
}

struct vec lens_residual(const struct lens_points *points, const struct lens_fitted *fitted, size_t photo, size_t k)
{
    const double *motion = fitted->motions[photo], c = cos(motion[2]), s = sin(motion[2]);
    struct vec middle = vec((points->width - 1) / 2.0, (points->height - 1) / 2.0);
    struct vec arm = vec_sub(lens_corrected(&fitted->lens, points->reference[k]), middle);
    struct vec there = vec_add(middle, vec(motion[0] + c * arm.x + s * arm.y, motion[1] - s * arm.x + c * arm.y));
    return vec_sub(lens_corrected(&fitted->lens, points->seen[photo * points->count + k]), there);
}
