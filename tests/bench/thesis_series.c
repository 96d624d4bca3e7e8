/* Thesis 3.4 and 3.5: estimates along a biaxial test, from several starts. */
#include <stdlib.h>
#include <string.h>

#include "forces/methods/known_forces.h"
#include "pipeline/speak/error.h"
#include "tests/bench/thesis.h"

enum { STEPS = 16, STATES = STEPS + 1 };
#define STEP_STRAIN 2.5e-3
#define GRAINS 400
#define UNREST 600 /* steps of relaxation of a state that is not allowed to come to rest */

/* How each state of a chain starts. */
enum kind {
    FROM_ZERO,
    FROM_OVERLAP,
    FROM_PREVIOUS,   /* own forces of the state before; the first from zero */
    FROM_TANGENTIAL, /* overlaps, and own tangential forces of the state before */
    HOLD_NORMAL,     /* the true normal forces, held */
    HOLD_TANGENTIAL
};

struct curve {
    double kappa;
    enum force_method method;
    enum kind kind;
    const char *name;
    long patience; /* 0: states at rest */
};

struct step {
    double strain, h, rn, rt, strong, weak, imbalance;
    double stress[2], true_stress[2];
    int converged;
};

static int test_states(const struct thesis *thesis, double kappa, long patience, struct states *states)
{
    const struct thesis_test test = {GRAINS, kappa, STEPS, STEP_STRAIN, 1, patience};
    return thesis_states(thesis, &test, states);
}

/* Normal forces of the overlaps, tangential ones of the state before. */
static int mixed_start(const struct packing *packing, const struct packing *previous, struct packing *start)
{
    long *match = match_contacts(&packing->contacts, &previous->contacts);
    if (!match || packing_copy(packing, start))
        return -1;
    const struct forces *before = packing_forces(previous, "qsm");
    struct contact_forces *forces = &start->forces[0].contact;
    for (size_t c = 0; c < forces->count; c++) {
        forces->fn[c] = fmax(0, 1.09e7 * packing->contacts.overlap[c]);
        forces->ft[c] = match[c] >= 0 && before ? before->contact.ft[match[c]] : 0;
    }
    free(match);
    return 0;
}

static int run_state(struct states *states, size_t s, const struct curve *curve, struct trial *trial)
{
    struct packing *packing = &states->state[s], start = {0};
    struct force_options options = thesis_options(curve->kind == FROM_OVERLAP ? START_OVERLAP : START_ZERO);
    int status = 0;
    if (curve->kind == FROM_PREVIOUS && s > 0) {
        options.start = START_PREVIOUS, options.previous = &states->state[s - 1];
    } else if (curve->kind == FROM_TANGENTIAL && s > 0) {
        status = mixed_start(packing, &states->state[s - 1], &start);
        options.start = START_FILE, options.from = &start;
    } else if (curve->kind == FROM_TANGENTIAL) {
        options.start = START_OVERLAP;
    } else if (curve->kind >= HOLD_NORMAL) {
        options.start = START_FILE, options.from = packing;
        options.fix = curve->kind == HOLD_NORMAL ? FIX_NORMAL : FIX_TANGENTIAL;
        options.tolerance = 1e-5;
        status = packing_copy(packing, &start);
        for (size_t c = 0; !status && c < start.contacts.count; c++)
            (options.fix == FIX_NORMAL ? start.forces[0].contact.ft : start.forces[0].contact.fn)[c] = 0;
        options.from = &start;
    }
    if (!status)
        status = thesis_try(packing, packing, &options, curve->method, trial);
    packing_free(&start);
    return status;
}

static int run_curve(struct thesis *thesis, const struct curve *curve, struct step steps[STATES])
{
    struct states states;
    if (test_states(thesis, curve->kappa, curve->patience, &states))
        return -1;
    for (size_t s = 0; s < states.count; s++) {
        struct trial trial = {0};
        if (run_state(&states, s, curve, &trial))
            return -1;
        const struct forces *truth = packing_forces(&states.state[s], "dem");
        steps[s] = (struct step){.strain = 100 * thesis_strain(&states, s),
                                 .h = thesis_indeterminacy(&states.state[s]),
                                 .rn = trial.rn,
                                 .rt = trial.rt,
                                 .strong = trial.strong,
                                 .weak = trial.weak,
                                 .imbalance = trial.forces.imbalance,
                                 .converged = trial.forces.converged};
        for (int k = 0; k < 2; k++)
            steps[s].stress[k] = trial.forces.stress[k][k] / 1e3, steps[s].true_stress[k] = truth->stress[k][k] / 1e3;
        int status = thesis_keep(&states.state[s], &trial.forces); /* for the next one */
        trial_free(&trial);
        if (status)
            return -1;
    }
    states_free(&states);
    return 0;
}

