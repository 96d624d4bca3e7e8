/* Speed against error of the force methods, on virtual states with known forces (docs/forces.md):
 *
 *     bench_forces speed|noise|network|interval|kn|along|range|lost|warm|stability [--kappa K,...] [--grains N]
 *                  [--sample S] [--seed S] [--draws N] [--steps N] [--strain E] [--keep FOLDER]
 *
 * --sample: another packing; --seed: other errors; --draws: so many of them, with mean and standard deviation.
 *
 * All times are CPU seconds of one thread, the network and its factorisation included. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "pipeline/speak/error.h"
#include "tests/bench/force_tables.h"

struct force_options bench_options(void)
{
    struct force_options options = FORCE_OPTIONS_DEFAULT;
    options.law.kn = 1.09e7;
    options.law.mu = 0.5;
    return options;
}

/* Runs of one name. */
struct tally {
    char name[120];
    double runs, converged, iterations, cpu, cpu_most, r[2], square[2], least[2]; /* r of fn, of ft */
};
static struct tally tallies[200];

static void count(const char *name, const struct forces *forces, double cpu, const double r[2])
{
    struct tally *tally = tallies;
    while (tally->runs > 0 && strcmp(tally->name, name) && tally < tallies + 199)
        tally++;
    if (tally->runs == 0)
        tally->least[0] = tally->least[1] = 1;
    snprintf(tally->name, sizeof tally->name, "%s", name);
    tally->runs++, tally->converged += forces->converged, tally->iterations += forces->iterations;
    tally->cpu += cpu, tally->cpu_most = fmax(tally->cpu_most, cpu);
    for (int k = 0; k < 2; k++)
        tally->r[k] += r[k], tally->square[k] += r[k] * r[k], tally->least[k] = fmin(tally->least[k], r[k]);
}

/* Mean, standard deviation and least of what ran more than once under one name. */
static void say_tallies(void)
{
    for (struct tally *tally = tallies; tally < tallies + 200 && tally->runs > 0; tally++) {
        double n = tally->runs, mean[2], deviation[2];
        for (int k = 0; k < 2; k++)
            mean[k] = tally->r[k] / n,
            deviation[k] = n > 1 ? sqrt(fmax(0, tally->square[k] - n * mean[k] * mean[k]) / (n - 1)) : 0;
        if (n > 1)
            printf("%-40s %2.0f of %2.0f converged, mean its %.0f, CPU s mean %.3f most %.3f, r(fn) %.4f +- %.4f least "
                   "%.4f, r(ft) %.4f +- %.4f least %.4f\n",
                   tally->name, tally->converged, n, tally->iterations / n, tally->cpu / n, tally->cpu_most, mean[0],
                   deviation[0], tally->least[0], mean[1], deviation[1], tally->least[1]);
    }
    memset(tallies, 0, sizeof tallies);
}

int bench_measure(const struct packing *truth, const struct packing *packing, const struct force_options *options,
                  enum force_method method, const char *label, const char *name)
{
    struct forces forces;
    double begin = states_cpu();
    if (infer_forces(packing, options, method, &forces))
        return -1;
    double cpu = states_cpu() - begin;
    const struct forces *dem = packing_forces(truth, "dem");
    const double r[2] = {states_r(truth, packing, dem->contact.fn, forces.contact.fn, 1),
                         states_r(truth, packing, dem->contact.ft, forces.contact.ft, 0)};
    printf("%-34s %-4s %-8s %7d %7.3f  %8.1e %s  %.4f  %.4f\n", label, forces.method, forces.start, forces.iterations,
           cpu, forces.imbalance, forces.converged ? "yes" : "no ", r[0], r[1]);
    fflush(stdout);
    char own[120];
    snprintf(own, sizeof own, "%s, %s", label, forces.method);
    count(name ? name : own, &forces, cpu, r);
    forces_free(&forces);
    return 0;
}

