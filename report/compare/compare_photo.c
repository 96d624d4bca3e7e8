/* Photo-side files against each other, in px and degrees. Centres: errors per axis, bias and spread apart, since a
 * bias (half a pixel, a shifted photo) is another fault than noise. "Pull" is an error over its own standard error,
 * root mean square over all: 1 when standard errors are honest, above when they promise too much. */
#include <math.h>
#include <stdlib.h>

#include "pipeline/speak/error.h"
#include "report/compare/compare.h"
#include "report/compare/match.h"
#include "report/compare/spread.h"

/* rad per degree. */
static const double DEGREE = 0.017453292519943295;

/* Positions of B to set against those of A. */
static struct match_points places_of_b(const struct compare_photo *pair, const struct photo_grains *b)
{
    int seen = pair->a_is_seen && b->x_seen_px && b->y_seen_px;
    return (struct match_points){b->count, seen ? b->x_seen_px : b->x_px, seen ? b->y_seen_px : b->y_px};
}

/* No flag of distrust: bits 16 to 31 inform only. */
static int is_trusted(const struct photo_grains *a, size_t k)
{
    return !(a->flags[k] & GRAIN_DISTRUST);
}

/* Found, missed and false grains. A false grain that carries a flag of distrust has warned its reader: it is counted
 * apart. */
static void count_grains(const struct compare_photo *pair, const long *row, struct figures *figures)
{
    size_t found = 0, wrong = 0, wrong_flagged = 0, distrusted = 0;
    const struct photo_grains *a = pair->a, *b = pair->b;
    for (size_t k = 0; k < a->count; k++) {
        found += row[k] >= 0;
        wrong += row[k] < 0 && is_trusted(a, k);
        wrong_flagged += row[k] < 0 && !is_trusted(a, k);
        distrusted += !is_trusted(a, k);
    }
    figures_add(figures, "grains_a", (double)a->count, "1", "grains in A");
    figures_add(figures, "grains_b", (double)b->count, "1", "grains in B");
    figures_add(figures, "found", (double)found, "1", "grains of B found in A");
    figures_add(figures, "missed", (double)(b->count - found), "1", "grains of B missed in A");
    figures_add(figures, "false", (double)wrong, "1", "grains of A that are not in B");
    figures_add(figures, "false_flagged", (double)wrong_flagged, "1", "the same, but flagged as not to be trusted");
    figures_add(figures, "flagged", (double)distrusted, "1", "grains of A flagged as not to be trusted");
}

/* Errors of centres and radii over the grains of A that are found and trusted. Pulls need both standard errors and
 * positions as seen: what the lens correction adds is not in s_x and s_y. */
static void compare_places(const struct compare_photo *pair, const long *row, struct figures *figures)
{
    const struct photo_grains *a = pair->a, *b = pair->b;
    struct match_points place = places_of_b(pair, b);
    struct spread x = {0}, y = {0}, centre = {0}, radius = {0}, pull_x = {0}, pull_radius = {0};
    for (size_t k = 0; k < a->count; k++) {
        if (row[k] < 0 || !is_trusted(a, k))
            continue;
        double dx = a->x_px[k] - place.x[row[k]], dy = a->y_px[k] - place.y[row[k]];
        spread_add(&x, dx);
        spread_add(&y, dy);
        spread_add(&centre, hypot(dx, dy));
        if (pair->a_is_seen && a->s_x && a->s_x[k] > 0 && a->s_y && a->s_y[k] > 0) {
            spread_add(&pull_x, dx / a->s_x[k]);
            spread_add(&pull_x, dy / a->s_y[k]);
        }
        if (!a->radius_px || !b->radius_px)
            continue;
        double dr = a->radius_px[k] - b->radius_px[row[k]];
        spread_add(&radius, dr);
        if (a->s_radius && a->s_radius[k] > 0)
            spread_add(&pull_radius, dr / a->s_radius[k]);
    }
    figures_add(figures, "compared", (double)x.count, "1", "grains compared (found and trusted)");
    figures_add(figures, "centre_rms_px", spread_rms(&centre) / sqrt(2), "px", "centre, RMS per axis");
    figures_add(figures, "centre_bias_x_px", spread_mean(&x), "px", "centre, mean error to the right");
    figures_add(figures, "centre_bias_y_px", spread_mean(&y), "px", "centre, mean error downwards");
    figures_add(figures, "centre_max_px", spread_largest(&centre), "px", "centre, largest distance");
    figures_add(figures, "centre_pull", spread_rms(&pull_x), "1", "centre, RMS of error over its standard error");
    figures_add(figures, "radius_rms_px", spread_rms(&radius), "px", "radius, RMS");
    figures_add(figures, "radius_bias_px", spread_mean(&radius), "px", "radius, mean error");
    figures_add(figures, "radius_max_px", spread_largest(&radius), "px", "radius, largest error");
    figures_add(figures, "radius_pull", spread_rms(&pull_radius), "1", "radius, RMS of error over its standard error");
}

