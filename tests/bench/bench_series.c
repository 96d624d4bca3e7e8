/* How near series comes to the truth (docs/series_forces.md), on the states of tests/bench/series_states:
 *
 *     bench_series run FOLDER KAPPA PACKING "0 10 15 20 25" SEED
 *
 * All times are CPU seconds. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "pipeline/error.h"
#include "tests/bench/series_case.h"

static double cpu(void)
{
    struct timespec now;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

static int run(const char *folder, double kappa, int packing, const char *states, uint64_t seed)
{
    static struct series_case series;
    struct series_errors errors = SERIES_ERRORS_USUAL;
    struct force_options options = FORCE_OPTIONS_DEFAULT;
    struct series_options series_options = SERIES_OPTIONS_DEFAULT;
    struct series_summary summary;
    struct forces forces[SERIES_CASE_STATES];
    const struct packing *packings[SERIES_CASE_STATES];
    options.law.kn = 1.09e7, options.law.mu = 0.5;
    if (getenv("SOFT"))
        series_options.softness = atof(getenv("SOFT"));
    if (getenv("KN")) {
        options.law.kn *= atof(getenv("KN"));
        series_options.fit_stiffness = !getenv("NOFIT");
    }
    if (getenv("SHAPE"))
        errors.shape = atof(getenv("SHAPE"));
    if (getenv("LOST"))
        errors.lost = atof(getenv("LOST"));
    if (getenv("TRACK"))
        errors.track = errors.track_deg = atof(getenv("TRACK"));
    if (getenv("NOTANG"))
        series_options.tangential = 0;
    if (series_case_read(folder, kappa, packing, states, &series) || series_case_draw(&series, &errors, seed))
        return -1;
    for (size_t s = 0; s < series.count; s++)
        packings[s] = &series.measured[s];
    double begin = cpu();
    if (infer_series(packings, series.count, &options, &series_options, forces, &summary))
        return -1;
    struct series_score score = series_case_score(&series, forces);
    printf("%-24s kappa %g packing %d seed %d: fn %.4f ft %.4f r %.4f %.4f, %zu segments, gradient %.1e, %d steps %d "
           "products, "
           "offset %.3f of %.3f px, kn %.4f +- %.4f, 2F/n %.3f, %.1f s\n",
           states, kappa, packing, (int)seed, score.fn, score.ft, score.r_fn, score.r_ft, summary.segments,
           summary.gradient, summary.steps, summary.products, summary.offset / series.pixel,
           series.offset / series.pixel, summary.kn / 1.09e7, summary.s_kn / 1.09e7, summary.misfit, cpu() - begin);
    if (getenv("EACH"))
        for (size_t s = 0; s < series.count; s++) {
            struct series_score one = series_case_score_one(&series, s, &forces[s]);
            printf("   %zu: fn %.4f ft %.4f\n", s, one.fn, one.ft);
        }
    return 0;
}

int main(int argc, char **argv)
{
    if (argc == 7 && !strcmp(argv[1], "run")) {
        if (!run(argv[2], atof(argv[3]), atoi(argv[4]), argv[5], (uint64_t)atoi(argv[6])))
            return 0;
        fprintf(stderr, "bench_series: %s\n", error_message());
        return 1;
    }
    fprintf(stderr, "usage: bench_series run FOLDER KAPPA PACKING STATES SEED\n");
    return 2;
}
