/* Thesis 3.3: contact elasticity from measured motions, by the strain between two photos. One test of small steps;
 * wider windows leave states out. */
#include <stdlib.h>
#include <string.h>

#include "pipeline/speak/error.h"
#include "tests/bench/thesis.h"

#define SMALLEST 5e-5 /* strain; the thesis has 2e-5 */
enum { STEPS = 800, WINDOWS = 5 };
static const int WINDOW[WINDOWS] = {1, 10, 50, 100, 200}; /* smallest steps */

static int test_states(const struct thesis *thesis, double kappa, struct states *states)
{
    const struct thesis_test test = {200, kappa, STEPS, SMALLEST, 1, 0};
    return thesis_states(thesis, &test, states);
}

static struct vec moved(const struct packing *now, const struct packing *then, size_t body)
{
    size_t n = now->grains.count;
    if (body < n)
        return vec(now->grains.x[body] - then->grains.x[body], now->grains.y[body] - then->grains.y[body]);
    const struct walls *a = &now->walls, *b = &then->walls;
    struct vec in = wall_inward(a, body - n); /* walls move along their normals */
    struct vec at = vec(a->x0[body - n] - b->x0[body - n], a->y0[body - n] - b->y0[body - n]);
    return vec_scale(vec_dot(at, in), in);
}

static struct vec normal_then(const struct packing *now, const struct packing *then, size_t c)
{
    size_t i = (size_t)now->contacts.i[c], j = (size_t)now->contacts.j[c];
    if (j >= now->grains.count)
        return vec(now->contacts.nx[c], now->contacts.ny[c]);
    return vec_unit(vec(then->grains.x[j] - then->grains.x[i], then->grains.y[j] - then->grains.y[i]));
}

/* Motions of the thesis: u = (U_j - U_i).n with today's normal, ut with the rotations (2.1 - 2.3). */
static void motions(const struct packing *now, const struct packing *then, size_t c, double *un, double *ut)
{
    size_t i = (size_t)now->contacts.i[c], j = (size_t)now->contacts.j[c], n = now->grains.count;
    struct vec normal = vec(now->contacts.nx[c], now->contacts.ny[c]);
    struct vec u = vec_sub(moved(now, then, j), moved(now, then, i));
    double turning = now->grains.radius[i] * (now->grains.angle[i] - then->grains.angle[i]);
    if (j < n)
        turning += now->grains.radius[j] * (now->grains.angle[j] - then->grains.angle[j]);
    *un = vec_dot(u, normal);
    *ut = vec_dot(u, vec_turn(normal)) - turning;
}

/* What is asked of the method. */
struct chain {
    int window;
    int from_truth;   /* 1: the forces of state 0 are known; 0: none */
    int known_normal; /* 1: fn are those of the overlaps at every state */
};

struct step {
    double strain, rn, rt, stress;
};

/* One step: `then` holds the estimate as its last forces, which move to `now`. Increments go through the columns dun
 * and dut, as measured ones do; for known normal forces dun is the change of the overlap. */
static int advance(struct packing *now, struct packing *then, const struct chain *chain)
{
    struct force_options options = thesis_options(START_DEFAULT);
    struct packing before = *then;
    struct forces estimate;
    long row = 0;
    before.forces = &then->forces[then->force_count - 1], before.force_count = 1;
    options.previous = &before;
    const double *fn = now->forces[0].contact.fn;
    for (size_t c = 0; c < now->contacts.count; c++) {
        double un, ut, f0 = NAN;
        motions(now, then, c, &un, &ut);
        for (size_t k = 0; k < then->contacts.count && isnan(f0); k++) {
            size_t r = ((size_t)row + k) % then->contacts.count;
            if (then->contacts.i[r] == now->contacts.i[c] && then->contacts.j[r] == now->contacts.j[c])
                f0 = before.forces->contact.fn[r], row = (long)r;
        }
        now->contacts.dun[c] = isnan(f0) ? NAN : chain->known_normal ? (f0 - fn[c]) / 1.09e7 : un;
        now->contacts.dut[c] = isnan(f0) ? NAN : ut;
    }
    if (infer_forces(now, &options, METHOD_CEM, &estimate))
        return -1;
    for (size_t c = 0; chain->known_normal && c < estimate.contact.count; c++)
        estimate.contact.fn[c] = fn[c]; /* new contacts too */
    return thesis_keep(now, &estimate);
}

