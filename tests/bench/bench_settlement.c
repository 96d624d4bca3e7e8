/* Long-term settlement of packings under cycles, against simulating every cycle.
 *
 *     bench_settlement ahead [GRAINS [CYCLES]]  how far off an extrapolation is: trends, k, h (the paper's Figs 6 and
 * 7) bench_settlement loop [GRAINS [CYCLES]]   the k_i / k / h loop, confined and partially confined (Figs 11 to 13)
 *     bench_settlement part [GRAINS]            parting of grains that overlap (Fig. 9)
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "calibration/settle_loop.h"
#include "pipeline/error.h"
#include "pipeline/random.h"
#include "simulation/loading.h"
#include "simulation/placement.h"

static struct grade grading[3];

static int failed(void)
{
    fprintf(stderr, "bench_settlement: %s\n", error_message());
    return 1;
}

static struct simulation packing_of(long grains, double kappa, int confined)
{
    struct simulation simulation = SIMULATION_DEFAULT;
    grading[0] = (struct grade){grains / 2, 8e-3};
    grading[1] = (struct grade){grains * 3 / 10, 12e-3};
    grading[2] = (struct grade){grains - grains / 2 - grains * 3 / 10, 14e-3};
    simulation.grading = grading;
    simulation.grade_count = 3;
    simulation.law = (struct contact_law){.kind = LAW_LINEAR, .kn = 1e7, .kt_over_kn = 0.8, .mu = 0.5};
    simulation.kappa = kappa;
    simulation.test = TEST_CYCLIC;
    simulation.preparation_mu = 0.3;
    simulation.amplitude = 0.6;
    simulation.lateral_fixed = confined;
    simulation.tolerance = 1e-6;
    return simulation;
}

static double seconds(void)
{
    return (double)clock() / CLOCKS_PER_SEC;
}

/* Every cycle of one long test kept: all trends, starts and lengths are judged on it. */
static int ahead(long grains, size_t cycles)
{
    static const size_t initials[] = {10, 50}, trains[] = {10, 20, 40}, far[] = {10, 20};
    struct simulation simulation = packing_of(grains, 500, 1);
    struct loading loading = {.simulation = &simulation};
    struct cycle_ends all = {0};
    size_t values = 2 * (size_t)grains;
    double *now = malloc(values * sizeof *now), *guess = malloc(values * sizeof *guess);
    if (!now || !guess || placement(&simulation, &loading.dem) || loading_begin(&loading) < 0)
        return failed();
    for (size_t c = 0; c <= cycles; c++) {
        if (c && loading_step(&loading, 1) < 0)
            return failed();
        for (size_t k = 0; k < (size_t)grains; k++)
            now[2 * k] = loading.dem.grains[k].x, now[2 * k + 1] = loading.dem.grains[k].y;
        if (cycle_ends_add(&all, now, values))
            return failed();
    }
    printf("| k_i | k | h | linear: of the positions | of the displacements | logarithmic: of the positions | of the "
           "displacements |\n| --- | --- | --- | --- | --- | --- | --- |\n");
    for (size_t i = 0; i < 2; i++)
        for (size_t t = 0; t < 3; t++)
            for (size_t f = 0; f < 2; f++) {
                size_t from = initials[i], to = from + trains[t], end = to + far[f];
                if (end > cycles)
                    continue;
                printf("| %zu | %zu | %zu |", from, trains[t], far[f]);
                for (int kind = TREND_LINEAR; kind <= TREND_LOGARITHMIC; kind++) {
                    struct cycle_ends part = {values, trains[t] + 1, all.at + from * values, 0};
                    if (cycle_ends_ahead(&part, (enum trend_kind)kind, (double)from, (double)far[f], guess, NULL))
                        return failed();
                    const double *truth = all.at + end * values;
                    printf(" %.4f %% | %.2f %% |", 100 * relative_error(truth, guess, NULL, values),
                           100 * relative_error(truth, guess, all.at, values));
                }
                printf("\n");
            }
    cycle_ends_free(&all);
    dem_free(&loading.dem);
    free(now);
    free(guess);
    return 0;
}