static void headline(void)
{
    printf("%-34s %-4s %-8s %7s %7s  %8s %s  %-6s  %s\n", "state", "meth", "start", "its", "cpu/s", "residual", "ok ",
           "r(fn)", "r(ft)");
}

static int run_state(const struct bench *bench, table *make, const struct packing *state, size_t s, double kappa)
{
    char label[60];
    int failed = 0;
    snprintf(label, sizeof label, "kappa %g state %zu", kappa, s);
    for (long d = 0; d < bench->draws && !failed; d++) {
        struct bench here = *bench;
        here.previous = s > 0 ? state - 1 : NULL;
        here.seed += (uint64_t)d;
        failed = make(&here, state, label);
    }
    return failed;
}

static int run(const struct bench *bench, table *make)
{
    headline();
    for (int k = 0; k < bench->kappas; k++) {
        struct states states;
        const struct states_test test = {
            bench->grains, bench->kappa[k], bench->sample, bench->steps, bench->strain, 1e-9, 0};
        int failed = states_keep(bench->folder, &test, &states);
        for (size_t s = 0; !failed && s < states.count; s++)
            failed = run_state(bench, make, &states.state[s], s, bench->kappa[k]);
        states_free(&states);
        if (failed)
            return -1;
        say_tallies();
    }
    return 0;
}

static const struct {
    const char *name;
    table *make;
} TABLES[] = {{"speed", table_speed},        {"noise", table_noise}, {"network", table_network},
              {"interval", table_interval},  {"kn", table_kn},       {"along", table_along},
              {"range", table_range},        {"warm", table_warm},   {"lost", table_lost},
              {"stability", table_stability}};

/* --kappa 100,1000 */
static void parse_kappas(const char *value, struct bench *bench)
{
    for (bench->kappas = 0; *value && bench->kappas < 8; value += *value == ',')
        bench->kappa[bench->kappas++] = strtod(value, (char **)&value);
}

/* 0; -1: no such option. */
static int parse(const char *option, const char *value, struct bench *bench)
{
    if (!strcmp(option, "--kappa"))
        parse_kappas(value, bench);
    else if (!strcmp(option, "--grains"))
        bench->grains = strtod(value, NULL);
    else if (!strcmp(option, "--seed"))
        bench->seed = strtoull(value, NULL, 10);
    else if (!strcmp(option, "--sample"))
        bench->sample = strtoull(value, NULL, 10);
    else if (!strcmp(option, "--draws"))
        bench->draws = strtol(value, NULL, 10);
    else if (!strcmp(option, "--steps"))
        bench->steps = strtol(value, NULL, 10);
    else if (!strcmp(option, "--keep"))
        bench->folder = value;
    else if (!strcmp(option, "--strain"))
        bench->strain = strtod(value, NULL);
    else
        return -1;
    return 0;
}

int main(int argc, char **argv)
{
    struct bench bench = {
        .kappa = {1000}, .kappas = 1, .grains = 1850, .strain = 1e-3, .seed = 7, .sample = 1, .draws = 1};
    table *make = NULL;
    int wrong = argc % 2; /* a table, then pairs */
    for (size_t t = 0; t < sizeof TABLES / sizeof *TABLES && argc > 1; t++)
        if (!strcmp(argv[1], TABLES[t].name))
            make = TABLES[t].make;
    for (int k = 2; k + 1 < argc; k += 2)
        wrong |= parse(argv[k], argv[k + 1], &bench);
    if (!make || wrong) {
        fprintf(stderr, "bench_forces: which table? speed, noise, network, interval, kn, along, range, lost, warm or "
                        "stability [--kappa K,... --grains N --steps N --strain E --sample S --seed S --draws N --keep "
                        "FOLDER]\n");
        return EXIT_USAGE;
    }
    if (!run(&bench, make))
        return EXIT_DONE;
    fprintf(stderr, "bench_forces: %s\n", error_message());
    return EXIT_FAILED;
}
