/* How the methods grow with the packing (docs/forces.md):
 *
 *     bench_forces_size [--kappa K] [--most N] [--keep FOLDER]
 *
 * States of 100 and 1000 grains are made by simulate; the larger ones are mirrored copies of the second (tiles.h),
 * which are in equilibrium to its own 1e-9; --most 2e6: also one of a million. CPU seconds of one thread to a residual
 * of 1e-6 (cdm: 1e-2), and the exponent of the growth since the size before. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "pipeline/speak/error.h"
#include "tests/bench/force_states.h"
#include "tests/bench/tiles.h"

struct run {
    const char *name;
    enum force_method method;
    enum force_start start;
    double tolerance, most; /* grains */
    double noise;           /* px of the places: the joint form of map */
};

static const struct run RUNS[] = {{"cdm, overlap, 1e-2", METHOD_CDM, START_OVERLAP, 1e-2, 20000, 0},
                                  {"qsm, overlap, 1e-6", METHOD_QSM, START_OVERLAP, 1e-6, 1e6, 0},
                                  {"map, zero, 1e-6", METHOD_MAP, START_ZERO, 1e-6, 2e6, 0},
                                  {"map, overlap, 1e-6", METHOD_MAP, START_OVERLAP, 1e-6, 2e6, 0},
                                  {"map, 0.03 px, 1e-6", METHOD_MAP, START_OVERLAP, 1e-6, 20000, 0.03}};
enum { RUN_COUNT = sizeof RUNS / sizeof *RUNS };
static double last_cpu[RUN_COUNT], last_grains;

static int measure(const struct packing *truth, int r)
{
    const struct run *run = &RUNS[r];
    struct force_options options = FORCE_OPTIONS_DEFAULT;
    struct disturbance disturbance = {.place = run->noise * 1e7 * 6e-5 / 66, .seed = 7};
    struct packing measured;
    struct forces forces;
    double grains = (double)truth->grains.count;
    options.law.kn = 1.09e7, options.law.mu = 0.5;
    options.start = run->start, options.tolerance = run->tolerance;
    if (grains > run->most)
        return 0;
    if (run->noise > 0 ? states_disturb(truth, &disturbance, &measured) : packing_copy(truth, &measured))
        return -1;
    double begin = states_cpu();
    if (infer_forces(&measured, &options, run->method, &forces))
        return -1;
    double cpu = states_cpu() - begin;
    printf("%8.0f %8zu  %-20s %7d %9.3f %9.1e %s", grains, truth->contacts.count, run->name, forces.iterations, cpu,
           forces.imbalance, forces.converged ? "yes" : "no ");
    if (last_grains > 0 && last_cpu[r] > 0)
        printf("   N^%.2f", log(cpu / last_cpu[r]) / log(grains / last_grains));
    printf("\n");
    fflush(stdout);
    last_cpu[r] = cpu;
    forces_free(&forces);
    packing_free(&measured);
    return 0;
}

static int measure_all(const struct packing *truth)
{
    for (int r = 0; r < RUN_COUNT; r++)
        if (measure(truth, r))
            return -1;
    last_grains = (double)truth->grains.count;
    return 0;
}

static int run(double kappa, double most, const char *folder)
{
    static const size_t copies[] = {1, 3, 10, 32};
    struct states small, tile;
    printf("%8s %8s  %-20s %7s %9s %9s %s\n", "grains", "contacts", "", "its", "CPU s", "residual", "ok");
    const struct states_test first = {100, kappa, 1, 0, 0, 1e-9, 0}, second = {1000, kappa, 1, 0, 0, 1e-9, 0};
    if (states_keep(folder, &first, &small) || measure_all(&small.state[0]) || states_keep(folder, &second, &tile))
        return -1;
    for (size_t k = 0; k < sizeof copies / sizeof *copies; k++) {
        struct packing packing;
        if ((double)(copies[k] * copies[k] * tile.state[0].grains.count) > most)
            break;
        if (tiles_mirrored(&tile.state[0], copies[k], &packing) || measure_all(&packing))
            return -1;
        packing_free(&packing);
    }
    states_free(&small);
    states_free(&tile);
    return 0;
}

int main(int argc, char **argv)
{
    double kappa = 1000, most = 1e6;
    const char *folder = NULL;
    for (int k = 1; k + 1 < argc; k += 2) {
        if (!strcmp(argv[k], "--kappa"))
            kappa = strtod(argv[k + 1], NULL);
        if (!strcmp(argv[k], "--keep"))
            folder = argv[k + 1];
        if (!strcmp(argv[k], "--most"))
            most = strtod(argv[k + 1], NULL);
    }
    if (!run(kappa, most, folder))
        return EXIT_DONE;
    fprintf(stderr, "bench_forces_size: %s\n", error_message());
    return EXIT_FAILED;
}