static int begin(struct packing *state, const struct chain *chain)
{
    struct forces first = {0};
    strcpy(first.method, "cem");
    if (table_copy(&CONTACT_FORCES, &first.contact, &state->forces[0].contact))
        return -1;
    for (size_t c = 0; !chain->from_truth && c < first.contact.count; c++) {
        first.contact.ft[c] = 0;
        if (!chain->known_normal)
            first.contact.fn[c] = 0;
    }
    return thesis_keep(state, &first);
}

/* Forget the estimates: the states serve again. */
static void forget(struct states *states)
{
    for (size_t s = 0; s < states->count; s++)
        while (states->state[s].force_count > 1)
            forces_free(&states->state[s].forces[--states->state[s].force_count]);
}

static double weber(const struct packing *packing, const struct contact_forces *forces)
{
    double sum = 0;
    for (size_t c = 0; c < forces->count; c++) {
        struct vec l = packing_branch(packing, c);
        double fy = forces->fn[c] * packing->contacts.ny[c] + forces->ft[c] * packing->contacts.nx[c];
        sum += fy * l.y;
    }
    return sum;
}

/* Returns the number of steps done, or -1. */
static int follow(struct states *states, const struct chain *chain, struct step steps[STEPS + 1])
{
    int done = 0;
    if (begin(&states->state[0], chain))
        return -1;
    for (size_t s = (size_t)chain->window; s < states->count; s += (size_t)chain->window) {
        struct packing *now = &states->state[s];
        if (advance(now, &states->state[s - (size_t)chain->window], chain))
            return -1;
        const struct contact_forces *truth = &now->forces[0].contact,
                                    *found = &now->forces[now->force_count - 1].contact;
        steps[done++] =
            (struct step){100 * thesis_strain(states, s), states_r(now, now, truth->fn, found->fn, 1),
                          states_r(now, now, truth->ft, found->ft, 0), weber(now, found) / weber(now, truth)};
    }
    forget(states);
    return done;
}

static int add_columns(struct states *states)
{
    for (size_t s = 0; s < states->count; s++)
        if (table_add(&CONTACTS, &states->state[s].contacts, "dun") ||
            table_add(&CONTACTS, &states->state[s].contacts, "dut"))
            return -1;
    return 0;
}

/* Mean over the last quarter of the test. */
static double late(const struct step *steps, int count, double (*of)(const struct step *))
{
    double sum = 0;
    int from = count - (count + 3) / 4;
    for (int k = from; k < count; k++)
        sum += of(&steps[k]) / (count - from);
    return sum;
}

static double rn_of(const struct step *step)
{
    return step->rn;
}

static double rt_of(const struct step *step)
{
    return step->rt;
}

static struct step steps[STEPS + 1], others[STEPS + 1];

static int figure_3_5(struct thesis *thesis)
{
    struct chart charts[] = {
        {.title = "3.5 initial ft known", .x_label = "vertical strain, %", .y_label = "r(ft)"},
        {.title = "3.5 initial ft neglected", .x_label = "vertical strain, %", .y_label = "r(ft)"}};
    struct states states;
    if (test_states(thesis, 1000, &states) || add_columns(&states))
        return -1;
    for (int known = 1; known >= 0; known--)
        for (int w = 0; w < WINDOWS; w++) {
            char name[40];
            snprintf(name, sizeof name, "%g", WINDOW[w] * SMALLEST);
            struct chart_line *line = chart_add(&charts[!known], name, STEPS);
            const struct chain chain = {WINDOW[w], known, 1};
            int count = line ? follow(&states, &chain, steps) : -1;
            if (count < 0)
                return -1;
            for (int k = 0; k < count; k++)
                chart_put(line, steps[k].strain, steps[k].rt);
            thesis_line(thesis, "initial ft %-9s window %-8g r(ft) after the first %.3f, late (last quarter) %.3f",
                        known ? "known" : "neglected", WINDOW[w] * SMALLEST, steps[0].rt, late(steps, count, rt_of));
        }
    states_free(&states);
    return thesis_picture(thesis, charts, 2);
}

