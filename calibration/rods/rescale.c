/* The Weber stress of forces proportional to k_n is w = k_n / k_trial w_trial. Its components xx and yy of all states
 * are fitted to the measured ones m with one factor, least squares: r = sum(m w) / sum(w^2), variance = rest / freedom
 * / sum(w^2). With increments both are counted from the first state. k_t / k_n acts through friction and equilibrium:
 * it is sought, the factor fitted anew at each trial; its error is that of a least-squares parameter, from the second
 * derivative S'' of the rest S: s^2 = 2 S / freedom / S''. */
#include "calibration/rods/rescale.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "calibration/rods/fit.h"
#include "forces/infer_forces.h"
#include "pipeline/speak/error.h"
#include "pipeline/numbers/golden.h"
#include "pipeline/packing/stress.h"

static const double TRIAL_KN = 1e7; /* N/m: any; forces are proportional to it */
static const double MOST_RATIO = 2;
/* xx and yy: the shear stress of frictionless walls depends on where along them they are pushed, which no load tells.
 */
enum { FITTED = 2 };

/* One series while it is fitted. */
struct job {
    struct packing *states;
    size_t count;
    const struct rescale_options *options;
    double (*measured)[3], (*weber)[3];
    size_t used; /* measured components */
    int status;
};

void rescale_free(struct rescale *rescale)
{
    free(rescale->states);
    memset(rescale, 0, sizeof *rescale);
}

static void three(double sigma[2][2], double out[3])
{
    out[0] = sigma[0][0], out[1] = sigma[1][1], out[2] = 0.5 * (sigma[0][1] + sigma[1][0]);
}

static int measure(struct job *job)
{
    int first = job->options->increments;
    job->used = 0;
    for (size_t k = 0; k < job->count; k++) {
        double sigma[2][2], area;
        if (packing_area(&job->states[k], &area))
            return -1;
        stress_applied(&job->states[k], area, sigma);
        three(sigma, job->measured[k]);
        for (int c = 0; first && k && c < 3; c++)
            job->measured[k][c] -= job->measured[0][c];
    }
    for (size_t k = (size_t)first; k < job->count; k++)
        for (int c = 0; c < FITTED; c++)
            job->used += isfinite(job->measured[k][c]);
    return job->used ? 0 : error_input("no stress is measured: the walls of the files carry no loads: give loads.csv");
}

static int weber(struct packing *packing, const struct contact_forces *forces, double out[3])
{
    double sigma[2][2], area;
    if (packing_area(packing, &area))
        return -1;
    stress_weber(packing, forces->fn, forces->ft, area, sigma);
    three(sigma, out);
    return 0;
}

/* Elastic forces of the whole series with k_n = TRIAL_KN: overlaps first, then motions; each state starts from the one
 * before. */
static int elastic_series(struct job *job, double ratio)
{
    struct force_options options = FORCE_OPTIONS_DEFAULT;
    struct forces kept = {0};
    struct packing before = {0};
    int status = 0;
    options.law = job->options->law;
    options.law.row = &linear_law;
    options.law.kn = TRIAL_KN;
    options.law.kt_over_kn = ratio;
    for (size_t k = 0; k < job->count && !status; k++) {
        struct forces forces = {0};
        if (k) {
            before = job->states[k - 1]; /* borrowed: with our forces instead of the file's */
            before.forces = &kept;
            before.force_count = 1;
        }
        options.previous = k ? &before : NULL;
        status = infer_forces(&job->states[k], &options, METHOD_CEM, &forces);
        if (!status)
            status = weber(&job->states[k], &forces.contact, job->weber[k]);
        forces_free(&kept);
        kept = forces;
    }
    forces_free(&kept);
    return status;
}

static int file_forces(struct job *job)
{
    for (size_t k = 0; k < job->count; k++) {
        const struct forces *forces = packing_forces(&job->states[k], job->options->method);
        if (!forces)
            return error_input("state %lld has no forces of method '%s': run forces --method %s",
                               (long long)job->states[k].info.index, job->options->method, job->options->method);
        if (weber(&job->states[k], &forces->contact, job->weber[k]))
            return -1;
    }
    return 0;
}

/* Best factor on the Weber stresses and what it leaves: sum of squares. */
static double best_factor(const struct job *job, double *factor, double *curvature)
{
    double mw = 0, ww = 0, rest = 0;
    int first = job->options->increments;
    for (int pass = 0; pass < 2; pass++)
        for (size_t k = (size_t)first; k < job->count; k++)
            for (int c = 0; c < FITTED; c++) {
                double m = job->measured[k][c], w = job->weber[k][c] - (first ? job->weber[0][c] : 0);
                if (!isfinite(m) || !isfinite(w))
                    continue;
                if (pass)
                    rest += (m - *factor * w) * (m - *factor * w);
                else
                    mw += m * w, ww += w * w;
                if (pass == 0)
                    *factor = mw / ww;
            }
    *curvature = ww;
    return rest;
}

