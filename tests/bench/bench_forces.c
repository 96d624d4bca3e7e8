/* Speed against error of the force methods, on virtual states with known forces (docs/forces.md):
 *
 *     bench_forces speed|noise|network|interval|kn|along|range|warm [--kappa K,...] [--grains N] [--seed S] [--steps N]
 *                  [--strain E] [--keep FOLDER]
 *
 * All times are CPU seconds of one thread, the network and its factorisation included. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "forces/range.h"
#include "pipeline/error.h"
#include "pipeline/random.h"
#include "tests/bench/force_states.h"

struct bench {
    double kappa[8], grains;
    int kappas;
    long steps;
    double strain; /* of a step */
    uint64_t seed;
    const char *folder;             /* of kept states; NULL: none */
    const struct packing *previous; /* state before this one, with its true forces; NULL: none */
};

static struct force_options usual(void)
{
    struct force_options options = FORCE_OPTIONS_DEFAULT;
    options.law.kn = 1.09e7;
    options.law.mu = 0.5;
    return options;
}

/* Many runs of one kind. */
struct tally {
    const char *name;
    double runs, converged, iterations, cpu, cpu_most, rn, rt, rn_least, rt_least;
};

static void tally_add(struct tally *tally, const struct forces *forces, double cpu, double rn, double rt)
{
    if (tally->runs == 0)
        tally->rn_least = tally->rt_least = 1;
    tally->runs++, tally->converged += forces->converged, tally->iterations += forces->iterations;
    tally->cpu += cpu, tally->cpu_most = fmax(tally->cpu_most, cpu);
    tally->rn += rn, tally->rt += rt;
    tally->rn_least = fmin(tally->rn_least, rn), tally->rt_least = fmin(tally->rt_least, rt);
}

static void tally_say(struct tally *tally)
{
    if (tally->runs > 0)
        printf("%-26s %3.0f of %3.0f converged, mean its %.0f, CPU s mean %.3f most %.3f, r(fn) mean %.4f least %.4f, "
               "r(ft) mean %.4f "
               "least %.4f\n",
               tally->name, tally->converged, tally->runs, tally->iterations / tally->runs, tally->cpu / tally->runs,
               tally->cpu_most, tally->rn / tally->runs, tally->rn_least, tally->rt / tally->runs, tally->rt_least);
    tally->runs = tally->converged = tally->iterations = tally->cpu = tally->cpu_most = tally->rn = tally->rt = 0;
}

static struct tally *counted; /* of the next runs; NULL: none */

/* One run, one line. */
static int measure(const struct packing *truth, const struct packing *packing, const struct force_options *options,
                   enum force_method method, const char *label)
{
    struct forces forces;
    double begin = states_cpu();
    if (infer_forces(packing, options, method, &forces))
        return -1;
    double cpu = states_cpu() - begin;
    const struct forces *dem = packing_forces(truth, "dem");
    double rn = states_r(truth, packing, dem->contact.fn, forces.contact.fn, 1);
    double rt = states_r(truth, packing, dem->contact.ft, forces.contact.ft, 0);
    printf("%-34s %-4s %-8s %7d %7.3f  %8.1e %s  %.4f  %.4f\n", label, forces.method, forces.start, forces.iterations,
           cpu, forces.imbalance, forces.converged ? "yes" : "no ", rn, rt);
    if (counted)
        tally_add(counted, &forces, cpu, rn, rt);
    fflush(stdout);
    forces_free(&forces);
    return 0;
}

static void headline(void)
{
    printf("%-34s %-4s %-8s %7s %7s  %8s %s  %-6s  %s\n", "state", "meth", "start", "its", "cpu/s", "residual", "ok ",
           "r(fn)", "r(ft)");
}

typedef int table(const struct bench *bench, const struct packing *truth, const char *label);

/* One line per method, start and variant: iterations and CPU seconds to each residual, r at the last that was reached.
 * A residual that was not reached is followed by none that is smaller. */
struct variant {
    enum force_method method;
    enum force_start start;
    int anderson; /* qsm; cdm: over-relaxation 1.3 when negative */
    const char *name;
};

