/* Thesis 3.4.2, 3.5.5: wrong radii and wrong places, which change who touches whom. */
#include <stdlib.h>
#include <string.h>

#include "pipeline/speak/error.h"
#include "tests/bench/thesis.h"

static const double KAPPAS[] = {100, 1000, 10000};
enum { MOST = 12 };

/* One state of 600 grains per kappa, and its disturbed copies. */
static int isotropic(const struct thesis *thesis, double kappa, struct states *states)
{
    const struct thesis_test test = {.grains = 600, .kappa = kappa, .seed = 1};
    return thesis_states(thesis, &test, states);
}

struct change {
    double lost, gained; /* shares of the true contacts */
};

static int touches(const struct packing *packing, size_t c)
{
    return !packing->contacts.flags || !(packing->contacts.flags[c] & CONTACT_CANDIDATE);
}

static int has(const struct packing *packing, int64_t i, int64_t j, size_t near)
{
    const struct contacts *contacts = &packing->contacts;
    for (size_t k = 0; k < contacts->count; k++) {
        size_t c = (near + k) % contacts->count;
        if (contacts->i[c] == i && contacts->j[c] == j)
            return touches(packing, c);
    }
    return 0;
}

/* r over the contacts that both have (thesis 3.4.2). */
static double r_common(const struct packing *truth, const struct packing *measured, const double *known,
                       const double *found, int walls)
{
    const struct contacts *contacts = &truth->contacts;
    double n = 0, a = 0, b = 0, aa = 0, bb = 0, ab = 0;
    for (size_t c = 0; c < contacts->count; c++) {
        if ((!walls && contacts->j[c] >= (int64_t)truth->grains.count) ||
            !has(measured, contacts->i[c], contacts->j[c], c))
            continue;
        double p = known[c], q = states_force_at(&measured->contacts, found, contacts->i[c], contacts->j[c], c);
        n++, a += p, b += q, aa += p * p, bb += q * q, ab += p * q;
    }
    return (ab - a * b / n) / sqrt((aa - a * a / n) * (bb - b * b / n));
}

static struct change changes(const struct packing *truth, const struct packing *measured)
{
    struct change change = {0};
    double n = (double)truth->contacts.count;
    for (size_t c = 0; c < truth->contacts.count; c++)
        change.lost += !has(measured, truth->contacts.i[c], truth->contacts.j[c], c) / n;
    for (size_t c = 0; c < measured->contacts.count; c++)
        change.gained += (touches(measured, c) && !has(truth, measured->contacts.i[c], measured->contacts.j[c], c)) / n;
    return change;
}

/* qsm as in the thesis: from overlaps rescaled to the loads; cdm from zero. */
static int estimate(const struct packing *measured, enum force_method method, struct forces *forces)
{
    struct force_options options = thesis_options(method == METHOD_QSM ? START_OVERLAP : START_ZERO);
    options.rescale = method == METHOD_QSM;
    options.candidates = 0; /* the contacts as they are decided */
    options.iterations = method == METHOD_QSM ? 600 : 3000;
    return infer_forces(measured, &options, method, forces);
}

/* Disturbances in units of the mean overlap; radii: of every radius, else of the places. */
static int decay(struct thesis *thesis, enum force_method method, int radii, const double *sizes, int count)
{
    struct chart charts[] = {{.title = "normal forces",
                              .x_label = radii ? "contacts gained - lost, %" : "contacts lost + gained, %",
                              .y_label = "r(fn)"},
                             {.title = "tangential forces",
                              .x_label = radii ? "contacts gained - lost, %" : "contacts lost + gained, %",
                              .y_label = "r(ft)"}};
    thesis_line(thesis, "%8s %10s %8s %9s %8s %8s %9s", "kappa", radii ? "radii by" : "places by", "lost, %",
                "gained, %", "r(fn)", "r(ft)", "residual");
    for (int k = 0; k < 3; k++) {
        struct states states;
        char name[40];
        snprintf(name, sizeof name, "kappa %g", KAPPAS[k]);
        struct chart_line *lines[] = {chart_add(&charts[0], name, MOST), chart_add(&charts[1], name, MOST)};
        if (!lines[0] || !lines[1] || isotropic(thesis, KAPPAS[k], &states))
            return -1;
        const struct packing *truth = &states.state[0];
        const struct contact_forces *known = &truth->forces[0].contact;
        double unit = states_mean_force(truth) / 1.09e7 / 6e-3; /* the mean overlap over the mean radius */
        for (int s = 0; s < count; s++) {
            struct disturbance disturbance = {.network = 1, .seed = 9};
            struct packing measured;
            struct forces forces;
            if (radii)
                disturbance.scale = sizes[s] * unit;
            else
                disturbance.place = sizes[s];
            if (states_disturb(truth, &disturbance, &measured) || estimate(&measured, method, &forces))
                return -1;
            struct change change = changes(truth, &measured);
            double rn = r_common(truth, &measured, known->fn, forces.contact.fn, 1);
            double rt = r_common(truth, &measured, known->ft, forces.contact.ft, 0);
            double x = 100 * (radii ? change.gained - change.lost : change.lost + change.gained);
            chart_put(lines[0], x, rn), chart_put(lines[1], x, rt);
            thesis_line(thesis, "%8g %10g %8.1f %9.1f %8.3f %8.3f %9.1e", KAPPAS[k], sizes[s], 100 * change.lost,
                        100 * change.gained, rn, rt, forces.imbalance);
            forces_free(&forces);
            packing_free(&measured);
        }
        states_free(&states);
    }
    return thesis_picture(thesis, charts, 2);
}

