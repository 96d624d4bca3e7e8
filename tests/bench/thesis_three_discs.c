/* Thesis 2.2: what forces three discs can carry, by molecular dynamics, contact dynamics and projections, from many
 * starts. */
#include <stdlib.h>
#include <string.h>

#include "pipeline/laws/contact_spring.h"
#include "pipeline/speak/error.h"
#include "tests/bench/three_discs.h"

enum { STARTS = 1000, FRICTIONS = 21 };

/* ---- molecular dynamics and contact elasticity ---- */

enum { NOISES = 60 };

/* F_noise / P from 1 to 1e5. */
static double noise_number(int k)
{
    return pow(10, 5.0 * k / (NOISES - 1));
}

static int figure_2_13(struct thesis *thesis)
{
    static const double dampings[] = {0.9, 1.8, THREE_DAMPING};
    struct chart chart = {
        .title = "2.13 molecular dynamics", .x_label = "log10 (F noise / P)", .y_label = "mobilised friction"};
    thesis_line(thesis, "%-22s %10s %10s %12s", "dashpot / sqrt(m kn)", "least m", "most m", "without noise");
    for (int d = 0; d < 3; d++) {
        char name[40];
        double least = 1, most = -1;
        snprintf(name, sizeof name, "dashpot %g", dampings[d]);
        struct chart_line *line = chart_add(&chart, name, NOISES);
        if (!line)
            return -1;
        for (int k = 0; k < NOISES; k++) {
            struct three_rest rest = three_molecular(dampings[d], THREE_P * noise_number(k), NULL);
            double m = rest.rests ? three_mobilised(0.5, rest.fn, rest.ft) : NAN;
            chart_put(line, log10(noise_number(k)), m);
            least = fmin(least, m), most = fmax(most, m);
        }
        struct three_rest rest = three_molecular(dampings[d], 0, NULL);
        thesis_line(thesis, "%-22g %10.3f %10.3f   fn = %.2f N, ft = %.2f N", dampings[d], least, most, rest.fn,
                    rest.ft);
    }
    thesis_line(thesis, "thesis: m from -1 to 1; 721.5 and 360.8 N without noise, with a printed dashpot of 0.9");
    return thesis_picture(thesis, &chart, 1);
}

/* Elastic forces of the whole displacement, as cem has them, against those at rest. */
static int figure_2_15(struct thesis *thesis)
{
    struct chart charts[] = {
        {.title = "2.15 ft over that of cem", .x_label = "mobilised friction", .y_label = "ft / ft(cem)"},
        {.title = "2.15 fn over that of cem", .x_label = "mobilised friction", .y_label = "fn / fn(cem)"},
        {.title = "2.15 mobilised friction of cem", .x_label = "mobilised friction", .y_label = "m(cem)"}};
    struct chart_line *lines[3];
    struct contact_law law = {.row = &linear_law, .kn = THREE_KN, .kt_over_kn = 1, .mu = 0.5};
    struct contact_pair pair = contact_pair_of(&law, 1);
    for (int k = 0; k < 3; k++)
        if (!(lines[k] = thesis_scatter(&charts[k], "", NOISES)))
            return -1;
    double worst = 0, least = 1, most = -1;
    for (int k = 0; k < NOISES; k++) {
        struct three_rest rest = three_molecular(THREE_DAMPING, THREE_P * noise_number(k), NULL);
        double fn = 0, ft = 0, m = three_mobilised(0.5, rest.fn, rest.ft), along = -rest.down * sqrt(0.5);
        contact_pair_advance(&law, &pair, law.mu, along, along, &fn, &ft);
        thesis_point(lines[0], m, rest.ft / ft);
        thesis_point(lines[1], m, rest.fn / fn);
        thesis_point(lines[2], m, three_mobilised(0.5, fn, ft));
        worst = fmax(worst, fabs(fn / rest.fn - 1));
        least = fmin(least, three_mobilised(0.5, fn, ft)), most = fmax(most, three_mobilised(0.5, fn, ft));
    }
    thesis_line(thesis,
                "m of cem from %.4f to %.4f (thesis: always 1); largest error of fn %.2g (thesis: below 0.2 %%)", least,
                most, worst);
    return thesis_picture(thesis, charts, 3);
}

/* ---- many starts ---- */

typedef void solver(double mu, double fn, double ft, struct three_path *path);

static void by_dynamics(double mu, double fn, double ft, struct three_path *path)
{
    three_dynamics(mu, fn, ft, path);
}

