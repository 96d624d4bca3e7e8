/* Iterations of inverse-compositional Gauss-Newton on the equations that subset.c makes. With T the searched photo at
 * the pixels where the motion m so far carries the subset,
 *
 *     gain = grey'T / grey'grey,     step = H^-1 Z'T / gain,     m <- W(m) o W(step)^-1,
 *
 * until the step moves the rim by less than the tolerance. Z is orthogonal to grey, Laplacian and 1, so that Z'T is Z'
 * of the residual and no offset has to be taken off.
 *
 * The pixels' noise is told by what is left of T - gain grey - offset, on n - 6 degrees of freedom (motion, gain,
 * offset, focus): the reference brings its noise times gain, the photo its own as the spline passes it on
 * (bspline_noise_gain). Slopes carry noise too and make H = Z'J larger than the texture alone would, by noise_hessian
 * times the variance: near the end, and for the covariance, that is taken off.
 *
 * First on the cubic spline. Its error of phase is a bias of some thousandths of a pixel in fine speckle; where that is
 * not small against the standard error, and no rotation averages it over all phases, the quintic spline finishes
 * (Schreier, Braasch and Sutton, Opt. Eng. 39 (2000) 2915, on such biases). */
#include "tracker/search/icgn.h"

#include <math.h>
#include <string.h>

#include "tracker/subset/kernel.h"
#include "tracker/subset/scatter.h"

enum { SLACK = 2, BORDER = 2 }; /* px: loaded around the start; where the spline at the photo's border is not its own */

void icgn_extent(const struct shape *shape, double angle, double *half_w, double *half_h)
{
    double c = fabs(cos(angle)), s = fabs(sin(angle));
    *half_w = shape->half_w > 0 ? c * shape->half_w + s * shape->half_h : shape->radius;
    *half_h = shape->half_w > 0 ? s * shape->half_w + c * shape->half_h : shape->radius;
}

int icgn_inside(const struct shape *shape, const struct motion *motion, const struct photo *photo)
{
    double w, h, x = shape->cx + motion->u, y = shape->cy + motion->v;
    icgn_extent(shape, motion->angle, &w, &h);
    return x - w >= BORDER && y - h >= BORDER && x + w <= photo->width - 1 - BORDER &&
           y + h <= photo->height - 1 - BORDER;
}

/* Coefficients around the moved shape, reloaded when it has left them. */
static int load_patch(const struct shape *shape, const struct photo *photo, const struct motion *motion, double level,
                      enum bspline_order order, int fresh, struct patch *patch)
{
    double w, h, x = shape->cx + motion->u, y = shape->cy + motion->v;
    icgn_extent(shape, motion->angle, &w, &h);
    if (!fresh && patch_covers(patch, x - w, y - h, x + w, y + h))
        return 0;
    w += SLACK;
    h += SLACK;
    return patch_load(photo, x - w, y - h, x + w, y + h, (float)level, order, patch);
}

/* Mean over the subset of the variance of the interpolated noise, in units of the pixels' own. */
static double noise_gain(const struct subset *subset, const struct motion *motion, enum bspline_order order)
{
    const double c = cos(motion->angle), s = sin(motion->angle);
    enum { STEP = 8 };
    double sum = 0;
    size_t count = 0;
    for (size_t k = 0; k < subset->run_count; k += STEP)
        for (int i = 0; i < subset->runs[k].count; i += STEP, count++) {
            double dx = subset->runs[k].x + i - subset->shape.cx, dy = subset->runs[k].y - subset->shape.cy;
            sum += bspline_noise_gain(order, subset->shape.cx + motion->u + c * dx + s * dy) *
                   bspline_noise_gain(order, subset->shape.cy + motion->v - s * dx + c * dy);
        }
    return count ? sum / (double)count : 1;
}

/* product = a b' . */
static void multiply_transposed(double a[3][3], double b[3][3], double product[3][3])
{
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            product[i][j] = a[i][0] * b[j][0] + a[i][1] * b[j][1] + a[i][2] * b[j][2];
}

/* H^-1 of the reference without its noise: slopes carry it, and make H too large by noise_hessian. */
static void clean_inverse(const struct subset *subset, double variance, double inverse[3][3])
{
    double clean[3][3];
    memcpy(clean, subset->hessian, sizeof clean);
    for (int i = 0; i < 3; i++)
        clean[i][i] -= fmin(variance * subset->noise_hessian[i], 0.5 * clean[i][i]);
    if (!subset_invert(clean, inverse))
        memcpy(inverse, subset->inverse, sizeof subset->inverse);
}

/* The estimate solves Z'(photo - model) = 0: its covariance is s2 (1 + 1/gain^2) H^-1 Z'Z H^-T, H = Z'J. */
static void set_covariance(const struct subset *subset, double variance, double gain, struct fit *fit)
{
    double inverse[3][3], half[3][3], instrument[3][3];
    memcpy(instrument, subset->instrument, sizeof instrument);
    clean_inverse(subset, variance, inverse);
    multiply_transposed(inverse, instrument, half); /* the instrument is symmetric */
    multiply_transposed(half, inverse, fit->covariance);
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            fit->covariance[i][j] *= variance * (1 + 1 / (gain * gain));
}

/* Of photo - gain * reference - offset, over the subset. */
static double residual_variance(const struct subset *subset, const struct kernel_sums *sums, double gain)
{
    double n = (double)subset->count, spread = sums->square - sums->one * sums->one / n;
    return fmax(spread - gain * gain * subset->energy, 0) / (n - 6);
}