static const double RADII[] = {-0.2, -0.1, -0.05, -0.02, -0.01, 0, 0.1, 0.4, 1, 2};
static const double PLACES[] = {0, 0.02, 0.05, 0.1, 0.2, 0.3, 0.5, 1};

static int figure_3_17(struct thesis *thesis)
{
    return decay(thesis, METHOD_QSM, 1, RADII, 10);
}

static int figure_3_19(struct thesis *thesis)
{
    return decay(thesis, METHOD_QSM, 0, PLACES, 8);
}

static int figure_3_29(struct thesis *thesis)
{
    return decay(thesis, METHOD_CDM, 1, RADII, 10);
}

static int figure_3_32(struct thesis *thesis)
{
    return decay(thesis, METHOD_CDM, 0, PLACES, 8);
}

/* ---- maps of kappa = 10000: truth, and two disturbances ---- */

static int maps(struct thesis *thesis, enum force_method method, int radii, double one, double two)
{
    const double sizes[] = {one, two};
    struct states states;
    struct packing measured[2];
    struct forces forces[2];
    char names[2][80];
    if (isotropic(thesis, 10000, &states))
        return -1;
    const struct packing *truth = &states.state[0];
    double unit = states_mean_force(truth) / 1.09e7 / 6e-3;
    for (int s = 0; s < 2; s++) {
        struct disturbance disturbance = {.network = 1, .seed = 9};
        if (radii)
            disturbance.scale = sizes[s] * unit;
        else
            disturbance.place = sizes[s];
        if (states_disturb(truth, &disturbance, &measured[s]) || estimate(&measured[s], method, &forces[s]))
            return -1;
        struct change change = changes(truth, &measured[s]);
        double rn = r_common(truth, &measured[s], truth->forces[0].contact.fn, forces[s].contact.fn, 1);
        snprintf(names[s], sizeof names[s], "%.0f %% lost, %.0f %% gained, r(fn) = %.2f", 100 * change.lost,
                 100 * change.gained, rn);
        thesis_line(thesis, "%s %s", method_row(method)->name, names[s]);
    }
    const struct packing *packings[] = {truth, &measured[0], &measured[1]};
    const struct forces *shown[] = {&truth->forces[0], &forces[0], &forces[1]};
    const char *titles[] = {"truth", names[0], names[1]};
    int status = thesis_maps(thesis, packings, shown, titles, 3);
    for (int s = 0; s < 2; s++)
        packing_free(&measured[s]), forces_free(&forces[s]);
    states_free(&states);
    return status;
}

static int figure_3_18(struct thesis *thesis)
{
    return maps(thesis, METHOD_QSM, 1, -0.02, 0.1);
}

static int figure_3_20(struct thesis *thesis)
{
    return maps(thesis, METHOD_QSM, 0, 0.02, 0.05);
}

static int figure_3_30(struct thesis *thesis)
{
    return maps(thesis, METHOD_CDM, 1, -0.05, 0.4);
}

static int figure_3_33(struct thesis *thesis)
{
    return maps(thesis, METHOD_CDM, 0, 0.1, 0.2);
}

/* ---- 3.31: what contacts carry that are not there ---- */

static int figure_3_31(struct thesis *thesis)
{
    struct chart chart = {
        .title = "3.31 contacts that are not there", .x_label = "fn / <fn>", .y_label = "share of them"};
    struct states states;
    struct packing measured;
    struct forces forces;
    if (isotropic(thesis, 10000, &states))
        return -1;
    const struct packing *truth = &states.state[0];
    double mean = states_mean_force(truth), extra = 0, below[31] = {0};
    struct disturbance disturbance = {.network = 1, .seed = 9, .scale = 2 * mean / 1.09e7 / 6e-3};
    struct chart_line *line = chart_add(&chart, "", 31);
    if (!line || states_disturb(truth, &disturbance, &measured) || estimate(&measured, METHOD_CDM, &forces))
        return -1;
    for (size_t c = 0; c < measured.contacts.count; c++) {
        if (!touches(&measured, c) || has(truth, measured.contacts.i[c], measured.contacts.j[c], c))
            continue;
        extra++;
        for (int b = 0; b <= 30; b++)
            below[b] += forces.contact.fn[c] <= 0.1 * b * mean;
    }
    for (int b = 0; b <= 30; b++)
        chart_put(line, 0.1 * b, below[b] / extra);
    thesis_line(thesis, "%g contacts too many (%.1f %%): %.0f %% of them carry nothing, %.0f %% less than <fn>", extra,
                100 * extra / (double)truth->contacts.count, 100 * below[0] / extra, 100 * below[10] / extra);
    forces_free(&forces);
    packing_free(&measured);
    states_free(&states);
    return thesis_picture(thesis, &chart, 1);
}

const struct figure FIGURES_NETWORK[] = {{"3.17", "qsm with wrong radii", figure_3_17},
                                         {"3.18", "maps of qsm with wrong radii", figure_3_18},
                                         {"3.19", "qsm with wrong places", figure_3_19},
                                         {"3.20", "maps of qsm with wrong places", figure_3_20},
                                         {"3.29", "cdm with wrong radii", figure_3_29},
                                         {"3.30", "maps of cdm with wrong radii", figure_3_30},
                                         {"3.31", "what surplus contacts carry in cdm", figure_3_31},
                                         {"3.32", "cdm with wrong places", figure_3_32},
                                         {"3.33", "maps of cdm with wrong places", figure_3_33},
                                         {NULL, NULL, NULL}};
