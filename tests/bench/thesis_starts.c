/* Thesis 3.2, 3.5.1: one isotropic state, and what an estimate owes to its start. */
#include <stdlib.h>
#include <string.h>

#include "pipeline/speak/error.h"
#include "pipeline/numbers/random.h"
#include "tests/bench/thesis.h"

static const double KAPPAS[] = {100, 1000, 10000};

static int isotropic(const struct thesis *thesis, double kappa, struct states *states)
{
    const struct thesis_test test = {.grains = 600, .kappa = kappa, .seed = 1};
    return thesis_states(thesis, &test, states);
}

/* The truth with normal errors of this size (over <fn>) on both components; inside the cones again. */
static int disturbed(const struct packing *truth, double size, struct packing *start)
{
    if (packing_copy(truth, start))
        return -1;
    struct contact_forces *forces = &start->forces[0].contact;
    double mean = states_mean_force(truth);
    for (size_t c = 0; c < forces->count; c++) {
        int wall = truth->contacts.j[c] >= (int64_t)truth->grains.count;
        forces->fn[c] += size * mean * random_normal(303, 2 * c);
        forces->ft[c] += size * mean * random_normal(303, 2 * c + 1);
        coulomb_clip(wall ? 0 : 0.5, &forces->fn[c], &forces->ft[c]);
    }
    return 0;
}

static double length_between(const struct packing *truth, const struct packing *other)
{
    const struct contact_forces *a = &truth->forces[0].contact, *b = &other->forces[0].contact;
    double sum = 0;
    for (size_t c = 0; c < a->count; c++)
        sum += hypot(a->fn[c] - b->fn[c], a->ft[c] - b->ft[c]);
    return sum / (double)a->count / states_mean_force(truth);
}

/* ---- 3.3 ---- */

static const double SIZES[] = {0.01, 0.03, 0.1, 0.3, 1, 3, 10};
enum { SIZE_COUNT = sizeof SIZES / sizeof *SIZES };

static int random_starts(struct thesis *thesis, const struct packing *truth, double kappa, enum force_method method,
                         struct chart_line *line)
{
    for (int s = 0; s < SIZE_COUNT; s++) {
        struct force_options options = thesis_options(START_FILE);
        struct packing start;
        struct trial trial = {0};
        if (disturbed(truth, SIZES[s], &start))
            return -1;
        options.from = &start;
        double before = length_between(truth, &start);
        int status = thesis_try(truth, truth, &options, method, &trial);
        if (!status) {
            thesis_line(thesis, "%8g %-5s random %-8g %10.4f %10.4f %9.1e", kappa, method_row(method)->name, SIZES[s],
                        before, trial.distance, trial.forces.imbalance);
            chart_put(line, log10(before), trial.distance);
        }
        trial_free(&trial);
        packing_free(&start);
        if (status)
            return -1;
    }
    return 0;
}

/* Null, mean, true normal forces, and these held. */
static int special_starts(struct thesis *thesis, const struct packing *truth, double kappa, enum force_method method)
{
    static const char *const names[] = {"null", "mean fn", "true fn", "true fn held"};
    for (int s = 0; s < 4; s++) {
        struct force_options options = thesis_options(s == 0 ? START_ZERO : s == 1 ? START_MEAN : START_OVERLAP);
        struct trial trial = {0};
        options.fix = s == 3 ? FIX_NORMAL : FIX_NONE;
        if (s == 3)
            options.tolerance = 1e-5; /* of overlaps that are exact to the state's own 1e-8 */
        if (thesis_try(truth, truth, &options, method, &trial))
            return -1;
        thesis_line(thesis, "%8g %-5s %-26s %10.4f %9.1e   r %.4f / %.4f", kappa, method_row(method)->name, names[s],
                    trial.distance, trial.forces.imbalance, trial.rn, trial.rt);
        trial_free(&trial);
    }
    return 0;
}

static int figure_3_3(struct thesis *thesis)
{
    struct chart charts[] = {{.title = "3.3 contact dynamics",
                              .x_label = "log10 distance of the start",
                              .y_label = "distance of the end",
                              .log_y = 1},
                             {.title = "3.3 quasi-static method",
                              .x_label = "log10 distance of the start",
                              .y_label = "distance of the end",
                              .log_y = 1}};
    thesis_line(thesis, "%8s %-5s %-15s %10s %10s %9s", "kappa", "", "start", "distance 0", "distance", "residual");
    for (int k = 0; k < 3; k++) {
        struct states states;
        if (isotropic(thesis, KAPPAS[k], &states))
            return -1;
        for (int m = 0; m < 2; m++) {
            char name[40];
            snprintf(name, sizeof name, "kappa %g", KAPPAS[k]);
            struct chart_line *line = chart_add(&charts[m], name, SIZE_COUNT);
            if (!line || random_starts(thesis, &states.state[0], KAPPAS[k], m ? METHOD_QSM : METHOD_CDM, line) ||
                special_starts(thesis, &states.state[0], KAPPAS[k], m ? METHOD_QSM : METHOD_CDM))
                return -1;
        }
        states_free(&states);
    }
    return thesis_picture(thesis, charts, 2);
}

/* ---- 3.4: maps of contact dynamics ---- */

