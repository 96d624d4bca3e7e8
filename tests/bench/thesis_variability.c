/* Thesis 3.5.6: how far forces can differ at all, by a random walk on packings of 12 grains, beside the exact ranges of
 * linear programmes. */
#include <stdlib.h>
#include <string.h>

#include "forces/questions/range.h"
#include "forces/questions/walk.h"
#include "pipeline/speak/error.h"
#include "tests/bench/thesis.h"

enum { STEPS = 16, STATES = STEPS + 1, JUMPS = 200 };

struct step {
    double strain, h, rn, rt;
    struct walk_summary walk;
    double low_high; /* mean exact range of fn, over <fn> */
    double seen;     /* share of it that the walk covers */
};

static int look(struct states *states, size_t s, enum force_method method, struct step *step)
{
    struct packing *packing = &states->state[s];
    struct force_options options = thesis_options(START_ZERO);
    struct trial trial = {0};
    options.tolerance = 1e-3, options.iterations = 4000;
    options.walk = JUMPS, options.range = "all";
    if (thesis_try(packing, packing, &options, method, &trial) ||
        walk_forces(packing, &options, method, &trial.forces) || range_forces(packing, &options, method, &trial.forces))
        return -1;
    const struct contact_forces *forces = &trial.forces.contact;
    double mean = states_mean_force(packing), used = 0;
    *step = (struct step){.strain = 100 * thesis_strain(states, s),
                          .h = thesis_indeterminacy(packing),
                          .rn = trial.rn,
                          .rt = trial.rt,
                          .walk = trial.forces.walk};
    for (size_t c = 0; c < forces->count; c++)
        if (forces->status[c] != STATUS_NOT_USED && isfinite(forces->fn_high[c] - forces->fn_low[c]))
            step->low_high += (forces->fn_high[c] - forces->fn_low[c]) / mean, used++;
    step->low_high = used > 0 ? step->low_high / used : NAN;
    step->seen = step->walk.range[0] / step->low_high;
    trial_free(&trial);
    return 0;
}

static double correlation(const struct step *steps, double (*a)(const struct step *), double (*b)(const struct step *))
{
    double n = 0, ma = 0, mb = 0, aa = 0, bb = 0, ab = 0;
    for (int s = 0; s < STATES; s++)
        if (steps[s].walk.states >= 20)
            n++, ma += a(&steps[s]), mb += b(&steps[s]);
    ma /= n, mb /= n;
    for (int s = 0; s < STATES; s++)
        if (steps[s].walk.states >= 20) {
            double x = a(&steps[s]) - ma, y = b(&steps[s]) - mb;
            aa += x * x, bb += y * y, ab += x * y;
        }
    return ab / sqrt(aa * bb);
}

static double rn_of(const struct step *step)
{
    return step->rn;
}

static double rt_of(const struct step *step)
{
    return step->rt;
}

static double vn_of(const struct step *step)
{
    return step->walk.variance[0];
}

static double vt_of(const struct step *step)
{
    return step->walk.variance[1];
}

static double range_n_of(const struct step *step)
{
    return step->walk.range[0];
}

static double range_t_of(const struct step *step)
{
    return step->walk.range[1];
}

static double h_of(const struct step *step)
{
    return step->h;
}

static int figures(struct thesis *thesis, int ranges)
{
    struct chart charts[] = {{.title = "normal forces", .x_label = "vertical strain, %", .y_label = "1"},
                             {.title = "tangential forces", .x_label = "vertical strain, %", .y_label = "1"}};
    static const double kappas[] = {100, 10000};
    for (int k = 0; k < 2; k++) {
        const struct thesis_test test = {.grains = 12, .kappa = kappas[k], .steps = STEPS, .strain = 1e-2, .seed = 3};
        struct states states;
        struct step steps[STATES];
        if (thesis_states(thesis, &test, &states))
            return -1;
        double sum[3] = {0}, rejected = 0;
        for (int s = 0; s < STATES; s++) {
            if (look(&states, (size_t)s, METHOD_CDM, &steps[s]))
                return -1;
            sum[0] += (ranges ? steps[s].walk.range[0] : steps[s].walk.variance[0]) / STATES;
            sum[1] += (ranges ? steps[s].walk.range[1] : steps[s].walk.variance[1]) / STATES;
            sum[2] += isfinite(steps[s].seen) ? steps[s].seen / STATES : 0;
            rejected += (JUMPS + 1 - steps[s].walk.states) / ((JUMPS + 1.0) * STATES);
        }
        thesis_line(thesis,
                    "kappa %g: mean %s(fn) %.3f, %s(ft) %.3f; %.0f %% of the jumps found no equilibrium; the walk saw "
                    "%.0f %% of the exact range of fn",
                    kappas[k], ranges ? "R" : "V", sum[0], ranges ? "R" : "V", sum[1], 100 * rejected, 100 * sum[2]);
        thesis_line(
            thesis,
            "  correlation along the test of %s(fn) with r(fn) %.2f, of %s(ft) with r(ft) %.2f; of h with r(fn) %.2f",
            ranges ? "R" : "V", correlation(steps, ranges ? range_n_of : vn_of, rn_of), ranges ? "R" : "V",
            correlation(steps, ranges ? range_t_of : vt_of, rt_of), correlation(steps, h_of, rn_of));
        for (int part = 0; part < 2 && k == 0; part++) {
            struct chart_line *size = chart_add(&charts[part], ranges ? "R" : "V", STATES),
                              *r = chart_add(&charts[part], "r", STATES);
            for (int s = 0; size && r && s < STATES; s++) {
                chart_put(size, steps[s].strain, ranges ? steps[s].walk.range[part] : steps[s].walk.variance[part]);
                chart_put(r, steps[s].strain, part ? steps[s].rt : steps[s].rn);
            }
        }
        for (int s = 0; s < STATES && k == 0; s += 4)
            thesis_line(thesis,
                        "  strain %5.2f %%: h %3.0f, V %.3f %.3f, R %.3f %.3f, exact range of fn %.3f, r %.3f / %.3f",
                        steps[s].strain, steps[s].h, steps[s].walk.variance[0], steps[s].walk.variance[1],
                        steps[s].walk.range[0], steps[s].walk.range[1], steps[s].low_high, steps[s].rn, steps[s].rt);
        states_free(&states);
    }
    return thesis_picture(thesis, charts, 2);
}

static int figure_3_34(struct thesis *thesis)
{
    return figures(thesis, 0);
}

static int figure_3_35(struct thesis *thesis)
{
    return figures(thesis, 1);
}

const struct figure FIGURES_VARIABILITY[] = {
    {"3.34", "mean normalised variance, 12 grains, 200 jumps of cdm", figure_3_34},
    {"3.35", "mean normalised range, 12 grains", figure_3_35},
    {NULL, NULL, NULL}};
