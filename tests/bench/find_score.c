#include "tests/bench/find_score.h"

#include <math.h>
#include <stdlib.h>

static long nearest(const struct photo_grains *grains, double x, double y, double r)
{
    for (size_t k = 0; k < grains->count; k++)
        if (hypot(grains->x_px[k] - x, grains->y_px[k] - y) < 0.25 * r && fabs(grains->radius_px[k] - r) < 0.15 * r)
            return (long)k;
    return -1;
}

static double rim_along(const struct photo_grains *grains, size_t k, double phi)
{
    double r = grains->radius_px[k];
    if (grains->shape_c)
        r += grains->shape_c[k] * cos(2 * phi) + grains->shape_s[k] * sin(2 * phi);
    return r;
}

static double overlap_of(const struct photo_grains *grains, size_t i, size_t j)
{
    double dx = grains->x_px[j] - grains->x_px[i], dy = grains->y_px[j] - grains->y_px[i], phi = atan2(-dy, dx);
    return rim_along(grains, i, phi) + rim_along(grains, j, phi + M_PI) - hypot(dx, dy);
}

static void score_contacts(const struct photo_grains *truth, const struct photo_grains *grains, const long *row,
                           struct find_score *score)
{
    for (size_t i = 0; i < truth->count; i++)
        for (size_t j = i + 1; j < truth->count; j++) {
            double x;
            if (row[i] < 0 || row[j] < 0 ||
                fabs(truth->x_px[i] - truth->x_px[j]) > truth->radius_px[i] + truth->radius_px[j] ||
                (x = overlap_of(truth, i, j)) <= 0)
                continue;
            score->overlap += pow(overlap_of(grains, (size_t)row[i], (size_t)row[j]) - x, 2);
            score->contacts++;
        }
    score->overlap = sqrt(score->overlap / (double)score->contacts);
}

/* Fisher information of (R, x, y) over the visible rim, inverted: J per length of rim = A^2 / (2 sqrt(pi) s noise^2),
 * the integral of the bell's square. Levels that are unknown take away what of the bell is seen as a constant over the
 * band of +-BAND blurs, 1 / (2 BAND) of 1 / (2 sqrt(pi)); the step is odd and takes nothing. */
static void bound_of(const struct photo_grains *truth, size_t k, double per_length, double blur, double variance[3])
{
    enum { STEPS = 256 };
    double m[3][3] = {{0}};
    for (int step = 0; step < STEPS; step++) {
        double phi = 2 * M_PI * step / STEPS, r = truth->radius_px[k], row[3] = {1, cos(phi), sin(phi)};
        double x = truth->x_px[k] + r * row[1], y = truth->y_px[k] + r * row[2];
        int seen = 1;
        for (size_t j = 0; j < truth->count && seen; j++)
            seen = j == k || hypot(truth->x_px[j] - x, truth->y_px[j] - y) > truth->radius_px[j] + 1.2 * blur;
        for (int i = 0; seen && i < 9; i++)
            m[i / 3][i % 3] += per_length * 2 * M_PI * r / STEPS * row[i / 3] * row[i % 3];
    }
    double det = m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[1][2]) - m[0][1] * (m[0][1] * m[2][2] - m[1][2] * m[0][2]) +
                 m[0][2] * (m[0][1] * m[1][2] - m[1][1] * m[0][2]);
    variance[0] = (m[1][1] * m[2][2] - m[1][2] * m[1][2]) / det;
    variance[1] = (m[0][0] * m[2][2] - m[0][2] * m[0][2]) / det;
    variance[2] = (m[0][0] * m[1][1] - m[0][1] * m[0][1]) / det;
}

void find_score(const struct photo_grains *truth, const struct photo_grains *grains, double per_length, double blur,
                struct find_score *score)
{
    long *row = malloc((truth->count + 1) * sizeof *row);
    if (!row)
        return;
    score->truth = truth->count;
    for (size_t k = 0; k < truth->count; k++) {
        double variance[3];
        row[k] = nearest(grains, truth->x_px[k], truth->y_px[k], truth->radius_px[k]);
        if (row[k] < 0)
            continue;
        size_t j = (size_t)row[k];
        double x = grains->x_px[j] - truth->x_px[k], y = grains->y_px[j] - truth->y_px[k];
        double r = grains->radius_px[j] - truth->radius_px[k];
        score->found++;
        score->centre += 0.5 * (x * x + y * y);
        score->radius += r * r;
        score->bias += r;
        if (grains->s_x && isfinite(grains->s_radius[j])) {
            score->ratio_centre += 0.5 * (pow(x / grains->s_x[j], 2) + pow(y / grains->s_y[j], 2));
            score->ratio_radius += pow(r / grains->s_radius[j], 2);
        }
        bound_of(truth, k, per_length, blur, variance);
        score->bound_radius += variance[0];
        score->bound_centre += 0.5 * (variance[1] + variance[2]);
    }
    double n = (double)score->found;
    score->wrong = grains->count - score->found;
    score->centre = sqrt(score->centre / n);
    score->radius = sqrt(score->radius / n);
    score->bias /= n;
    score->ratio_centre = sqrt(score->ratio_centre / n);
    score->ratio_radius = sqrt(score->ratio_radius / n);
    score->bound_centre = sqrt(score->bound_centre / n);
    score->bound_radius = sqrt(score->bound_radius / n);
    score_contacts(truth, grains, row, score);
    free(row);
}