static void say(struct thesis *thesis, const struct curve *curve, const struct step steps[STATES])
{
    double n = 0, t = 0, worst_n = 1, worst_t = 1, balanced = 0;
    for (int s = 0; s < STATES; s++) {
        n += steps[s].rn / STATES, t += steps[s].rt / STATES;
        worst_n = fmin(worst_n, steps[s].rn), worst_t = fmin(worst_t, steps[s].rt);
        balanced += steps[s].converged;
    }
    thesis_line(thesis, "%-26s r(fn) mean %.3f least %.3f, r(ft) mean %.3f least %.3f, %2.0f of %d states converged",
                curve->name, n, worst_n, t, worst_t, balanced, STATES);
}

/* r(fn) and r(ft) along the test, one line per curve. */
static int along(struct thesis *thesis, const struct curve *curves, int count, int only_if_held)
{
    struct chart charts[] = {{.title = "normal forces", .x_label = "vertical strain, %", .y_label = "r(fn)"},
                             {.title = "tangential forces", .x_label = "vertical strain, %", .y_label = "r(ft)"}};
    for (int k = 0; k < count; k++) {
        struct step steps[STATES];
        struct chart_line *lines[2] = {chart_add(&charts[0], curves[k].name, STATES),
                                       chart_add(&charts[1], curves[k].name, STATES)};
        if (!lines[0] || !lines[1] || run_curve(thesis, &curves[k], steps))
            return -1;
        say(thesis, &curves[k], steps);
        for (int s = 0; s < STATES; s++) {
            if (!only_if_held || curves[k].kind != HOLD_NORMAL)
                chart_put(lines[0], steps[s].strain, steps[s].rn);
            if (!only_if_held || curves[k].kind != HOLD_TANGENTIAL)
                chart_put(lines[1], steps[s].strain, steps[s].rt);
        }
    }
    return thesis_picture(thesis, charts, 2);
}

#define ALONG(number, held, ...)                                                                                       \
    static int figure_##number(struct thesis *thesis)                                                                  \
    {                                                                                                                  \
        static const struct curve curves[] = {__VA_ARGS__};                                                            \
        return along(thesis, curves, sizeof curves / sizeof *curves, held);                                            \
    }

ALONG(3_12, 0, {100, METHOD_QSM, FROM_OVERLAP, "kappa 100", 0}, {10000, METHOD_QSM, FROM_OVERLAP, "kappa 10000", 0})
ALONG(3_13, 0, {100, METHOD_QSM, FROM_ZERO, "kappa 100", 0}, {1000, METHOD_QSM, FROM_ZERO, "kappa 1000", 0},
      {10000, METHOD_QSM, FROM_ZERO, "kappa 10000", 0})
ALONG(3_14, 0, {100, METHOD_QSM, FROM_ZERO, "zero", 0}, {100, METHOD_QSM, FROM_PREVIOUS, "previous", 0},
      {100, METHOD_QSM, FROM_OVERLAP, "overlaps", 0}, {100, METHOD_QSM, FROM_TANGENTIAL, "overlaps, previous ft", 0})
ALONG(3_15, 0, {100, METHOD_QSM, FROM_OVERLAP, "at rest", 0}, {100, METHOD_QSM, FROM_OVERLAP, "not at rest", UNREST})
ALONG(3_21, 0, {100, METHOD_CDM, FROM_ZERO, "kappa 100", 0}, {1000, METHOD_CDM, FROM_ZERO, "kappa 1000", 0},
      {10000, METHOD_CDM, FROM_ZERO, "kappa 10000", 0})
ALONG(3_23, 0, {100, METHOD_CDM, FROM_ZERO, "zero", 0}, {100, METHOD_CDM, FROM_PREVIOUS, "previous", 0})
ALONG(3_25, 1, {1000, METHOD_CDM, FROM_ZERO, "zero", 0}, {1000, METHOD_CDM, HOLD_NORMAL, "true fn held", 0},
      {1000, METHOD_CDM, HOLD_TANGENTIAL, "true ft held", 0})