/* What the last sums say of the match; the covariance is that of white noise. */
static void judge(const struct subset *subset, const struct kernel_sums *sums, enum bspline_order order,
                  struct fit *fit)
{
    double n = (double)subset->count, spread = sums->square - sums->one * sums->one / n;
    double gain = sums->plane[SUBSET_GREY] / subset->energy;
    double left = residual_variance(subset, sums, gain);
    fit->gain = gain;
    fit->zncc = spread > 0 ? sums->plane[SUBSET_GREY] / sqrt(spread * subset->energy) : 0;
    if (!(gain > 0))
        return;
    double variance = left / (gain * gain + noise_gain(subset, &fit->motion, order));
    fit->noise = sqrt(variance);
    fit->offset = sums->one / n;
    fit->white = left > 0 ? variance * (1 + gain * gain) / left : 1;
    set_covariance(subset, variance, gain, fit);
}

/* The covariance from how the residual scatters over tiles (scatter.h). */
static int measure_scatter(const struct subset *subset, const struct photo *photo, enum bspline_order order,
                           struct patch *patch, struct fit *fit)
{
    struct scatter scatter;
    if (!(fit->noise > 0))
        return 0;
    if (load_patch(&subset->shape, photo, &fit->motion, subset->mean, order, 0, patch) ||
        scatter_measure(subset, patch, &fit->motion, fit->gain, fit->offset, fit->white, &scatter))
        return -1;
    fit->noise *= sqrt(1 - scatter.focus);
    set_covariance(subset, fit->noise * fit->noise * scatter.ratio / fit->white, fit->gain, fit);
    return 0;
}

double icgn_cubic_bias(double speckle)
{
    return speckle > 0 ? fmin(0.0032 * pow(1.2 / speckle, 3), 0.02) : 0;
}

/* Is the cubic spline's bias worth a quintic iteration? Not when it hides in the noise, nor where a rotation averages
 * it over all phases. */
static int needs_quintic(const struct subset *subset, const struct fit *fit)
{
    double error = sqrt((fit->covariance[0][0] + fit->covariance[1][1]) / 2);
    return fabs(fit->motion.angle) * subset->shape.radius < 2 && icgn_cubic_bias(subset->speckle) > 0.3 * error;
}

/* One iteration from fit->motion. 1: it moved the rim by less than the tolerance; 0: more; -1: out of memory; 2: there
 * is nothing to follow. */
static int iterate(const struct subset *subset, const struct photo *photo, const struct icgn_options *options,
                   enum bspline_order order, int fresh, struct patch *patch, struct kernel_sums *sums, struct fit *fit)
{
    double step[3], inverse[3][3];
    fit->iterations++;
    if (load_patch(&subset->shape, photo, &fit->motion, subset->mean, order, fresh, patch))
        return -1;
    kernel_sums(subset, patch, &fit->motion, sums);
    double gain = sums->plane[SUBSET_GREY] / subset->energy;
    if (!(gain > 0))
        return 2;
    if (fit->near) /* what is left is noise: take it out of H, whose steps it makes too short */
        clean_inverse(subset, residual_variance(subset, sums, gain) / (1 + gain * gain), inverse);
    else
        memcpy(inverse, subset->inverse, sizeof inverse);
    for (int i = 0; i < 3; i++)
        step[i] =
            (inverse[i][0] * sums->plane[0] + inverse[i][1] * sums->plane[1] + inverse[i][2] * sums->plane[2]) / gain;
    double moved = hypot(step[0], step[1]) + fabs(step[2]) * subset->shape.radius;
    if (!(moved <= 2 * options->reach))
        return 2;
    fit->near = moved < 0.5;
    fit->motion = motion_compose_inverse(fit->motion, (struct motion){step[0], step[1], step[2]});
    return moved <= options->tolerance;
}

/* Iterations on one spline until they stand still, stray, or are too many. */
static int converge(const struct subset *subset, const struct photo *photo, const struct motion *start,
                    const struct icgn_options *options, enum bspline_order order, struct patch *patch, struct fit *fit)
{
    struct kernel_sums sums = {0};
    fit->converged = 0;
    for (int fresh = 1;; fresh = 0) {
        int state = iterate(subset, photo, options, order, fresh, patch, &sums, fit);
        double away = hypot(fit->motion.u - start->u, fit->motion.v - start->v) +
                      fabs(fit->motion.angle - start->angle) * subset->shape.radius;
        if (state < 0)
            return -1;
        fit->converged = state == 1;
        if (state || fit->iterations >= options->iterations || away > options->reach)
            break;
    }
    judge(subset, &sums, order, fit);
    return 0;
}

int icgn_fit(const struct subset *subset, const struct photo *photo, struct motion start,
             const struct icgn_options *options, struct patch *patch, struct fit *fit)
{
    *fit = (struct fit){.motion = start};
    if (converge(subset, photo, &start, options, BSPLINE_CUBIC, patch, fit))
        return -1;
    if (options->coarse || !fit->converged)
        return 0;
    if (!needs_quintic(subset, fit))
        return measure_scatter(subset, photo, BSPLINE_CUBIC, patch, fit);
    fit->fine = 1;
    if (converge(subset, photo, &start, options, BSPLINE_QUINTIC, patch, fit))
        return -1;
    return fit->converged ? measure_scatter(subset, photo, BSPLINE_QUINTIC, patch, fit) : 0;
}
