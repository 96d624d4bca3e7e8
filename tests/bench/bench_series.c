/* How near series comes to the truth (docs/series_forces.md), on the states of tests/bench/series_states:
 *
 *     bench_series table|hard|curves FOLDER [FIRST [LAST [DRAWS]]]     rows FIRST to LAST
 *     bench_series run FOLDER KAPPA PACKING "0 10 15 20 25" SEED
 *
 * Each row is an average over draws of the errors on two packings. All times are CPU seconds. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "pipeline/speak/error.h"
#include "tests/bench/series_case.h"

#define KN 1.09e7 /* of series_states */
#define ALL "0 1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16 17 18 19 20 21 22 23 24 25 26 27 28 29 30"
#define WIDE "0 10 15 20 25"

struct row {
    const char *name, *states;
    double kappa;
    struct series_errors errors;
    double kn, mu; /* what the method is told, over the truth; 0: the truth */
    int fit, last; /* fit kn; score the last state only */
    int alone;     /* 1: also each photo by map */
    int draws;     /* of the errors, on packings 1, 2, 1, ...; 0: 3 */
    int samples;   /* for s_fn, s_ft; their time is counted */
    double soft;   /* of equilibrium, as told; 0: the default */
};

#define USUAL .place = 0.025, .radius = 0.0175, .wall = 0.025, .offset = 0.3, .track = 0.002, .track_deg = 0.002
#define ROW(text, list, k, ...)                                                                                        \
    {                                                                                                                  \
        .name = text, .states = list, .kappa = k, __VA_ARGS__                                                          \
    }

static const struct row TABLE[] = {
    ROW("5 photos over 1.5 % strain", WIDE, 1000, .errors = {USUAL}, .alone = 1),
    ROW("31 photos", ALL, 1000, .errors = {USUAL}),
    ROW("5 photos within 1.6e-4", "0 2 4 6 8", 1000, .errors = {USUAL}),
    ROW("1.2 % load, full load (scored)", "u3 0", 1000, .errors = {USUAL}, .last = 1),
    ROW("kappa 10000, 5 photos", WIDE, 10000, .errors = {USUAL}),
    ROW("kappa 100, 5 photos", WIDE, 100, .errors = {USUAL}),
    ROW("kn 10 % wrong, fitted", WIDE, 1000, .errors = {USUAL}, .kn = 1.1, .fit = 1),
    ROW("list cut at 2 standard errors", WIDE, 1000, .errors = {USUAL, .margin = 2}),
    ROW("0.2 % of all contacts lost", WIDE, 1000, .errors = {USUAL, .lost = 0.002}),
    ROW("tracking 0.01 px, 0.01 deg", WIDE, 1000,
        .errors = {.place = 0.025, .radius = 0.0175, .wall = 0.025, .offset = 0.3, .track = 0.01, .track_deg = 0.01}),
    ROW("faces not round, 0.05 px", WIDE, 1000, .errors = {USUAL, .shape = 0.05}),
    ROW("5 photos, standard deviations", WIDE, 1000, .errors = {USUAL}, .draws = 2, .samples = 20),
    ROW("within 1.6e-4, the same", "0 2 4 6 8", 1000, .errors = {USUAL}, .draws = 2, .samples = 20),
};

static const struct row HARD[] = {
    ROW("mu 0.4 instead of 0.5", WIDE, 1000, .errors = {USUAL}, .mu = 0.8),
    ROW("mu 0.6 instead of 0.5", WIDE, 1000, .errors = {USUAL}, .mu = 1.2),
    ROW("body forces of 0.1 <fn>", WIDE, 1000, .errors = {USUAL, .body = 0.1}),
    ROW("the same, told: softness 0.1", WIDE, 1000, .errors = {USUAL, .body = 0.1}, .soft = 0.1),
    ROW("wall loads 2 % wrong", WIDE, 1000, .errors = {USUAL, .wall_load = 0.02}),
    ROW("a third of the contacts change", "0 30", 1000, .errors = {USUAL}),
    ROW("one photo from another reference", "0 10 x15 20 25", 1000, .errors = {USUAL}),
    ROW("two identical photos", "0 10 10 20", 1000, .errors = {USUAL}),
};