static int difference(struct thesis *thesis, double kappa, int known_normal, struct chart *charts)
{
    const struct chain with = {1, 1, known_normal}, without = {1, 0, known_normal};
    struct states states;
    struct chart_line *lines[2] = {chart_add(&charts[0], "known", STEPS), chart_add(&charts[0], "neglected", STEPS)};
    struct chart_line *gap = chart_add(&charts[1], "", STEPS);
    if (!lines[0] || !lines[1] || !gap || test_states(thesis, kappa, &states) || add_columns(&states))
        return -1;
    int count = follow(&states, &with, steps);
    if (count < 0 || follow(&states, &without, others) < 0)
        return -1;
    for (int k = 0; k < count; k++) {
        double a = known_normal ? steps[k].rt : steps[k].rn, b = known_normal ? others[k].rt : others[k].rn;
        chart_put(lines[0], steps[k].strain, a), chart_put(lines[1], steps[k].strain, b);
        chart_put(gap, steps[k].strain, a - b);
        if (k == 0 || (k + 1) % 160 == 0)
            thesis_line(thesis, "strain %5.2f %%: known %.4f, neglected %.4f, difference %.4f", steps[k].strain, a, b,
                        a - b);
    }
    states_free(&states);
    return thesis_picture(thesis, charts, 2);
}

static int figure_3_6(struct thesis *thesis)
{
    struct chart charts[] = {
        {.title = "3.6 r(ft), smallest window", .x_label = "vertical strain, %", .y_label = "r(ft)"},
        {.title = "3.6 difference", .x_label = "vertical strain, %", .y_label = "difference of r(ft)"}};
    return difference(thesis, 100, 1, charts);
}

static int figure_3_8(struct thesis *thesis)
{
    struct chart charts[] = {
        {.title = "3.8 r(fn), smallest window", .x_label = "vertical strain, %", .y_label = "r(fn)"},
        {.title = "3.8 difference", .x_label = "vertical strain, %", .y_label = "difference of r(fn)"}};
    return difference(thesis, 100, 0, charts);
}

static int figure_3_7(struct thesis *thesis)
{
    struct chart chart = {
        .title = "3.7 Weber stress yy of cem over the true one", .x_label = "vertical strain, %", .y_label = "ratio"};
    struct states states;
    if (test_states(thesis, 1000, &states) || add_columns(&states))
        return -1;
    for (int w = 0; w < 4; w++) {
        char name[40];
        double worst = 0;
        const struct chain chain = {WINDOW[w], 0, 1};
        snprintf(name, sizeof name, "%g", WINDOW[w] * SMALLEST);
        struct chart_line *line = chart_add(&chart, name, STEPS);
        int count = line ? follow(&states, &chain, steps) : -1;
        if (count < 0)
            return -1;
        for (int k = 0; k < count; k++) {
            chart_put(line, steps[k].strain, steps[k].stress);
            worst = fmax(worst, fabs(steps[k].stress - 1));
        }
        thesis_line(thesis, "window %-8s largest error of the stress %.1f %%", name, 100 * worst);
    }
    states_free(&states);
    return thesis_picture(thesis, &chart, 1);
}

/* Two windows: the one whose normals turn least, and the one whose normals turn most. */
static double turned(const struct packing *now, const struct packing *then, size_t c)
{
    struct vec a = vec(now->contacts.nx[c], now->contacts.ny[c]), b = normal_then(now, then, c);
    return fabs(atan2(vec_cross(b, a), vec_dot(b, a))) * 180 / M_PI;
}

static double most_turned(const struct packing *now, const struct packing *then)
{
    double most = 0;
    for (size_t c = 0; c < now->contacts.count; c++)
        most = fmax(most, turned(now, then, c));
    return most;
}