ALONG(3_26, 0, {1000, METHOD_CDM, FROM_ZERO, "zero", 0}, {1000, METHOD_CDM, FROM_OVERLAP, "true fn", 0})
ALONG(3_27, 0, {100, METHOD_CDM, FROM_ZERO, "at rest", 0}, {100, METHOD_CDM, FROM_ZERO, "not at rest", UNREST})
ALONG(3_39, 0, {100, METHOD_CDM, FROM_ZERO, "cdm", 0}, {100, METHOD_QSM, FROM_ZERO, "qsm", 0})

/* ---- other quantities along the test ---- */

static int figure_3_24(struct thesis *thesis)
{
    static const struct curve curves[] = {{100, METHOD_CDM, FROM_ZERO, "zero", 0},
                                          {100, METHOD_CDM, FROM_PREVIOUS, "previous", 0}};
    struct chart chart = {.title = "3.24 Weber stress", .x_label = "vertical strain, %", .y_label = "stress, kPa"};
    for (int k = 0; k < 2; k++) {
        struct step steps[STATES];
        double worst = 0;
        if (run_curve(thesis, &curves[k], steps))
            return -1;
        for (int a = 0; a < 2; a++) {
            char name[40];
            snprintf(name, sizeof name, "%s %s", curves[k].name, a ? "yy" : "xx");
            struct chart_line *line = chart_add(&chart, name, STATES),
                              *truth = k ? NULL : chart_add(&chart, a ? "truth yy" : "truth xx", STATES);
            for (int s = 0; line && s < STATES; s++) {
                chart_put(line, steps[s].strain, steps[s].stress[a]);
                if (truth)
                    chart_put(truth, steps[s].strain, steps[s].true_stress[a]);
                worst = fmax(worst, fabs(steps[s].stress[a] / steps[s].true_stress[a] - 1));
            }
        }
        thesis_line(thesis, "cdm from %-9s largest error of a stress component %.2f %%", curves[k].name, 100 * worst);
    }
    return thesis_picture(thesis, &chart, 1);
}

static int figure_3_40(struct thesis *thesis)
{
    static const struct curve curve = {100, METHOD_CDM, FROM_ZERO, "zero", 0};
    struct chart chart = {
        .title = "3.40 strong and weak network, cdm", .x_label = "vertical strain, %", .y_label = "r(fn)"};
    struct chart_line *lines[] = {chart_add(&chart, "all", STATES), chart_add(&chart, "strong", STATES),
                                  chart_add(&chart, "weak", STATES)};
    struct step steps[STATES];
    double sum[3] = {0};
    if (!lines[2] || run_curve(thesis, &curve, steps))
        return -1;
    for (int s = 0; s < STATES; s++) {
        const double values[] = {steps[s].rn, steps[s].strong, steps[s].weak};
        for (int k = 0; k < 3; k++)
            chart_put(lines[k], steps[s].strain, values[k]), sum[k] += values[k] / STATES;
    }
    thesis_line(thesis, "mean r(fn): all %.3f, strong (above <fn>) %.3f, weak %.3f", sum[0], sum[1], sum[2]);
    return thesis_picture(thesis, &chart, 1);
}

/* ---- r against h ---- */

static int against_h(struct thesis *thesis, const struct curve *curves, int count)
{
    struct chart charts[] = {
        {.title = "normal forces", .x_label = "h / contacts between free bodies, 1", .y_label = "r(fn)"},
        {.title = "tangential forces", .x_label = "h / contacts between free bodies, 1", .y_label = "r(ft)"}};
    charts[0].x_label = charts[1].x_label = "h";
    for (int k = 0; k < count; k++) {
        struct step steps[STATES];
        double h = 0, n = 0, t = 0;
        struct chart_line *lines[2] = {thesis_scatter(&charts[0], curves[k].name, STATES),
                                       thesis_scatter(&charts[1], curves[k].name, STATES)};
        if (!lines[0] || !lines[1] || run_curve(thesis, &curves[k], steps))
            return -1;
        for (int s = 0; s < STATES; s++) {
            thesis_point(lines[0], steps[s].h, steps[s].rn), thesis_point(lines[1], steps[s].h, steps[s].rt);
            h += steps[s].h / STATES, n += steps[s].rn / STATES, t += steps[s].rt / STATES;
        }
        thesis_line(thesis, "%-24s mean h %.0f (state 0: %.0f), mean r %.3f / %.3f", curves[k].name, h, steps[0].h, n,
                    t);
    }
    return thesis_picture(thesis, charts, 2);
}