#define TRACK(t) .errors = {.place = 0.025, .radius = 0.0175, .wall = 0.025, .offset = 0.3, .track = t, .track_deg = t}
static const struct row CURVES[] = {
    ROW("2 photos, 2 % strain", "0 30", 1000, .errors = {USUAL}, .draws = 2),
    ROW("3 photos", "0 20 30", 1000, .errors = {USUAL}, .draws = 2),
    ROW("6 photos", "0 14 18 22 26 30", 1000, .errors = {USUAL}, .draws = 2),
    ROW("11 photos", "0 12 14 16 18 20 22 24 26 28 30", 1000, .errors = {USUAL}, .draws = 2),
    ROW("21 photos", "0 11 12 13 14 15 16 17 18 19 20 21 22 23 24 25 26 27 28 29 30", 1000, .errors = {USUAL},
        .draws = 1),
    ROW("5 photos over 0.02 % strain", "0 3 6 8 10", 1000, .errors = {USUAL}, .draws = 2),
    ROW("5 photos over 0.4 % strain", "0 11 12 13 14", 1000, .errors = {USUAL}, .draws = 2),
    ROW("5 photos over 0.8 % strain", "0 12 14 16 18", 1000, .errors = {USUAL}, .draws = 2),
    ROW("tracking 0.001 px", WIDE, 1000, TRACK(0.001), .draws = 2),
    ROW("tracking 0.004 px", WIDE, 1000, TRACK(0.004), .draws = 2),
    ROW("tracking 0.02 px", WIDE, 1000, TRACK(0.02), .draws = 2),
    ROW("11 % load, full load (scored)", "u2 0", 1000, .errors = {USUAL}, .last = 1, .draws = 2),
    ROW("50 % load, full load (scored)", "u1 0", 1000, .errors = {USUAL}, .last = 1, .draws = 2),
    ROW("1.2, 11, 50, 100 % (scored)", "u3 u2 u1 0", 1000, .errors = {USUAL}, .last = 1, .draws = 2),
};