static int loop(int confined, long grains, size_t cycles)
{
    static const size_t plans[][3] = {{20, 20, 20}, {20, 20, 60}, {60, 20, 40}};
    printf("| test | k_i | k | h | simulated | jumps, partings | settlement | error of the settlement | of the height "
           "| of "
           "the positions | of the displacements | z | gained, steps | gained, CPU |\n"
           "| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |\n");
    struct simulation simulation = packing_of(grains, 500, confined);
    struct settle_options options = SETTLE_DEFAULT;
    struct settle_result full, quick;
    options.cycles = cycles;
    options.ahead = 0;
    double begin = seconds();
    if (settle_run(&simulation, &options, &full))
        return failed();
    double full_s = seconds() - begin, truth = full.settlement[cycles];
    printf("| %s | all | | | %zu | | %.4g of the height | | | | | %.3f | | %.1f s |\n",
           confined ? "confined" : "lateral pressure", full.simulated, truth / full.height, full.z[cycles], full_s);
    for (size_t p = 0; p < sizeof plans / sizeof *plans; p++) {
        options.initial = plans[p][0], options.train = plans[p][1], options.ahead = plans[p][2];
        begin = seconds();
        if (settle_run(&simulation, &options, &quick))
            return failed();
        double quick_s = seconds() - begin;
        printf("| | %zu | %zu | %zu | %zu | %zu, %zu | %.4g | %+.2f %% | %+.4f %% | %.4f %% | %.2f %% | %.3f | "
               "%.0f %% | "
               "%.0f %% |\n",
               options.initial, options.train, options.ahead, quick.simulated, quick.jumps, quick.parted,
               quick.settlement[cycles] / full.height, 100 * (quick.settlement[cycles] / truth - 1),
               100 * (truth - quick.settlement[cycles]) / (full.height - truth),
               100 * relative_error(full.end, quick.end, NULL, 2 * full.grains),
               100 * relative_error(full.end, quick.end, full.start, 2 * full.grains), quick.z[cycles],
               100 * ((double)full.steps / (double)quick.steps - 1), 100 * (full_s / quick_s - 1));
        fflush(stdout);
        settle_result_free(&quick);
    }
    settle_result_free(&full);
    return 0;
}

/* Grains displaced at random by a share of the smallest radius, as a bad extrapolation would. */
static int part(long grains)
{
    static const double shares[] = {0.01, 0.03, 0.1};
    printf(
        "| displaced by, of the smallest radius | largest overlap before | after | reduced | in the static packing | "
        "energy | iterations | rises |\n| --- | --- | --- | --- | --- | --- | --- | --- |\n");
    for (int s = 0; s < 3; s++) {
        struct simulation simulation = packing_of(grains, 5000, 1);
        struct loading loading = {.simulation = &simulation};
        struct unpress result;
        static double history[UNPRESS_ITERATIONS];
        double rest = 0;
        int rises = 0;
        if (placement(&simulation, &loading.dem) || loading_begin(&loading) < 0)
            return failed();
        for (size_t p = 0; p < loading.dem.pair_count; p++)
            rest = fmax(rest, loading.dem.pairs[p].touching ? loading.dem.pairs[p].overlap : 0);
        for (size_t k = 0; k < loading.dem.count; k++) {
            struct dem_grain *g = &loading.dem.grains[k];
            double way = shares[s] * 4e-3 / sqrt(2);
            if (g->x - g->radius < 1e-3 || g->y - g->radius < 1e-3 ||
                g->x + g->radius > loading.dem.box.size[BOX_WIDTH] - 1e-3 ||
                g->y + g->radius > loading.dem.box.size[BOX_HEIGHT] - 1e-3)
                continue;
            g->x += way * random_normal(1, 2 * k);
            g->y += way * random_normal(1, 2 * k + 1);
        }
        if (unpress(&loading.dem, history, UNPRESS_ITERATIONS, &result))
            return failed();
        for (int k = 1; k < result.iterations; k++)
            rises += history[k] > history[k - 1];
        printf("| %g | %.3g m | %.3g m | %.1f times | %.3g m | %.3g J to %.3g J | %d | %d |\n", shares[s],
               result.overlap[0], result.overlap[1], result.overlap[0] / result.overlap[1], rest, result.energy[0],
               result.energy[1], result.iterations, rises);
        dem_free(&loading.dem);
    }
    return 0;
}

int main(int argc, char **argv)
{
    long grains = argc > 2 ? atol(argv[2]) : 200;
    size_t cycles = argc > 3 ? (size_t)atol(argv[3]) : 200;
    if (argc > 1 && !strcmp(argv[1], "ahead"))
        return ahead(grains, cycles < 110 ? cycles : 110);
    if (argc > 1 && (!strcmp(argv[1], "confined") || !strcmp(argv[1], "lateral")))
        return loop(argv[1][0] == 'c', grains, cycles);
    if (argc > 1 && !strcmp(argv[1], "part"))
        return part(grains);
    fputs("bench_settlement ahead|confined|lateral|part [GRAINS [CYCLES]]\n", stderr);
    return 2;
}