static int figure_3_10(struct thesis *thesis)
{
    enum { WIDE = 10 };
    struct chart charts[] = {{.title = "3.10 normal motion over change of overlap",
                              .x_label = "log10 turn of the normal, degrees",
                              .y_label = "ratio",
                              .log_y = 1},
                             {.title = "3.10 error of the increment",
                              .x_label = "log10 turn of the normal, degrees",
                              .y_label = "|error| / increment",
                              .log_y = 1}};
    struct states states;
    size_t calm = WIDE, wild = WIDE;
    if (test_states(thesis, 100, &states))
        return -1;
    for (size_t s = 2 * WIDE; s < states.count; s += WIDE) {
        double most = most_turned(&states.state[s], &states.state[s - WIDE]);
        if (most < most_turned(&states.state[calm], &states.state[calm - WIDE]))
            calm = s;
        if (most > most_turned(&states.state[wild], &states.state[wild - WIDE]))
            wild = s;
    }
    for (int k = 0; k < 2; k++) {
        const struct packing *now = &states.state[k ? wild : calm], *then = &states.state[(k ? wild : calm) - WIDE];
        size_t n = now->contacts.count;
        struct chart_line *ratio = thesis_scatter(&charts[0], k ? "rearranging" : "calm", n),
                          *error = thesis_scatter(&charts[1], k ? "rearranging" : "calm", n);
        double below = 0, used = 0, worst = 0;
        if (!ratio || !error)
            return -1;
        for (size_t c = 0, r = 0; c < n; c++) {
            for (size_t seen = 0; seen < then->contacts.count && (then->contacts.i[r] != now->contacts.i[c] ||
                                                                  then->contacts.j[r] != now->contacts.j[c]);
                 seen++)
                r = (r + 1) % then->contacts.count;
            double un, ut, angle = fmax(1e-6, turned(now, then, c)),
                           grown = now->contacts.overlap[c] - then->contacts.overlap[r];
            if (then->contacts.i[r] != now->contacts.i[c] || then->contacts.j[r] != now->contacts.j[c] || grown == 0)
                continue;
            motions(now, then, c, &un, &ut);
            thesis_point(ratio, log10(angle), fabs(un / grown));
            thesis_point(error, log10(angle), fabs(-un / grown - 1));
            used++, below += fabs(-un / grown - 1) < 0.01, worst = fmax(worst, fabs(-un / grown - 1));
        }
        thesis_line(thesis,
                    "%-12s strain %.3f %%: normals turn up to %.3g degrees, %.0f %% of the increments within 1 %%, "
                    "worst error %.3g",
                    k ? "rearranging" : "calm", 100 * thesis_strain(&states, k ? wild : calm), most_turned(now, then),
                    100 * below / used, worst);
    }
    states_free(&states);
    return thesis_picture(thesis, charts, 2);
}

static int figure_3_11(struct thesis *thesis)
{
    struct chart chart = {.title = "3.11 fn from normal motions, initial forces known",
                          .x_label = "vertical strain, %",
                          .y_label = "r(fn)"};
    struct states states;
    if (test_states(thesis, 100, &states) || add_columns(&states))
        return -1;
    for (int w = 0; w < 3; w++) {
        char name[40];
        const struct chain chain = {WINDOW[w], 1, 0};
        snprintf(name, sizeof name, "%g", WINDOW[w] * SMALLEST);
        struct chart_line *line = chart_add(&chart, name, STEPS);
        int count = line ? follow(&states, &chain, steps) : -1;
        if (count < 0)
            return -1;
        for (int k = 0; k < count; k++)
            chart_put(line, steps[k].strain, steps[k].rn);
        thesis_line(thesis, "window %-8s r(fn) after the first %.4f, late (last quarter) %.4f", name, steps[0].rn,
                    late(steps, count, rn_of));
    }
    states_free(&states);
    return thesis_picture(thesis, &chart, 1);
}

const struct figure FIGURES_CEM[] = {{"3.5", "cem, tangential forces, by the strain window", figure_3_5},
                                     {"3.6", "cem, what the initial tangential forces are worth", figure_3_6},
                                     {"3.7", "cem, stress by the strain window", figure_3_7},
                                     {"3.8", "cem, normal forces from motions", figure_3_8},
                                     {"3.10", "normal motion against change of overlap", figure_3_10},
                                     {"3.11", "cem, normal forces by the strain window", figure_3_11},
                                     {NULL, NULL, NULL}};