static int figure_3_36(struct thesis *thesis)
{
    static const struct curve curves[] = {{100, METHOD_CDM, FROM_ZERO, "kappa 100", 0},
                                          {1000, METHOD_CDM, FROM_ZERO, "kappa 1000", 0},
                                          {10000, METHOD_CDM, FROM_ZERO, "kappa 10000", 0}};
    return against_h(thesis, curves, 3);
}

static int figure_3_37(struct thesis *thesis)
{
    static const struct curve curves[] = {{100, METHOD_QSM, FROM_ZERO, "100", 0},
                                          {1000, METHOD_QSM, FROM_ZERO, "1000", 0},
                                          {10000, METHOD_QSM, FROM_ZERO, "10000", 0},
                                          {100, METHOD_QSM, FROM_OVERLAP, "100 overlaps", 0},
                                          {1000, METHOD_QSM, FROM_OVERLAP, "1000 overlaps", 0},
                                          {10000, METHOD_QSM, FROM_OVERLAP, "10000 overlaps", 0}};
    return against_h(thesis, curves, 6);
}

static int figure_3_38(struct thesis *thesis)
{
    static const struct curve curve = {100, METHOD_CDM, FROM_ZERO, "cdm", 0};
    struct chart charts[] = {{.title = "3.38 indeterminacy", .x_label = "vertical strain, %", .y_label = "h"},
                             {.title = "3.38 cdm from zero", .x_label = "vertical strain, %", .y_label = "r"}};
    struct chart_line *h = chart_add(&charts[0], "", STATES), *n = chart_add(&charts[1], "fn", STATES),
                      *t = chart_add(&charts[1], "ft", STATES);
    struct step steps[STATES];
    double mh = 0, mr = 0, hh = 0, rr = 0, hr = 0;
    if (!h || !n || !t || run_curve(thesis, &curve, steps))
        return -1;
    for (int s = 0; s < STATES; s++) {
        chart_put(h, steps[s].strain, steps[s].h), chart_put(n, steps[s].strain, steps[s].rn),
            chart_put(t, steps[s].strain, steps[s].rt);
        mh += steps[s].h / STATES, mr += steps[s].rn / STATES;
    }
    for (int s = 0; s < STATES; s++) {
        double dh = steps[s].h - mh, dr = steps[s].rn - mr;
        hh += dh * dh, rr += dr * dr, hr += dh * dr;
    }
    thesis_line(thesis, "h %.0f +- %.0f; within this one test h and r(fn) correlate by %.2f", mh, sqrt(hh / STATES),
                hr / sqrt(hh * rr));
    return thesis_picture(thesis, charts, 2);
}

/* ---- convergence of a state at rest and of one that is not ---- */

static const int COUNTS[] = {1, 2, 5, 10, 20, 50, 100, 200, 500, 1000, 2000, 4000};
enum { COUNT_COUNT = sizeof COUNTS / sizeof *COUNTS, STATE = STEPS };

/* Mean |un| of the velocities that cdm has after these forces, time step 1. */
static int mean_velocity(const struct packing *packing, const struct force_options *options,
                         const struct forces *forces, double *mean)
{
    struct network network;
    struct network_options network_options = {.wall_mass = options->wall_mass};
    if (network_build(packing, &options->law, &network_options, &network))
        return -1;
    double *f = calloc(2 * network.count + 1, sizeof *f), *v = calloc(network.dofs + 1, sizeof *v),
           *u = calloc(2 * network.count + 1, sizeof *u);
    *mean = 0;
    for (size_t c = 0; f && v && u && c < network.count; c++) {
        f[2 * c] = forces->contact.fn[network.contact[c].row] / network.force;
        f[2 * c + 1] = forces->contact.ft[network.contact[c].row] / network.force;
    }
    if (f && v && u) {
        network_unbalance(&network, f, v);
        for (size_t k = 0; k < network.dofs; k++)
            v[k] *= network.inverse_mass[k];
        network_motion(&network, v, u);
        for (size_t c = 0; c < network.count; c++)
            *mean += fabs(u[2 * c]) / (double)network.count;
    }
    free(f), free(v), free(u);
    network_free(&network);
    return 0;
}