static int race(const struct packing *truth, const struct variant *variant, const char *label)
{
    static const double tolerances[] = {1e-2, 1e-4, 1e-6, 1e-8};
    const struct forces *dem = packing_forces(truth, "dem");
    double r[2] = {NAN, NAN};
    printf("%-14s %-24s", label, variant->name);
    for (int t = 0, reached = 1; t < 4; t++) {
        struct force_options options = usual();
        struct forces forces;
        options.start = variant->start;
        options.tolerance = tolerances[t];
        if (variant->anderson >= 0)
            options.anderson = variant->anderson;
        else
            options.relaxation = 1.3;
        if (!reached) {
            printf(" %15s", "-");
            continue;
        }
        double begin = states_cpu();
        if (infer_forces(truth, &options, variant->method, &forces))
            return -1;
        double cpu = states_cpu() - begin;
        reached = forces.converged;
        if (reached)
            printf(" %7d / %5.3f", forces.iterations, cpu);
        else
            printf(" %7.0e in %4.2f", forces.imbalance, cpu);
        r[0] = states_r(truth, truth, dem->contact.fn, forces.contact.fn, 1);
        r[1] = states_r(truth, truth, dem->contact.ft, forces.contact.ft, 0);
        forces_free(&forces);
    }
    printf("   %.3f / %.3f\n", r[0], r[1]);
    fflush(stdout);
    return 0;
}

static int table_speed(const struct bench *bench, const struct packing *truth, const char *label)
{
    static const struct variant variants[] = {{METHOD_CDM, START_ZERO, FORCE_ANDERSON, "cdm, zero"},
                                              {METHOD_CDM, START_ZERO, -1, "cdm, zero, relaxation 1.3"},
                                              {METHOD_CDM, START_OVERLAP, FORCE_ANDERSON, "cdm, overlap"},
                                              {METHOD_QSM, START_ZERO, 0, "qsm, zero, plain"},
                                              {METHOD_QSM, START_ZERO, FORCE_ANDERSON, "qsm, zero"},
                                              {METHOD_QSM, START_OVERLAP, 0, "qsm, overlap, plain"},
                                              {METHOD_QSM, START_OVERLAP, FORCE_ANDERSON, "qsm, overlap"},
                                              {METHOD_MAP, START_ZERO, FORCE_ANDERSON, "map, zero"},
                                              {METHOD_MAP, START_OVERLAP, FORCE_ANDERSON, "map, overlap (exact)"}};
    (void)bench;
    printf("%-14s %-24s %15s %15s %15s %15s   r(fn) / r(ft)\n", "", "iterations / CPU s to", "1e-2", "1e-4", "1e-6",
           "1e-8");
    for (size_t v = 0; v < sizeof variants / sizeof *variants; v++)
        if (race(truth, &variants[v], label))
            return -1;
    return 0;
}

/* Errors as in the table of the joint estimate: s px with <fn> = 66 N, kn = 1e7 N/m and 6e-5 m/px. */
#define PIXEL (1e7 * 6e-5 / 66)

static int disturbed(const struct bench *bench, const struct packing *truth, const char *label, double place,
                     double radius, int network)
{
    struct disturbance disturbance = {place, radius, 0, network, bench->seed};
    struct packing measured;
    char text[100];
    snprintf(text, sizeof text, "%s place %.3g radius %.3g", label, place, radius);
    int status = states_disturb(truth, &disturbance, &measured);
    for (int method = METHOD_CDM; !status && method <= METHOD_MAP; method++) {
        struct force_options options = usual();
        options.start = START_OVERLAP;
        options.rescale = !network;
        options.iterations = method == METHOD_CDM ? 1000 : method == METHOD_QSM ? 400 : 0;
        status = measure(truth, &measured, &options, (enum force_method)method, text);
    }
    packing_free(&measured);
    return status;
}

static int table_noise(const struct bench *bench, const struct packing *truth, const char *label)
{
    static const double pixels[] = {0.01, 0.03, 0.1, 0.3};
    for (int k = 0; k < 4; k++)
        if (disturbed(bench, truth, label, PIXEL * pixels[k], 0, 0))
            return -1;
    return disturbed(bench, truth, label, PIXEL * 0.1, PIXEL * 0.1, 0);
}

