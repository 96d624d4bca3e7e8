/* A similarity between two photos of a fixed thing: with x, y from the mean position of the patches,
 *
 *     dx = zoom x + turn y + t_x,     dy = zoom y - turn x + t_y,     angle = turn
 *
 * for each patch, weighted by 1 / variance: least squares with four unknowns (three with one patch, which shows no
 * zoom). The angle is taken for small, which a camera on a stand is: turn in place of its sine. The covariance is
 * (A'WA)^-1, times chi^2 per degree of freedom where that exceeds 1: then the patches disagree by more than their
 * errors, because the paper is not flat or not fixed. */
#include "tracker/follow/drift.h"

#include <math.h>

#include "pipeline/numbers/dense.h"

enum { ZOOM, TURN, TX, TY, UNKNOWNS };
static const double smallest_error = 1e-5; /* px: no patch weighs more than this allows */

/* The three measurements of a patch as rows: value = row . p, with weight 1 / variance. */
struct rows {
    double row[3][UNKNOWNS], value[3], weight[3];
};

static struct rows rows_of(const struct camera *camera, const struct corrected *patch)
{
    double x = patch->x_ref - camera->cx, y = patch->y_ref - camera->cy, least = smallest_error * smallest_error;
    return (struct rows){{{x, y, 1, 0}, {y, -x, 0, 1}, {0, 1, 0, 0}},
                         {patch->x - patch->x_ref, patch->y - patch->y_ref, patch->angle},
                         {1 / (patch->xx + least), 1 / (patch->yy + least), 1 / (patch->aa + 1e-4 * least)}};
}

static void accumulate(const struct rows *rows, double normal[UNKNOWNS][UNKNOWNS], double right[UNKNOWNS])
{
    for (int r = 0; r < 3; r++)
        for (int i = 0; i < UNKNOWNS; i++) {
            right[i] += rows->weight[r] * rows->row[r][i] * rows->value[r];
            for (int j = 0; j < UNKNOWNS; j++)
                normal[i][j] += rows->weight[r] * rows->row[r][i] * rows->row[r][j];
        }
}

static double misfit(const struct rows *rows, const double p[UNKNOWNS])
{
    double sum = 0;
    for (int r = 0; r < 3; r++) {
        double left = rows->value[r];
        for (int i = 0; i < UNKNOWNS; i++)
            left -= rows->row[r][i] * p[i];
        sum += rows->weight[r] * left * left;
    }
    return sum;
}

/* Without a second patch the zoom stays as it is. */
static void freeze_zoom(double normal[UNKNOWNS][UNKNOWNS])
{
    for (int i = 0; i < UNKNOWNS; i++)
        normal[ZOOM][i] = normal[i][ZOOM] = 0;
}

static int find_centre(const struct corrected *patches, const int *good, size_t count, struct camera *camera)
{
    int used = 0;
    for (size_t k = 0; k < count; k++)
        if (good[k]) {
            camera->cx += patches[k].x_ref;
            camera->cy += patches[k].y_ref;
            used++;
        }
    if (used) {
        camera->cx /= used;
        camera->cy /= used;
    }
    return used;
}

struct camera camera_fit(const struct corrected *patches, const int *good, size_t count)
{
    struct camera camera = {0};
    double right[UNKNOWNS] = {0}, square = 0;
    int used = find_centre(patches, good, count, &camera), first = used > 1 ? ZOOM : TURN;
    for (size_t k = 0; k < count; k++)
        if (good[k]) {
            struct rows rows = rows_of(&camera, &patches[k]);
            accumulate(&rows, camera.covariance, right);
        }
    if (first == TURN)
        freeze_zoom(camera.covariance);
    if (!used || dense_invert(&camera.covariance[first][first], (size_t)(UNKNOWNS - first), UNKNOWNS, 0))
        return camera;
    for (int i = first; i < UNKNOWNS; i++)
        for (int j = first; j < UNKNOWNS; j++)
            camera.p[i] += camera.covariance[i][j] * right[j];
    for (size_t k = 0; k < count; k++)
        if (good[k]) {
            struct rows rows = rows_of(&camera, &patches[k]);
            square += misfit(&rows, camera.p);
        }
    int freedom = 3 * used - (UNKNOWNS - first);
    double widen = freedom > 0 ? fmax(1, square / freedom) : 1;
    for (int i = 0; i < UNKNOWNS; i++)
        for (int j = 0; j < UNKNOWNS; j++)
            camera.covariance[i][j] *= widen;
    camera.known = 1;
    return camera;
}

void camera_undo(const struct camera *camera, double *x, double *y, double *angle)
{
    double a = 1 + camera->p[ZOOM], b = camera->p[TURN], square = a * a + b * b;
    double dx = *x - camera->cx - camera->p[TX], dy = *y - camera->cy - camera->p[TY];
    *x = camera->cx + (a * dx - b * dy) / square;
    *y = camera->cy + (b * dx + a * dy) / square;
    *angle -= atan2(b, a);
}

void camera_variance(const struct camera *camera, double x, double y, double *xx, double *yy, double *angle)
{
    double dx = x - camera->cx, dy = y - camera->cy;
    const double row_x[UNKNOWNS] = {dx, dy, 1, 0}, row_y[UNKNOWNS] = {dy, -dx, 0, 1};
    *xx = *yy = 0;
    for (int i = 0; i < UNKNOWNS; i++)
        for (int j = 0; j < UNKNOWNS; j++) {
            *xx += row_x[i] * camera->covariance[i][j] * row_x[j];
            *yy += row_y[i] * camera->covariance[i][j] * row_y[j];
        }
    *angle = camera->covariance[TURN][TURN];
}