/* Where the material that A followed (at A's own idea of the centre in the reference) really is now: it moves
 * rigidly with the grain of B. Angles are counter-clockwise as seen, y is down. */
static struct vec carried(struct vec a0, struct vec b0, struct vec b, double angle)
{
    struct vec offset = vec_sub(a0, b0);
    double c = cos(angle), s = sin(angle);
    return vec(b.x + c * offset.x + s * offset.y, b.y - s * offset.x + c * offset.y);
}

/* Reference positions: from a file of their own, else from the columns of the tracker. */
static struct match_points reference_places(const struct photo_grains *grains, const struct photo_grains *reference)
{
    if (reference)
        return (struct match_points){reference->count, reference->x_px, reference->y_px};
    return (struct match_points){grains->count, grains->x_ref_px, grains->y_ref_px};
}

static double turned(const struct photo_grains *grains, const struct photo_grains *reference, size_t k)
{
    if (!grains->angle)
        return NAN;
    return grains->angle[k] - (reference && reference->angle ? reference->angle[k] : 0);
}

static void compare_motion(const struct compare_photo *pair, const long *row, struct figures *figures)
{
    const struct photo_grains *a = pair->a, *b = pair->b;
    struct match_points a0 = reference_places(a, pair->a0), b0 = reference_places(b, pair->b0);
    struct spread x = {0}, y = {0}, size = {0}, angle = {0}, pull = {0}, pull_angle = {0};
    size_t lost = 0;
    for (size_t k = 0; k < a->count; k++) {
        if (row[k] < 0)
            continue;
        size_t m = (size_t)row[k];
        lost += !is_trusted(a, k);
        if (!is_trusted(a, k))
            continue;
        double true_angle = turned(b, pair->b0, m);
        struct vec place = carried(vec(a0.x[k], a0.y[k]), vec(b0.x[m], b0.y[m]), vec(b->x_px[m], b->y_px[m]),
                                   isnan(true_angle) ? 0 : true_angle);
        double dx = a->x_px[k] - place.x, dy = a->y_px[k] - place.y;
        double da = remainder(turned(a, pair->a0, k) - true_angle, 2 * M_PI);
        spread_add(&x, dx);
        spread_add(&y, dy);
        spread_add(&size, hypot(dx, dy));
        spread_add(&angle, da);
        if (a->s_x && a->s_y && a->s_x[k] > 0 && a->s_y[k] > 0) {
            spread_add(&pull, dx / a->s_x[k]);
            spread_add(&pull, dy / a->s_y[k]);
        }
        if (a->s_angle && a->s_angle[k] > 0)
            spread_add(&pull_angle, da / a->s_angle[k]);
    }
    figures_add(figures, "motion_compared", (double)x.count, "1", "motions compared (matched and trusted)");
    figures_add(figures, "motion_flagged", (double)lost, "1", "motions left out because A flags them");
    figures_add(figures, "displacement_rms_px", spread_rms(&size) / sqrt(2), "px", "displacement, RMS per axis");
    figures_add(figures, "displacement_bias_x_px", spread_mean(&x), "px", "displacement, mean error to the right");
    figures_add(figures, "displacement_bias_y_px", spread_mean(&y), "px", "displacement, mean error downwards");
    figures_add(figures, "displacement_max_px", spread_largest(&size), "px", "displacement, largest error");
    figures_add(figures, "displacement_pull", spread_rms(&pull), "1", "displacement, RMS of error over standard error");
    figures_add(figures, "rotation_rms_deg", spread_rms(&angle) / DEGREE, "deg", "rotation, RMS");
    figures_add(figures, "rotation_max_deg", spread_largest(&angle) / DEGREE, "deg", "rotation, largest error");
    figures_add(figures, "rotation_pull", spread_rms(&pull_angle), "1", "rotation, RMS of error over standard error");
}

/* Both sides know where their grains started. */
static int has_motion(const struct compare_photo *pair)
{
    struct match_points a0 = reference_places(pair->a, pair->a0), b0 = reference_places(pair->b, pair->b0);
    return a0.x && a0.y && b0.x && b0.y;
}

int compare_photo(const struct compare_photo *pair, struct figures *figures)
{
    if ((pair->a0 && pair->a0->count != pair->a->count) || (pair->b0 && pair->b0->count != pair->b->count))
        return error_input("a reference has another number of grains than its state: give files of one series");
    int motion = has_motion(pair);
    struct match_points a = {pair->a->count, pair->a->x_px, pair->a->y_px}, b = places_of_b(pair, pair->b);
    if (motion) { /* who is who is told where they started, so that a grain followed badly is an error, not a miss */
        a = reference_places(pair->a, pair->a0);
        b = reference_places(pair->b, pair->b0);
    }
    long *row = malloc((pair->a->count + 1) * sizeof *row);
    int result = row ? match_grains(&a, &b, pair->b->radius_px, row) : error_memory("matching of grains");
    if (result == 0) {
        count_grains(pair, row, figures);
        compare_places(pair, row, figures);
        if (motion)
            compare_motion(pair, row, figures);
    }
    free(row);
    return result;
}