static double cpu(void)
{
    struct timespec now;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

struct result {
    struct series_score score;
    double alone_fn, alone_ft, kn, s_kn, misfit, worst_photo, seconds;
    int converged, steps, products;
};

/* Each photo by itself, the offset of the radii known. */
static int score_alone(const struct row *row, struct series_case *series, uint64_t seed,
                       const struct force_options *options, struct result *result)
{
    struct series_errors errors = row->errors;
    struct series_options series_options = SERIES_OPTIONS_DEFAULT;
    static struct forces forces[SERIES_CASE_STATES];
    errors.offset = 0;
    if (series_case_draw(series, &errors, seed))
        return -1;
    for (size_t s = 0; s < series->count; s++) {
        const struct packing *packing = &series->measured[s];
        struct series_summary summary;
        if (infer_series(&packing, 1, options, &series_options, &forces[s], &summary))
            return -1;
        series_summary_free(&summary);
    }
    struct series_score score = series_case_score(series, forces);
    result->alone_fn = score.fn, result->alone_ft = score.ft;
    for (size_t s = 0; s < series->count; s++)
        forces_free(&forces[s]);
    return 0;
}

static int measure(const char *folder, const struct row *row, int packing, uint64_t seed, struct result *result)
{
    static struct series_case series;
    static struct forces forces[SERIES_CASE_STATES];
    const struct packing *packings[SERIES_CASE_STATES];
    struct force_options options = FORCE_OPTIONS_DEFAULT;
    struct series_options series_options = SERIES_OPTIONS_DEFAULT;
    struct series_summary summary;
    options.law.kn = KN * (row->kn > 0 ? row->kn : 1), options.law.mu = 0.5 * (row->mu > 0 ? row->mu : 1);
    series_options.fit_stiffness = row->fit, series_options.samples = row->samples;
    if (row->soft > 0)
        series_options.softness = row->soft;
    *result = (struct result){.alone_fn = NAN, .alone_ft = NAN};
    if (series_case_read(folder, row->kappa, packing, row->states, &series) ||
        (row->alone && score_alone(row, &series, seed, &options, result)) ||
        series_case_draw(&series, &row->errors, seed))
        return -1;
    for (size_t s = 0; s < series.count; s++)
        packings[s] = &series.measured[s];
    double begin = cpu();
    if (infer_series(packings, series.count, &options, &series_options, forces, &summary))
        return -1;
    result->seconds = cpu() - begin;
    result->score = row->last ? series_case_score_one(&series, series.count - 1, &forces[series.count - 1])
                              : series_case_score(&series, forces);
    result->kn = summary.kn / KN, result->s_kn = summary.s_kn / KN, result->misfit = summary.misfit;
    result->converged = summary.converged, result->steps = summary.steps, result->products = summary.products;
    for (size_t s = 0; s < series.count; s++) {
        result->worst_photo = fmax(result->worst_photo, summary.photo[s].misfit);
        forces_free(&forces[s]);
    }
    series_summary_free(&summary);
    series_case_free(&series);
    return 0;
}

static void headline(void)
{
    printf("%-32s %-15s %-31s %-13s %-9s %-5s %-16s %-11s %s\n", "case", "alone fn / ft", "rms fn (worst) / ft (worst)",
           "r(fn) r(ft)", "z fn ft", "held", "kn", "2F/n worst", "cpu s, steps, ok");
}

static int print_row(const char *folder, const struct row *row, int asked)
{
    int draws = asked > 0 ? asked : row->draws > 0 ? row->draws : 3, converged = 1, steps = 0;
    struct result sum = {0};
    double worst_fn = 0, worst_ft = 0, most = 0;
    for (int k = 0; k < draws; k++) {
        struct result one;
        if (measure(folder, row, 1 + k % 2, (uint64_t)k + 1, &one))
            return -1;
        double *to = (double *)&sum.score, *from = (double *)&one.score;
        for (size_t i = 0; i < sizeof sum.score / sizeof(double); i++)
            to[i] += from[i] / draws;
        sum.alone_fn += one.alone_fn / draws, sum.alone_ft += one.alone_ft / draws;
        sum.kn += fabs(one.kn - 1) / draws, sum.s_kn += one.s_kn / draws;
        sum.misfit += one.misfit / draws, sum.worst_photo = fmax(sum.worst_photo, one.worst_photo);
        worst_fn = fmax(worst_fn, one.score.fn), worst_ft = fmax(worst_ft, one.score.ft);
        most = fmax(most, one.seconds), sum.seconds += one.seconds / draws;
        converged &= one.converged, steps += one.steps / draws;
    }
    printf(
        "%-32s %.3f / %.3f   %.4f (%.4f) / %.4f (%.4f) %.4f %.4f %.2f %.2f %.3f %.4f +- %.4f %.2f %.2f %.1f (%.1f) %d "
        "%s\n",
        row->name, sum.alone_fn, sum.alone_ft, sum.score.fn, worst_fn, sum.score.ft, worst_ft, sum.score.r_fn,
        sum.score.r_ft, sum.score.z_fn, sum.score.z_ft, sum.score.held, sum.kn, sum.s_kn, sum.misfit, sum.worst_photo,
        sum.seconds, most, steps, converged ? "yes" : "no");
    fflush(stdout);
    return 0;
}

static int print_rows(const char *folder, const struct row *rows, size_t count, size_t first, size_t last, int draws)
{
    headline();
    for (size_t k = first; k <= last && k < count; k++)
        if (print_row(folder, &rows[k], draws))
            return -1;
    return 0;
}

static int run_one(char **argv)
{
    struct row row = ROW(argv[5], argv[5], atof(argv[3]), .errors = {USUAL});
    struct result result;
    if (measure(argv[2], &row, atoi(argv[4]), (uint64_t)atoi(argv[6]), &result))
        return -1;
    printf("fn %.4f ft %.4f, %d steps, %d products, %.1f s\n", result.score.fn, result.score.ft, result.steps,
           result.products, result.seconds);
    return 0;
}

int main(int argc, char **argv)
{
    static const struct {
        const char *name;
        const struct row *rows;
        size_t count;
    } tables[] = {{"table", TABLE, sizeof TABLE / sizeof *TABLE},
                  {"hard", HARD, sizeof HARD / sizeof *HARD},
                  {"curves", CURVES, sizeof CURVES / sizeof *CURVES}};
    size_t first = argc > 3 ? (size_t)atoi(argv[3]) : 0, last = argc > 4 ? (size_t)atoi(argv[4]) : 1000;
    int draws = argc > 5 ? atoi(argv[5]) : 0;
    int status = 2;
    if (argc == 7 && !strcmp(argv[1], "run"))
        status = run_one(argv) ? 1 : 0;
    for (size_t k = 0; k < 3 && argc > 2 && status == 2; k++)
        if (!strcmp(argv[1], tables[k].name))
            status = print_rows(argv[2], tables[k].rows, tables[k].count, first, last, draws) ? 1 : 0;
    if (status == 1)
        fprintf(stderr, "bench_series: %s\n", error_message());
    if (status == 2)
        fprintf(stderr,
                "usage: bench_series table|hard|curves FOLDER [FIRST [LAST [DRAWS]]], bench_series run FOLDER KAPPA "
                "PACKING STATES SEED\n");
    return status;
}