static void by_projections(double mu, double fn, double ft, struct three_path *path)
{
    three_projections(THREE_P, mu, fn, ft, 0, path);
}

struct ends {
    double m[STARTS], fn[STARTS];
    double mean, deviation, least, most, yield; /* of m; share with |m| >= 0.99 */
};

static void find_ends(solver *solve, double spread, double mu, struct ends *ends)
{
    static struct three_path path;
    double sum = 0, square = 0;
    *ends = (struct ends){.least = INFINITY, .most = -INFINITY};
    for (size_t k = 0; k < STARTS; k++) {
        double fn, ft;
        three_start(spread, mu, k, &fn, &ft);
        solve(mu, fn, ft, &path);
        ends->fn[k] = path.fn[path.count];
        double m = ends->m[k] = three_mobilised(mu, ends->fn[k], path.ft[path.count]);
        sum += m, square += m * m;
        ends->least = fmin(ends->least, m), ends->most = fmax(ends->most, m);
        ends->yield += fabs(m) >= 0.99 ? 1.0 / STARTS : 0;
    }
    ends->mean = sum / STARTS;
    ends->deviation = sqrt(fmax(0, square / STARTS - ends->mean * ends->mean));
}

/* Share of the ends per width of m. */
static int densities(struct chart *chart, solver *solve)
{
    static const double mus[] = {0.1, 0.3, 0.5, 1};
    for (int k = 0; k < 4; k++) {
        enum { BINS = 20 };
        double bins[BINS] = {0};
        char name[40];
        struct ends ends;
        find_ends(solve, THREE_SPREAD, mus[k], &ends);
        snprintf(name, sizeof name, "mu %g", mus[k]);
        struct chart_line *line = chart_add(chart, name, BINS);
        if (!line)
            return -1;
        for (size_t s = 0; s < STARTS; s++)
            bins[(int)fmin(BINS - 1, fmax(0, (ends.m[s] + 1) / 2 * BINS))] += (double)BINS / 2 / STARTS;
        for (int b = 0; b < BINS; b++)
            chart_put(line, -1 + (2 * b + 1.0) / BINS, bins[b]);
    }
    return 0;
}

static int ranges(struct thesis *thesis, solver *solve, double *last_negative)
{
    struct chart charts[] = {{.title = "range of mobilised friction", .x_label = "mu", .y_label = "m"},
                             {.title = "probability density", .x_label = "m", .y_label = "density"}};
    static const char *const names[] = {"mean", "mean - sd", "mean + sd", "least", "most"};
    struct chart_line *lines[5];
    for (int k = 0; k < 5; k++)
        if (!(lines[k] = chart_add(&charts[0], names[k], 4 * FRICTIONS)))
            return -1;
    *last_negative = 0;
    thesis_line(thesis, "%6s %8s %8s %8s %8s %10s", "mu", "mean m", "sd", "least", "most", "yield, %");
    for (int k = 1; k < 4 * FRICTIONS; k++) {
        double mu = (double)k / (4 * (FRICTIONS - 1));
        struct ends ends;
        if (mu > 1)
            break;
        find_ends(solve, THREE_SPREAD, mu, &ends);
        const double values[] = {ends.mean, ends.mean - ends.deviation, ends.mean + ends.deviation, ends.least,
                                 ends.most};
        for (int l = 0; l < 5; l++)
            chart_put(lines[l], mu, values[l]);
        if (k % 8 == 0)
            thesis_line(thesis, "%6.3f %8.3f %8.3f %8.3f %8.3f %10.1f", mu, ends.mean, ends.deviation, ends.least,
                        ends.most, 100 * ends.yield);
        if (ends.least <= -0.99)
            *last_negative = mu;
    }
    struct ends printed;
    find_ends(solve, 1, 0.5, &printed);
    thesis_line(thesis, "starts as printed in (2.59), mu = 0.5: mean m %.3f, sd %.3f, %.3f to %.3f, %.1f %% at yield",
                printed.mean, printed.deviation, printed.least, printed.most, 100 * printed.yield);
    if (densities(&charts[1], solve))
        return -1;
    return thesis_picture(thesis, charts, 2);
}

static int figure_2_16(struct thesis *thesis)
{
    double last;
    if (ranges(thesis, by_dynamics, &last))
        return -1;
    thesis_line(thesis, "m = -1 is last reached at mu = %.3f (thesis: 0.075)", last);
    return 0;
}