/* Jitter of a share of the mean overlap, contacts found again. */
static int table_network(const struct bench *bench, const struct packing *truth, const char *label)
{
    static const double jitter[] = {0.1, 0.3, 1};
    for (int k = 0; k < 3; k++)
        if (disturbed(bench, truth, label, jitter[k], 0, 1))
            return -1;
    return 0;
}

/* Take out the rows that are marked, as if they had never been found. */
static void forget_contacts(struct contacts *contacts, const unsigned char *lost)
{
    size_t kept = 0;
    for (size_t c = 0; c < contacts->count; c++, kept += !lost[c - 1])
        for (size_t k = 0; k < CONTACTS.column_count; k++) {
            size_t size = column_size(CONTACTS.columns[k].type);
            char *values = *(char **)table_array(&CONTACTS.columns[k], contacts);
            if (values && !lost[c])
                memmove(values + kept * size, values + c * size, size);
        }
    contacts->count = kept;
}

/* Marks the contacts of `rods` grains that carry at least three mean forces in all, and a share of all contacts. */
static void lose(const struct packing *truth, size_t rods, double share, uint64_t seed, unsigned char *lost)
{
    const struct contacts *contacts = &truth->contacts;
    const double *fn = packing_forces(truth, "dem")->contact.fn, mean = states_mean_force(truth);
    for (size_t c = 0; c < contacts->count; c++)
        lost[c] = random_uniform(seed + 5, c) < share;
    for (uint64_t k = 0; rods > 0; k++) {
        int64_t grain = (int64_t)(random_bits(seed + 99, k) % truth->grains.count);
        double carried = 0;
        for (size_t c = 0; c < contacts->count; c++)
            carried += contacts->i[c] == grain || contacts->j[c] == grain ? fn[c] : 0;
        if (carried < 3 * mean)
            continue;
        for (size_t c = 0; c < contacts->count; c++)
            lost[c] |= contacts->i[c] == grain || contacts->j[c] == grain;
        rods--;
    }
}

/* Rods that were not found and contacts that are missing, at an error of the places of 0.01 and 0.03 px. r counts what
 * is missing as 0, so that it cannot reach 1. */
static int table_lost(const struct bench *bench, const struct packing *truth, const char *label)
{
    static const struct {
        double pixels, share;
        size_t rods;
    } cases[] = {{0.01, 0, 2}, {0.01, 0.02, 0}, {0.01, 0.02, 2}, {0.03, 0, 2}, {0.03, 0.02, 0}, {0.03, 0.02, 2}};
    unsigned char *lost = malloc(truth->contacts.count + 1);
    int status = lost ? 0 : -1;
    for (size_t k = 0; k < sizeof cases / sizeof *cases && !status; k++) {
        struct disturbance disturbance = {.place = PIXEL * cases[k].pixels, .seed = bench->seed};
        struct force_options options = usual();
        struct packing measured;
        char text[100];
        snprintf(text, sizeof text, "%s %.2f px lost %zu rods %g %%", label, cases[k].pixels, cases[k].rods,
                 100 * cases[k].share);
        options.rescale = 1;
        options.start = START_OVERLAP;
        status = states_disturb(truth, &disturbance, &measured);
        lose(truth, cases[k].rods, cases[k].share, bench->seed, lost);
        forget_contacts(&measured.contacts, lost);
        for (int method = METHOD_QSM; !status && method <= METHOD_MAP; method++) {
            options.iterations = method == METHOD_QSM ? 400 : 0;
            status = measure(truth, &measured, &options, (enum force_method)method, text);
        }
        packing_free(&measured);
    }
    free(lost);
    return status;
}

