/* Tables of speed: to a residual, along a test, from the state before; exact ranges and stability. */
#include "tests/bench/force_tables.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "forces/questions/range.h"
#include "forces/questions/buckling.h"

/* One line per method, start and variant: iterations and CPU seconds to each residual, r at the last that was reached.
 * A residual that was not reached is followed by none that is smaller. */
struct variant {
    enum force_method method;
    enum force_start start;
    int anderson; /* qsm; cdm: over-relaxation 1.3 when negative */
    int block;    /* cdm: sweeps between two accelerations */
    const char *name;
};

static int race(const struct packing *truth, const struct variant *variant, const char *label)
{
    static const double tolerances[] = {1e-2, 1e-4, 1e-6, 1e-8};
    const struct forces *dem = packing_forces(truth, "dem");
    double r[2] = {NAN, NAN};
    printf("%-14s %-24s", label, variant->name);
    for (int t = 0, reached = 1; t < 4; t++) {
        struct force_options options = bench_options();
        struct forces forces;
        options.start = variant->start;
        options.tolerance = tolerances[t];
        options.block = variant->block;
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

int table_speed(const struct bench *bench, const struct packing *truth, const char *label)
{
    static const struct variant variants[] = {{METHOD_CDM, START_ZERO, FORCE_ANDERSON, 0, "cdm, zero"},
                                              {METHOD_CDM, START_ZERO, -1, 0, "cdm, zero, relaxation 1.3"},
                                              {METHOD_CDM, START_ZERO, 10, 10, "cdm, zero, accelerated"},
                                              {METHOD_CDM, START_OVERLAP, FORCE_ANDERSON, 0, "cdm, overlap"},
                                              {METHOD_CDM, START_OVERLAP, 10, 10, "cdm, overlap, accelerated"},
                                              {METHOD_QSM, START_ZERO, 0, 0, "qsm, zero, plain"},
                                              {METHOD_QSM, START_ZERO, FORCE_ANDERSON, 0, "qsm, zero"},
                                              {METHOD_QSM, START_OVERLAP, 0, 0, "qsm, overlap, plain"},
                                              {METHOD_QSM, START_OVERLAP, FORCE_ANDERSON, 0, "qsm, overlap"},
                                              {METHOD_MAP, START_ZERO, FORCE_ANDERSON, 0, "map, zero"},
                                              {METHOD_MAP, START_OVERLAP, FORCE_ANDERSON, 0, "map, overlap (exact)"}};
    (void)bench;
    printf("%-14s %-24s %15s %15s %15s %15s   r(fn) / r(ft)\n", "", "iterations / CPU s to", "1e-2", "1e-4", "1e-6",
           "1e-8");
    for (size_t v = 0; v < sizeof variants / sizeof *variants; v++)
        if (race(truth, &variants[v], label))
            return -1;
    return 0;
}

/* A state started from nothing, from its overlaps, and from the forces of the state before. */
int table_warm(const struct bench *bench, const struct packing *truth, const char *label)
{
    static const enum force_start starts[] = {START_ZERO, START_OVERLAP, START_PREVIOUS};
    static const enum force_method methods[] = {METHOD_CDM, METHOD_CDM, METHOD_QSM, METHOD_MAP};
    for (int m = 0; m < 4 && bench->previous; m++)
        for (int s = 0; s < 3; s++) {
            struct force_options options = bench_options();
            char name[60];
            snprintf(name, sizeof name, "%s%s, %s", method_row(methods[m])->name, m == 1 ? " accelerated" : "",
                     FORCE_STARTS[starts[s]]);
            options.start = starts[s];
            options.previous = bench->previous;
            options.tolerance = methods[m] == METHOD_CDM ? 1e-3 : FORCE_TOLERANCE;
            if (m == 1)
                options.block = options.anderson = 10;
            if (bench_measure(truth, truth, &options, methods[m], label, name))
                return -1;
        }
    return 0;
}

/* Every state of a test (--steps): exact overlaps and 0.1 px; sums at the end. */
int table_along(const struct bench *bench, const struct packing *truth, const char *label)
{
    for (int noise = 0; noise < 2; noise++) {
        struct disturbance disturbance = {noise ? PIXEL * 0.1 : 0, 0, 0, 0, bench->seed};
        struct packing measured;
        char text[100];
        if (noise ? states_disturb(truth, &disturbance, &measured) : packing_copy(truth, &measured))
            return -1;
        snprintf(text, sizeof text, "%s%s", label, noise ? " 0.1 px" : "");
        for (int method = METHOD_QSM; method <= METHOD_MAP; method++) {
            struct force_options options = bench_options();
            char name[40];
            snprintf(name, sizeof name, "%s, %s", method_row(method)->name, noise ? "0.1 px" : "exact overlaps");
            options.start = START_OVERLAP;
            options.rescale = noise;
            if (bench_measure(truth, &measured, &options, (enum force_method)method, text, name))
                return -1;
        }
        packing_free(&measured);
    }
    struct force_options options = bench_options();
    options.start = START_ZERO;
    return bench_measure(truth, truth, &options, METHOD_MAP, label, "map, zero");
}

/* Exact least and largest fn of five contacts: CPU seconds a contact. */
int table_range(const struct bench *bench, const struct packing *truth, const char *label)
{
    (void)bench;
    const struct forces *dem = packing_forces(truth, "dem");
    double mean = states_mean_force(truth);
    for (int k = 0; k < 5; k++) {
        struct force_options options = bench_options();
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

static int say_stability(const struct packing *packing, struct forces *forces, const char *label, const char *whose)
{
    struct force_options options = bench_options();
    size_t slipping = 0;
    for (size_t c = 0; c < forces->contact.count; c++)
        slipping += forces->contact.status[c] == STATUS_SLIP;
    double begin = states_cpu();
    if (stability_of_forces(packing, &options, forces))
        return -1;
    printf("%-24s %-13s %4zu slip, smallest eigenvalue / kn: %.3e all stick, %.3e as they are, %.3f cpu s\n", label,
           whose, slipping, forces->stability[0], forces->stability[1], states_cpu() - begin);
    fflush(stdout);
    return 0;
}

/* The smallest eigenvalue of K for the true forces and for those of map, from exact overlaps and at 0.03 px. */
int table_stability(const struct bench *bench, const struct packing *truth, const char *label)
{
    static const char *const whose[] = {"truth", "map, exact", "map, 0.03 px"};
    int status = 0;
    for (int k = 0; k < 3 && !status; k++) {
        struct disturbance disturbance = {k == 2 ? PIXEL * 0.03 : 0, 0, 0, 0, bench->seed};
        struct force_options options = bench_options();
        struct packing measured;
        struct forces forces;
        if (k == 2 ? states_disturb(truth, &disturbance, &measured) : packing_copy(truth, &measured))
            return -1;
        status = infer_forces(&measured, &options, METHOD_MAP, &forces);
        const struct contact_forces *dem = &packing_forces(truth, "dem")->contact;
        for (size_t c = 0; c < dem->count && k == 0 && !status; c++)
            forces.contact.fn[c] = dem->fn[c], forces.contact.ft[c] = dem->ft[c],
            forces.contact.status[c] = dem->status[c];
        if (!status)
            status = say_stability(&measured, &forces, label, whose[k]);
        forces_free(&forces);
        packing_free(&measured);
    }
    return status;
}