static int figure_3_4(struct thesis *thesis)
{
    static const double sizes[] = {0.03, 0.3, 1, 3};
    struct states states;
    struct trial trials[4] = {{0}};
    char names[4][60];
    const struct packing *packings[4];
    const struct forces *forces[4];
    const char *titles[4];
    if (isotropic(thesis, 100, &states))
        return -1;
    for (int s = 0; s < 4; s++) {
        struct force_options options = thesis_options(START_FILE);
        struct packing start;
        if (disturbed(&states.state[0], sizes[s], &start))
            return -1;
        options.from = &start;
        if (thesis_try(&states.state[0], &states.state[0], &options, METHOD_CDM, &trials[s]))
            return -1;
        packing_free(&start);
        snprintf(names[s], sizeof names[s], "r(fn) = %.2f", trials[s].rn);
        thesis_line(thesis, "start disturbed by %.2f <fn>: r(fn) %.3f, strong %.3f, weak %.3f", sizes[s], trials[s].rn,
                    trials[s].strong, trials[s].weak);
        packings[s] = &states.state[0], forces[s] = &trials[s].forces, titles[s] = names[s];
    }
    int status = thesis_maps(thesis, packings, forces, titles, 4);
    for (int s = 0; s < 4; s++)
        trial_free(&trials[s]);
    states_free(&states);
    return status;
}

/* ---- 3.22: how the errors of contact dynamics are spread ---- */

static int ascending(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static int figure_3_22(struct thesis *thesis)
{
    struct chart chart = {.title = "3.22 errors of contact dynamics from zero",
                          .x_label = "|error of fn| / <fn>",
                          .y_label = "share of the contacts"};
    thesis_line(thesis, "%8s %10s %10s %10s   %s", "kappa", "median", "75 %", "90 %", "of |error| / <fn>");
    for (int k = 0; k < 3; k++) {
        struct states states;
        struct trial trial = {0};
        struct force_options options = thesis_options(START_ZERO);
        char name[40];
        snprintf(name, sizeof name, "kappa %g", KAPPAS[k]);
        if (isotropic(thesis, KAPPAS[k], &states) ||
            thesis_try(&states.state[0], &states.state[0], &options, METHOD_CDM, &trial))
            return -1;
        size_t n = trial.forces.contact.count;
        double *error = malloc((n + 1) * sizeof *error), mean = states_mean_force(&states.state[0]);
        struct chart_line *line = chart_add(&chart, name, n);
        if (!error || !line)
            return -1;
        for (size_t c = 0; c < n; c++)
            error[c] = fabs(trial.forces.contact.fn[c] - states.state[0].forces[0].contact.fn[c]) / mean;
        qsort(error, n, sizeof *error, ascending);
        for (size_t c = 0; c < n && error[c] < 3; c++)
            chart_put(line, error[c], (double)(c + 1) / (double)n);
        thesis_line(thesis, "%8g %10.4f %10.4f %10.4f", KAPPAS[k], error[n / 2], error[3 * n / 4], error[9 * n / 10]);
        free(error);
        trial_free(&trial);
        states_free(&states);
    }
    return thesis_picture(thesis, &chart, 1);
}

/* ---- the doubtful claim: contact dynamics from zero is nearly exact at kappa = 10000 ---- */

static int claim_of(struct thesis *thesis, double kappa, uint64_t seed, struct chart_line *line, double mean[3])
{
    const struct thesis_test test = {.grains = 600, .kappa = kappa, .seed = seed};
    struct states states;
    struct trial cdm = {0}, qsm = {0};
    struct force_options options = thesis_options(START_ZERO);
    if (thesis_states(thesis, &test, &states))
        return -1;
    const struct packing *truth = &states.state[0];
    options.iterations = 100000;
    if (thesis_try(truth, truth, &options, METHOD_CDM, &cdm))
        return -1;
    options.iterations = 0;
    if (thesis_try(truth, truth, &options, METHOD_QSM, &qsm))
        return -1;
    double h = thesis_indeterminacy(truth), share = h / (double)truth->contacts.count;
    thesis_line(thesis, "%8g %5d %5.0f %10.3f   %.3f / %.3f %9.1e   %.3f / %.3f %9.1e", kappa, (int)seed, h, share,
                cdm.rn, cdm.rt, cdm.forces.imbalance, qsm.rn, qsm.rt, qsm.forces.imbalance);
    thesis_point(line, share, cdm.rn);
    mean[0] += cdm.rn / 5, mean[1] += cdm.rt / 5, mean[2] += share / 5;
    trial_free(&cdm);
    trial_free(&qsm);
    states_free(&states);
    return 0;
}

static int figure_claim(struct thesis *thesis)
{
    struct chart chart = {
        .title = "contact dynamics from zero, five packings each", .x_label = "h / contacts", .y_label = "r(fn)"};
    thesis_line(thesis, "%8s %5s %5s %10s   %-13s %9s   %-13s %9s", "kappa", "seed", "h", "h/contacts", "cdm fn / ft",
                "residual", "qsm fn / ft", "residual");
    for (int k = 0; k < 3; k++) {
        char name[40];
        double mean[3] = {0};
        snprintf(name, sizeof name, "kappa %g", KAPPAS[k]);
        struct chart_line *line = thesis_scatter(&chart, name, 5);
        for (uint64_t seed = 1; seed <= 5; seed++)
            if (!line || claim_of(thesis, KAPPAS[k], seed, line, mean))
                return -1;
        thesis_line(thesis, "kappa %g: mean r of cdm %.3f / %.3f at h / contacts %.3f", KAPPAS[k], mean[0], mean[1],
                    mean[2]);
    }
    return thesis_picture(thesis, &chart, 1);
}

const struct figure FIGURES_STARTS[] = {
    {"3.3", "distance from the truth against that of the start", figure_3_3},
    {"3.4", "force maps of contact dynamics with falling r", figure_3_4},
    {"3.22", "distribution of the errors of contact dynamics", figure_3_22},
    {"3.21b", "is contact dynamics from zero nearly exact at kappa = 10000?", figure_claim},
    {NULL, NULL, NULL}};