/* Share of the true normal forces that the stated 90 % interval holds, and how its width ranks the errors. */
static int table_interval(const struct bench *bench, const struct packing *truth, const char *label)
{
    static const double pixels[] = {0.03, 0.1};
    for (int k = 0; k < 2; k++) {
        struct disturbance disturbance = {PIXEL * pixels[k], 0, 0, 0, bench->seed};
        struct force_options options = usual();
        struct packing measured;
        struct forces forces;
        options.samples = 40;
        if (states_disturb(truth, &disturbance, &measured))
            return -1;
        double begin = states_cpu();
        if (infer_forces(&measured, &options, METHOD_MAP, &forces))
            return -1;
        const double *fn = packing_forces(truth, "dem")->contact.fn;
        double held = 0, used = 0, square = 0;
        for (size_t c = 0; c < forces.contact.count; c++) {
            if (forces.contact.status[c] == STATUS_NOT_USED)
                continue;
            double slack = 1e-6 * states_mean_force(truth);
            held += fn[c] >= forces.contact.fn_min[c] - slack && fn[c] <= forces.contact.fn_max[c] + slack;
            square += pow((forces.contact.fn[c] - fn[c]) / (forces.contact.s_fn[c] + slack), 2);
            used++;
        }
        printf(
            "%-34s %.2f px: %.1f %% of the true fn in the 90 %% interval, rms error / s_fn %.2f, %.3f cpu s a draw\n",
            label, pixels[k], 100 * held / used, sqrt(square / used), (states_cpu() - begin) / 41);
        forces_free(&forces);
        packing_free(&measured);
    }
    return 0;
}

static struct tally warm[] = {{.name = "cdm, zero"}, {.name = "cdm, overlap"}, {.name = "cdm, previous"},
                              {.name = "qsm, zero"}, {.name = "qsm, overlap"}, {.name = "qsm, previous"},
                              {.name = "map, zero"}, {.name = "map, overlap"}, {.name = "map, previous"}};

/* A state started from nothing, from its overlaps, and from the forces of the state before. */
static int table_warm(const struct bench *bench, const struct packing *truth, const char *label)
{
    static const enum force_start starts[] = {START_ZERO, START_OVERLAP, START_PREVIOUS};
    for (int method = METHOD_CDM; method <= METHOD_MAP && bench->previous; method++)
        for (int s = 0; s < 3; s++) {
            struct force_options options = usual();
            options.start = starts[s];
            options.previous = bench->previous;
            options.tolerance = method == METHOD_CDM ? 1e-3 : FORCE_TOLERANCE;
            counted = &warm[3 * (method - METHOD_CDM) + s];
            if (measure(truth, truth, &options, (enum force_method)method, label))
                return -1;
        }
    return 0;
}

/* kn wrong by 20 %, rescaled to the loads, against the right kn: what it costs in r. */
static int table_kn(const struct bench *bench, const struct packing *truth, const char *label)
{
    static const double pixels[] = {0.03, 0.1}, factors[] = {1, 0.8, 1.2};
    for (int k = 0; k < 2; k++) {
        struct disturbance disturbance = {PIXEL * pixels[k], 0, 0, 0, bench->seed};
        struct packing measured;
        if (states_disturb(truth, &disturbance, &measured))
            return -1;
        for (int rescale = 0; rescale < 2; rescale++)
            for (int f = 0; f < 3; f++) {
                struct force_options options = usual();
                char text[100];
                options.start = START_OVERLAP;
                options.law.kn *= factors[f];
                options.rescale = rescale;
                snprintf(text, sizeof text, "%s %.2f px kn x %g%s", label, pixels[k], factors[f],
                         rescale ? " rescaled" : "");
                if (measure(truth, &measured, &options, METHOD_MAP, text))
                    return -1;
            }
        packing_free(&measured);
    }
    return 0;
}

static struct tally along[] = {{.name = "qsm, exact overlaps"},
                               {.name = "map, exact overlaps"},
                               {.name = "qsm, 0.1 px"},
                               {.name = "map, 0.1 px"},
                               {.name = "map, zero"}};

/* Every state of a test (--steps): exact overlaps and 0.1 px; sums at the end. */
static int table_along(const struct bench *bench, const struct packing *truth, const char *label)
{
    for (int noise = 0; noise < 2; noise++) {
        struct disturbance disturbance = {noise ? PIXEL * 0.1 : 0, 0, 0, 0, bench->seed};
        struct packing measured;
        char text[100];
        if (noise ? states_disturb(truth, &disturbance, &measured) : packing_copy(truth, &measured))
            return -1;
        snprintf(text, sizeof text, "%s%s", label, noise ? " 0.1 px" : "");
        for (int method = METHOD_QSM; method <= METHOD_MAP; method++) {
            struct force_options options = usual();
            options.start = START_OVERLAP;
            options.rescale = noise;
            counted = &along[2 * noise + method - METHOD_QSM];
            if (measure(truth, &measured, &options, (enum force_method)method, text))
                return -1;
        }
        packing_free(&measured);
    }
    struct force_options options = usual();
    options.start = START_ZERO;
    counted = &along[4];
    int status = measure(truth, truth, &options, METHOD_MAP, label);
    counted = NULL;
    return status;
}