static int figure_2_24(struct thesis *thesis)
{
    double last;
    if (ranges(thesis, by_projections, &last))
        return -1;
    thesis_line(thesis, "m = -1 is last reached at mu = %.3f (thesis: about 0.4)", last);
    return 0;
}

static int yields(struct thesis *thesis, int both)
{
    struct chart chart = {
        .title = "share of the ends on the cone", .x_label = "mu", .y_label = "share, %", .from_zero = 1};
    struct chart_line *dynamics = chart_add(&chart, "contact dynamics", FRICTIONS);
    struct chart_line *projections = both ? chart_add(&chart, "projections", FRICTIONS) : NULL;
    if (!dynamics || (both && !projections))
        return -1;
    thesis_line(thesis, both ? "%6s %14s %14s" : "%6s %14s", "mu", "cdm, %", "qsm, %");
    for (int k = 1; k < FRICTIONS; k++) {
        double mu = (double)k / (FRICTIONS - 1);
        struct ends one, two;
        find_ends(by_dynamics, THREE_SPREAD, mu, &one);
        chart_put(dynamics, mu, 100 * one.yield);
        if (!both) {
            thesis_line(thesis, "%6.2f %14.1f", mu, 100 * one.yield);
            continue;
        }
        find_ends(by_projections, THREE_SPREAD, mu, &two);
        chart_put(projections, mu, 100 * two.yield);
        thesis_line(thesis, "%6.2f %14.1f %14.1f", mu, 100 * one.yield, 100 * two.yield);
    }
    return thesis_picture(thesis, &chart, 1);
}

static int figure_2_17(struct thesis *thesis)
{
    return yields(thesis, 0);
}

static int figure_2_22(struct thesis *thesis)
{
    return yields(thesis, 1);
}

static int figure_2_23(struct thesis *thesis)
{
    struct chart charts[] = {{.title = "2.23 normal forces", .x_label = "fn of cdm, N", .y_label = "fn of qsm, N"},
                             {.title = "2.23 mobilised friction", .x_label = "m of cdm", .y_label = "m of qsm"}};
    struct chart_line *fn = thesis_scatter(&charts[0], "", STARTS), *m = thesis_scatter(&charts[1], "", STARTS);
    struct ends one, two;
    double sum[2] = {0}, square[2] = {0}, mean = 0, program = 0;
    if (!fn || !m)
        return -1;
    find_ends(by_dynamics, THREE_SPREAD, 0.5, &one);
    find_ends(by_projections, THREE_SPREAD, 0.5, &two);
    for (size_t k = 0; k < STARTS; k++) {
        double start_n, start_t, end_n, end_t, difference[] = {two.fn[k] - one.fn[k], two.m[k] - one.m[k]};
        thesis_point(fn, one.fn[k], two.fn[k]);
        thesis_point(m, one.m[k], two.m[k]);
        for (int d = 0; d < 2; d++)
            sum[d] += difference[d] / STARTS, square[d] += difference[d] * difference[d] / STARTS;
        mean += 0.5 * (one.fn[k] + two.fn[k]) / STARTS;
        three_start(THREE_SPREAD, 0.5, k, &start_n, &start_t);
        if (three_by_program(METHOD_QSM, 0.5, start_n, start_t, &end_n, &end_t))
            return -1;
        program = fmax(program, fabs(end_n - two.fn[k]));
    }
    thesis_line(thesis,
                "qsm - cdm: fn %.1f +- %.1f N, m %.3f +- %.2f, <fn> %.0f N (thesis: 7.2 +- 165.5 N, 0.03 +- 0.3, "
                "about 1080 N)",
                sum[0], sqrt(square[0] - sum[0] * sum[0]), sum[1], sqrt(square[1] - sum[1] * sum[1]), mean);
    thesis_line(thesis, "the program's qsm in three degrees of freedom ends within %.1e N of these in all %d starts",
                program, (int)STARTS);
    return thesis_picture(thesis, charts, 2);
}

const struct figure FIGURES_THREE_DISCS[] = {
    {"2.13", "mobilised friction of molecular dynamics against the first impulse", figure_2_13},
    {"2.15", "contact elasticity on the states of 2.13", figure_2_15},
    {"2.16", "range of mobilised friction, contact dynamics, 1000 starts", figure_2_16},
    {"2.17", "share of the ends on the cone, contact dynamics", figure_2_17},
    {"2.22", "share of the ends on the cone, quasi-static method", figure_2_22},
    {"2.23", "the two methods from the same starts", figure_2_23},
    {"2.24", "range of mobilised friction, quasi-static method", figure_2_24},
    {NULL, NULL, NULL}};