static int figure_3_16(struct thesis *thesis)
{
    struct chart chart = {.title = "3.16 plain projections, last state",
                          .x_label = "log10 iterations",
                          .y_label = "residual / <fn>",
                          .log_y = 1};
    for (int rest = 0; rest < 2; rest++) {
        struct states states;
        struct chart_line *line = chart_add(&chart, rest ? "at rest" : "not at rest", COUNT_COUNT);
        double rn = 0, rt = 0;
        if (!line || test_states(thesis, 100, rest ? 0 : UNREST, &states))
            return -1;
        for (int k = 0; k < COUNT_COUNT; k++) {
            struct force_options options = thesis_options(START_OVERLAP);
            struct trial trial = {0};
            options.anderson = 0, options.iterations = COUNTS[k], options.tolerance = 1e-12;
            if (thesis_try(&states.state[STATE], &states.state[STATE], &options, METHOD_QSM, &trial))
                return -1;
            chart_put(line, log10(COUNTS[k]), trial.forces.imbalance);
            thesis_line(thesis, "%-12s %5d iterations: residual %.2e", rest ? "at rest" : "not at rest", COUNTS[k],
                        trial.forces.imbalance);
            rn = trial.rn, rt = trial.rt;
            trial_free(&trial);
        }
        thesis_line(thesis, "%-12s r(fn) %.4f, r(ft) %.4f", rest ? "at rest" : "not at rest", rn, rt);
        states_free(&states);
    }
    return thesis_picture(thesis, &chart, 1);
}

static int figure_3_28(struct thesis *thesis)
{
    struct chart charts[] = {
        {.title = "3.28 a state at rest", .x_label = "log10 sweeps", .y_label = "mean |un|", .log_y = 1},
        {.title = "3.28 a state not at rest", .x_label = "log10 sweeps", .y_label = "mean |un|", .log_y = 1}};
    for (int rest = 0; rest < 2; rest++)
        for (int previous = 0; previous < 2; previous++) {
            struct states states;
            struct chart_line *line = chart_add(&charts[!rest ? 1 : 0], previous ? "previous" : "zero", COUNT_COUNT);
            if (!line || test_states(thesis, 100, rest ? 0 : UNREST, &states))
                return -1;
            struct packing *before = &states.state[STATE - 1], *here = &states.state[STATE];
            for (int k = 0; k < COUNT_COUNT; k++) {
                struct force_options options = thesis_options(previous ? START_PREVIOUS : START_ZERO);
                struct forces forces;
                double mean;
                options.previous = before, options.iterations = COUNTS[k], options.tolerance = 1e-12;
                if (infer_forces(here, &options, METHOD_CDM, &forces) || mean_velocity(here, &options, &forces, &mean))
                    return -1;
                chart_put(line, log10(COUNTS[k]), mean);
                if (k % 3 == 2)
                    thesis_line(thesis, "%-12s from %-9s %5d sweeps: mean |un| %.2e, residual %.1e",
                                rest ? "at rest" : "not at rest", previous ? "previous" : "zero", COUNTS[k], mean,
                                forces.imbalance);
                forces_free(&forces);
            }
            states_free(&states);
        }
    return thesis_picture(thesis, charts, 2);
}

const struct figure FIGURES_SERIES[] = {{"3.12", "qsm from overlaps along the test", figure_3_12},
                                        {"3.13", "qsm from zero along the test", figure_3_13},
                                        {"3.14", "qsm, kappa 100, by its start", figure_3_14},
                                        {"3.15", "qsm on states at rest and not", figure_3_15},
                                        {"3.16", "convergence of qsm on a state at rest and not", figure_3_16},
                                        {"3.21", "cdm from zero along the test", figure_3_21},
                                        {"3.23", "cdm, kappa 100, from zero and from the state before", figure_3_23},
                                        {"3.24", "stress of these", figure_3_24},
                                        {"3.25", "cdm, kappa 1000, true normal or tangential forces held", figure_3_25},
                                        {"3.26", "cdm, kappa 1000, started from the true normal forces", figure_3_26},
                                        {"3.27", "cdm on states at rest and not", figure_3_27},
                                        {"3.28", "convergence of cdm on a state at rest and not", figure_3_28},
                                        {"3.36", "r of cdm against indeterminacy", figure_3_36},
                                        {"3.37", "r of qsm against indeterminacy", figure_3_37},
                                        {"3.38", "indeterminacy and r along one test", figure_3_38},
                                        {"3.39", "cdm and qsm from zero, kappa 100", figure_3_39},
                                        {"3.40", "strong and weak network of cdm, kappa 100", figure_3_40},
                                        {NULL, NULL, NULL}};