/* Exact least and largest fn of five contacts: CPU seconds a contact. */
static int table_range(const struct bench *bench, const struct packing *truth, const char *label)
{
    (void)bench;
    const struct forces *dem = packing_forces(truth, "dem");
    double mean = states_mean_force(truth);
    for (int k = 0; k < 5; k++) {
        struct force_options options = usual();
        struct forces forces;
        char rows[40];
        size_t row = (2 * (size_t)k + 1) * truth->contacts.count / 10;
        snprintf(rows, sizeof rows, "%zu", row);
        options.range = rows;
        if (infer_forces(truth, &options, METHOD_MAP, &forces))
            return -1;
        double begin = states_cpu();
        if (range_forces(truth, &options, METHOD_MAP, &forces))
            return -1;
        printf("%-24s contact %5zu: true fn %.3f, least %.4f, largest %.4f <fn>, %.2f cpu s\n", label, row,
               dem->contact.fn[row] / mean, forces.contact.fn_low[row] / mean, forces.contact.fn_high[row] / mean,
               states_cpu() - begin);
        fflush(stdout);
        forces_free(&forces);
    }
    return 0;
}

static int run(const struct bench *bench, table *make)
{
    headline();
    for (int k = 0; k < bench->kappas; k++) {
        struct states states;
        const struct states_test test = {bench->grains, bench->kappa[k], 1, bench->steps, bench->strain, 1e-9, 0};
        int failed = states_keep(bench->folder, &test, &states);
        for (size_t s = 0; !failed && s < states.count; s++) {
            char label[60];
            snprintf(label, sizeof label, "kappa %g state %zu", bench->kappa[k], s);
            struct bench here = *bench;
            here.previous = s > 0 ? &states.state[s - 1] : NULL;
            failed = make(&here, &states.state[s], label);
        }
        states_free(&states);
        if (failed)
            return -1;
        for (size_t t = 0; t < sizeof along / sizeof *along; t++)
            tally_say(&along[t]);
        for (size_t t = 0; t < sizeof warm / sizeof *warm; t++)
            tally_say(&warm[t]);
        counted = NULL;
    }
    return 0;
}

int main(int argc, char **argv)
{
    static const struct {
        const char *name;
        table *make;
    } tables[] = {{"speed", table_speed},       {"noise", table_noise}, {"network", table_network},
                  {"interval", table_interval}, {"kn", table_kn},       {"along", table_along},
                  {"range", table_range},       {"warm", table_warm},   {"lost", table_lost}};
    struct bench bench = {.kappa = {1000}, .kappas = 1, .grains = 1850, .strain = 1e-3, .seed = 7};
    table *make = NULL;
    for (int k = 1; k < argc; k++) {
        const char *value = k + 1 < argc ? argv[k + 1] : "";
        for (size_t t = 0; t < sizeof tables / sizeof *tables; t++)
            if (!strcmp(argv[k], tables[t].name))
                make = tables[t].make;
        if (!strcmp(argv[k], "--kappa"))
            for (bench.kappas = 0; *value && bench.kappas < 8; value += *value == ',')
                bench.kappa[bench.kappas++] = strtod(value, (char **)&value);
        if (!strcmp(argv[k], "--grains"))
            bench.grains = strtod(value, NULL);
        if (!strcmp(argv[k], "--seed"))
            bench.seed = strtoull(value, NULL, 10);
        if (!strcmp(argv[k], "--steps"))
            bench.steps = strtol(value, NULL, 10);
        if (!strcmp(argv[k], "--keep"))
            bench.folder = value;
        if (!strcmp(argv[k], "--strain"))
            bench.strain = strtod(value, NULL);
    }
    if (!make) {
        fprintf(stderr,
                "bench_forces: which table? speed, noise, network, interval, kn, along, range, lost or warm [--kappa "
                "K,... --grains N "
                "--steps N]\n");
        return EXIT_USAGE;
    }
    if (!run(&bench, make))
        return EXIT_DONE;
    fprintf(stderr, "bench_forces: %s\n", error_message());
    return EXIT_FAILED;
}
