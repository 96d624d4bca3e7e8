/* Along rays from the captured centre the place where means over a few pixels on both sides differ most, to a fraction
 * of a pixel by a parabola through three of these differences. A rim that is off by (dx, dy, dR) has its edges at R +
 * dR + dx cos + dy sin: weighted least squares with Tukey's biweight, whose scale is the median of the distances (times
 * 1.4826, which makes it a standard deviation), never below LEAST_SCATTER. */
#include "findgrains/capture/polish.h"

#include "findgrains/look/grey.h"
#include "pipeline/numbers/dense.h"
#include "pipeline/numbers/quantiles.h"

#include <math.h>

enum { RAYS = 128, PROFILE = 128, ROUNDS = 8 };
#define REACH 2.5     /* spreads of the capture on both sides of its rim, */
#define MORE_REACH 2  /* px further */
#define FAINTEST 0.15 /* fall, in contrasts of the photo */
#define CONFIRMED 0.25
#define LEAST_SCATTER 0.3 /* px: elliptic rims scatter about their circle */
#define TUKEY 4.0

struct place {
    double dx, dy, r; /* unit vector and distance from the rim's centre of the steepest fall */
    double weight;
};

/* The steepest fall over `arm` samples (1 px apart) on both sides; 0: none. */
static int steepest(const double *profile, int count, int arm, double faintest, double *at, double *fall)
{
    double sum[PROFILE + 1] = {0}, before = 0, best = faintest, left = 0, right = 0;
    int where = -1;
    for (int k = 0; k < count; k++)
        sum[k + 1] = sum[k] + profile[k];
    for (int k = arm; k <= count - arm; k++) { /* between samples k - 1 and k */
        double now = (2 * sum[k] - sum[k - arm] - sum[k + arm]) / arm;
        if (where == k - 1)
            right = now;
        if (now > best) {
            best = now;
            where = k;
            left = before;
            right = now;
        }
        before = now;
    }
    if (where <= arm || where >= count - arm)
        return 0;
    double bend = left - 2 * best + right;
    *at = where - 0.5 + (bend < 0 ? fmax(-0.5, fmin(0.5, 0.5 * (left - right) / bend)) : 0);
    *fall = best;
    return 1;
}

static int find_places(const struct photo *photo, const struct rim *rim, double reach, double contrast,
                       struct place *places, int *rays)
{
    int count = 0, length = (int)fmin(PROFILE, 2 * ceil(reach) + 7), arm = (int)fmax(2, fmin(4, reach));
    double first = rim->radius - 0.5 * (length - 1), profile[PROFILE];
    *rays = (int)fmax(24, fmin(RAYS, 2 * M_PI * rim->radius / 2));
    if (first < 1) {
        length -= (int)(2 * ceil(1 - first));
        first = rim->radius - 0.5 * (length - 1);
    }
    if (length < 2 * arm + 2)
        return 0;
    for (int ray = 0; ray < *rays; ray++) {
        double c = cos(2 * M_PI * ray / *rays), s = sin(2 * M_PI * ray / *rays), at, fall;
        for (int k = 0; k < length; k++)
            profile[k] = grey_at(photo, rim->x + (first + k) * c, rim->y + (first + k) * s);
        if (steepest(profile, length, arm, FAINTEST * contrast, &at, &fall))
            places[count++] = (struct place){c, s, first + at, fmin(1, 2 * fall / contrast)};
    }
    return count;
}

/* Robust circle: weighted least squares of r = dR + dx cos + dy sin; 0 when the places do not determine one; *scatter:
 * of the places about it, *share: of the rays that agree. */
static int fit_places(const struct place *places, int count, int rays, struct rim *rim, double *scatter, double *share)
{
    double p[3] = {rim->radius, 0, 0}, off[RAYS];
    for (int round = 0; round < ROUNDS; round++) {
        double m[3][4] = {{0}}, agree = 0;
        for (int k = 0; k < count; k++)
            off[k] = fabs(places[k].r - p[0] - p[1] * places[k].dx - p[2] * places[k].dy);
        *scatter = fmax(LEAST_SCATTER, 1.4826 * median_of(off, (size_t)count));
        for (int k = 0; k < count; k++) {
            double row[4] = {1, places[k].dx, places[k].dy, places[k].r};
            double q = (row[3] - p[0] - p[1] * row[1] - p[2] * row[2]) / (TUKEY * *scatter);
            double weight = fabs(q) < 1 ? places[k].weight * (1 - q * q) * (1 - q * q) : 0;
            agree += fabs(q) < 0.75;
            for (int i = 0; i < 3; i++)
                for (int j = 0; j < 4; j++)
                    m[i][j] += weight * row[i] * row[j];
        }
        *share = agree / rays;
        if (dense_solve(&m[0][0], 3, 4, 1e-6))
            return 0;
        for (int i = 0; i < 3; i++)
            p[i] = m[i][3];
    }
    rim->radius = p[0];
    rim->x += p[1];
    rim->y += p[2];
    return 1;
}

static void polish_rim(const struct photo *photo, double contrast, struct candidate *item)
{
    struct place places[RAYS];
    struct rim rim = item->rim;
    double spread = item->spread, limit = REACH * spread + MORE_REACH, reach = limit, scatter = 0, share = 0;
    for (int pass = 0; pass < 2; pass++) {
        int rays, count = find_places(photo, &rim, reach, contrast, places, &rays);
        if (count < 8 || !fit_places(places, count, rays, &rim, &scatter, &share) || share < CONFIRMED)
            return;
        if (hypot(rim.x - item->rim.x, rim.y - item->rim.y) > limit || fabs(rim.radius - item->rim.radius) > limit)
            return;
        reach = fmin(reach, 3 * scatter + 1);
        spread = fmin(spread, 3 * scatter / sqrt(share * rays) + 0.1);
    }
    item->rim = rim;
    item->spread = spread;
}

void polish_rims(const struct photo *photo, const struct grey_levels *levels, struct candidates *list)
{
    double contrast = levels->grain_level - levels->void_level;
#pragma omp parallel for schedule(dynamic, 16)
    for (size_t k = 0; k < list->count; k++) {
        struct candidate *item = &list->items[k];
        polish_rim(photo, contrast, item);
        item->captured = item->rim;
        item->sure = item->support;
    }
}
