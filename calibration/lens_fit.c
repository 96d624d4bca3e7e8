#include "calibration/lens_fit.h"

#include <stdlib.h>
#include <string.h>

#include "pipeline/error.h"

enum { MOTION = 3, SIZE_MAX_UNKNOWNS = LENS_UNKNOWNS + MOTION * LENS_PHOTOS_MAX, ITERATIONS = 60, MAP_STEPS = 12 };

/* Unknowns without units: centre offset / R, K1 R^2, K2 R^4, K3 R^6, P1 R, P2 R, P3 R^2 with R half the photo's
 * diagonal; and how large any of them can be. These weak priors (standard deviations) keep directions that no plate
 * shows (centre against P1 P2; P3 where P1 = P2 = 0) from running away. */
static const double prior[LENS_UNKNOWNS] = {0.1, 0.1, 0.1, 0.1, 0.1, 0.02, 0.02, 0.3};

struct problem {
    const struct lens_points *points;
    double half;        /* R, px */
    struct vec middle;  /* of the photo */
    const char *inside; /* photos * count: measurements that are used */
    size_t unknowns;
};

static struct lens lens_of(const struct problem *problem, const double *q)
{
    const double r = problem->half, r2 = r * r;
    return (struct lens){.centre = vec(problem->middle.x + r * q[0], problem->middle.y + r * q[1]),
                         .k = {q[2] / r2, q[3] / (r2 * r2), q[4] / (r2 * r2 * r2)},
                         .p = {q[5] / r, q[6] / r, q[7] / r2}};
}

/* Derivatives of the corrected position with respect to the eight unknowns, by central differences: all but P3 and
 * the centre enter linearly. */
static void slopes_of(const struct problem *problem, const double *q, struct vec seen, struct vec slopes[LENS_UNKNOWNS])
{
    const double step = 1e-4;
    double shifted[LENS_UNKNOWNS];
    memcpy(shifted, q, sizeof shifted);
    for (int a = 0; a < LENS_UNKNOWNS; a++) {
        shifted[a] = q[a] + step;
        struct lens more = lens_of(problem, shifted);
        shifted[a] = q[a] - step;
        struct lens less = lens_of(problem, shifted);
        shifted[a] = q[a];
        slopes[a] = vec_scale(0.5 / step, vec_sub(lens_corrected(&more, seen), lens_corrected(&less, seen)));
    }
}

/* One measurement: residual (px) and its derivatives for the lens and for its photo's motion. */
struct row {
    struct vec residual, lens[LENS_UNKNOWNS], motion[MOTION];
};

static struct row row_of(const struct problem *problem, const double *q, const double *motion, struct vec reference,
                         struct vec seen, int slopes)
{
    struct lens lens = lens_of(problem, q);
    struct vec arm = vec_sub(lens_corrected(&lens, reference), problem->middle);
    const double c = cos(motion[2]), s = sin(motion[2]);
    struct vec turned = vec(c * arm.x + s * arm.y, -s * arm.x + c * arm.y);
    struct vec there = vec_add(vec_add(problem->middle, vec(motion[0], motion[1])), turned);
    struct row row = {.residual = vec_sub(lens_corrected(&lens, seen), there)};
    if (!slopes)
        return row;
    struct vec at_seen[LENS_UNKNOWNS], at_reference[LENS_UNKNOWNS];
    slopes_of(problem, q, seen, at_seen);
    slopes_of(problem, q, reference, at_reference);
    for (int a = 0; a < LENS_UNKNOWNS; a++) {
        struct vec d = at_reference[a];
        row.lens[a] = vec_sub(at_seen[a], vec(c * d.x + s * d.y, -s * d.x + c * d.y));
    }
    row.motion[0] = vec(-1, 0);
    row.motion[1] = vec(0, -1);
    row.motion[2] = vec(-turned.y, turned.x);
    return row;
}

/* Normal equations: matrix (unknowns^2, row-major) and right-hand side; returns the weighted sum of squares. */
static double normal_equations(const struct problem *problem, const double *q, double *matrix, double *right)
{
    const struct lens_points *points = problem->points;
    const size_t n = problem->unknowns;
    double square = 0;
    if (matrix) {
        memset(matrix, 0, n * n * sizeof *matrix);
        memset(right, 0, n * sizeof *right);
    }
    for (size_t m = 0; m < points->photos * points->count; m++) {
        if (!problem->inside[m])
            continue;
        size_t photo = m / points->count, first = LENS_UNKNOWNS + MOTION * photo;
        double weight = 1 / (points->sigma[m] * points->sigma[m]);
        struct row row =
            row_of(problem, q, q + first, points->reference[m % points->count], points->seen[m], matrix != NULL);
        square += weight * vec_dot(row.residual, row.residual);
        for (int a = 0; matrix && a < LENS_UNKNOWNS + MOTION; a++) {
            size_t ia = a < LENS_UNKNOWNS ? (size_t)a : first + (size_t)(a - LENS_UNKNOWNS);
            struct vec da = a < LENS_UNKNOWNS ? row.lens[a] : row.motion[a - LENS_UNKNOWNS];
            right[ia] -= weight * vec_dot(da, row.residual);
            for (int b = 0; b < LENS_UNKNOWNS + MOTION; b++) {
                size_t ib = b < LENS_UNKNOWNS ? (size_t)b : first + (size_t)(b - LENS_UNKNOWNS);
                struct vec db = b < LENS_UNKNOWNS ? row.lens[b] : row.motion[b - LENS_UNKNOWNS];
                matrix[ia * n + ib] += weight * vec_dot(da, db);
            }
        }
    }
    for (int a = 0; a < LENS_UNKNOWNS; a++) {
        double weight = 1 / (prior[a] * prior[a]);
        square += weight * q[a] * q[a];
        if (matrix) {
            matrix[(size_t)a * n + (size_t)a] += weight;
            right[a] -= weight * q[a];
        }
    }
    return square;
}