static double misfit_at(double ratio, void *user)
{
    struct job *job = user;
    double factor, curvature;
    if (job->status || elastic_series(job, ratio)) {
        job->status = -1;
        return INFINITY;
    }
    return best_factor(job, &factor, &curvature);
}

/* k_t / k_n by a grid and golden sections; its error from the curvature of the misfit. */
static int seek_ratio(struct job *job, struct rescale *rescale)
{
    enum { GRID = 10 };
    double best = 0, least = INFINITY, step = MOST_RATIO / GRID;
    for (int g = 0; g <= GRID; g++) {
        double misfit = misfit_at(g * step, job);
        if (misfit < least)
            least = misfit, best = g * step;
    }
    best = golden_section(misfit_at, job, fmax(0, best - step), fmin(MOST_RATIO, best + step), 1e-4);
    double h = 0.02, here = misfit_at(best, job);
    double bend = (misfit_at(best + h, job) + misfit_at(fabs(best - h), job) - 2 * here) / (h * h);
    double freedom = fmax(1, (double)job->used - 2);
    if (job->status)
        return -1;
    rescale->s_kt_over_kn = sqrt(2 * here / freedom / bend);
    if (!(bend > 0) || !(rescale->s_kt_over_kn < 1) || best > MOST_RATIO - h)
        return error_input("the stresses do not tell k_t / k_n: take states that are sheared more, or give it in the "
                           "scene and leave --tangential out");
    rescale->kt_over_kn = best;
    return elastic_series(job, best);
}

static int describe_states(const struct job *job, struct rescale *rescale)
{
    rescale->states = calloc(job->count, sizeof *rescale->states);
    if (!rescale->states)
        return error_memory("stresses");
    rescale->count = job->count;
    for (size_t k = 0; k < job->count; k++) {
        rescale->states[k].index = job->states[k].info.index;
        for (int c = 0; c < 3; c++) {
            rescale->states[k].measured[c] = job->measured[k][c];
            double since = job->options->increments && k ? job->weber[0][c] : 0;
            rescale->states[k].weber[c] = rescale->ratio * (job->weber[k][c] - since);
        }
    }
    return 0;
}

static int fit(struct job *job, struct rescale *rescale)
{
    const struct rescale_options *options = job->options;
    double before = TRIAL_KN, curvature;
    rescale->kt_over_kn = options->law.kt_over_kn;
    rescale->s_kt_over_kn = NAN;
    if (measure(job))
        return -1;
    if (options->method) {
        if (file_forces(job))
            return -1;
        before = packing_forces(&job->states[0], options->method)->kn;
    } else if (options->fit_kt ? seek_ratio(job, rescale) : elastic_series(job, rescale->kt_over_kn)) {
        return -1;
    }
    double rest = best_factor(job, &rescale->ratio, &curvature), unknowns = options->fit_kt ? 2 : 1;
    if (!(rescale->ratio > 0))
        return error_input(
            "the stiffness would be %.3g N/m: the Weber stress has the wrong sign or vanishes: check loads "
            "and overlaps",
            rescale->ratio * before);
    double freedom = (double)job->used - unknowns, squares = rest + rescale->ratio * rescale->ratio * curvature;
    rescale->s_ratio = freedom > 0 ? sqrt(rest / freedom / curvature) : NAN;
    rescale->kn = rescale->ratio * before;
    rescale->s_kn = rescale->s_ratio * before;
    rescale->rms = sqrt(rest / squares);
    return describe_states(job, rescale);
}

int rescale_fit(struct packing *states, size_t count, const struct rescale_options *options, struct rescale *rescale)
{
    struct job job = {.states = states, .count = count, .options = options};
    memset(rescale, 0, sizeof *rescale);
    if (count < (options->increments || options->fit_kt ? 2u : 1u))
        return error_input("%zu state%s: give two or more of one series", count, count == 1 ? "" : "s");
    if (isnan(options->law.mu) && !options->method)
        return error_input("no friction coefficient: give the scene contact.mu");
    job.measured = calloc(count, sizeof *job.measured);
    job.weber = calloc(count, sizeof *job.weber);
    int status = job.measured && job.weber ? fit(&job, rescale) : error_memory("stresses");
    free(job.measured);
    free(job.weber);
    if (status)
        rescale_free(rescale);
    return status;
}