/* Cholesky in place; 0 when the matrix is not positive definite. */
static int factorise(double *m, size_t n)
{
    for (size_t i = 0; i < n; i++)
        for (size_t j = 0; j <= i; j++) {
            double sum = m[i * n + j];
            for (size_t k = 0; k < j; k++)
                sum -= m[i * n + k] * m[j * n + k];
            if (i == j && !(sum > 0))
                return 0;
            m[i * n + j] = i == j ? sqrt(sum) : sum / m[j * n + j];
        }
    return 1;
}

static void solve(const double *m, size_t n, double *x)
{
    for (size_t i = 0; i < n; i++) {
        for (size_t k = 0; k < i; k++)
            x[i] -= m[i * n + k] * x[k];
        x[i] /= m[i * n + i];
    }
    for (size_t i = n; i-- > 0;) {
        for (size_t k = i + 1; k < n; k++)
            x[i] -= m[k * n + i] * x[k];
        x[i] /= m[i * n + i];
    }
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
        if (!factorise(matrix, n))
            return error_input("lens: the equations of the plate are singular: take photos with larger motions");
        solve(matrix, n, right);
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
    return factorise(matrix, n) ? 0
                                : error_input("lens: the equations of the plate are singular: take photos with "
                                              "larger motions");
}

/* Covariance of the unknowns of the lens: columns of the inverse. */
static void lens_covariance(const double *factor, size_t n, double scale, double out[LENS_UNKNOWNS][LENS_UNKNOWNS])
{
    for (size_t a = 0; a < LENS_UNKNOWNS; a++) {
        double column[SIZE_MAX_UNKNOWNS] = {0};
        column[a] = 1;
        solve(factor, n, column);
        for (size_t b = 0; b < LENS_UNKNOWNS; b++)
            out[a][b] = scale * column[b];
    }
}

/* ---- what a difference of lenses looks like in the photo ---- */

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
static double map_error(const struct problem *problem, const double *q, double covariance[LENS_UNKNOWNS][LENS_UNKNOWNS])
{
    struct vec place[MAP_POINTS], slopes[MAP_POINTS][LENS_UNKNOWNS], field[MAP_POINTS];
    double factor[LENS_UNKNOWNS * LENS_UNKNOWNS], total = 0, most;
    memcpy(factor, covariance, sizeof factor);
    if (!factorise(factor, LENS_UNKNOWNS))
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

/* ---- the fit ---- */

/* Leave out what is more than LENS_OUTLIER errors (of this fit) off. Returns how many changed. */
static size_t sort_out(const struct problem *problem, const double *q, double scale, char *inside)
{
    const struct lens_points *points = problem->points;
    size_t changed = 0;
    for (size_t m = 0; m < points->photos * points->count; m++) {
        if (isnan(points->sigma[m]))
            continue;
        struct row row = row_of(problem, q, q + LENS_UNKNOWNS + MOTION * (m / points->count),
                                points->reference[m % points->count], points->seen[m], 0);
        char in = vec_norm(row.residual) <= LENS_OUTLIER * scale * points->sigma[m];
        changed += in != inside[m];
        inside[m] = in;
    }
    return changed;
}

static int compare(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* Robust size of the residuals in units of their errors, at least 1: the median of a Rayleigh variable is 1.177. */
static double residual_scale(const struct problem *problem, const double *q, double *work)
{
    const struct lens_points *points = problem->points;
    size_t n = 0;
    for (size_t m = 0; m < points->photos * points->count; m++)
        if (!isnan(points->sigma[m])) {
            struct row row = row_of(problem, q, q + LENS_UNKNOWNS + MOTION * (m / points->count),
                                    points->reference[m % points->count], points->seen[m], 0);
            work[n++] = vec_norm(row.residual) / points->sigma[m];
        }
    qsort(work, n, sizeof *work, compare);
    return n ? fmax(1, work[n / 2] / 1.177) : 1;
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
            qsort(work, n, sizeof *work, compare);
            q[LENS_UNKNOWNS + MOTION * p + (size_t)axis] = n ? work[n / 2] : 0;
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
            struct row row = row_of(problem, q, q + LENS_UNKNOWNS + MOTION * (m / points->count),
                                    points->reference[m % points->count], points->seen[m], 0);
            double e = vec_dot(row.residual, row.residual);
            square += e / 2;
            weighted += e / (points->sigma[m] * points->sigma[m]);
            fitted->used++;
        }
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
