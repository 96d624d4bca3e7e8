/* Tables of errors: places, radii, lost contacts and rods, kn; and whether the stated intervals hold. */
#include "tests/bench/force_tables.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "pipeline/numbers/random.h"

static int disturbed(const struct bench *bench, const struct packing *truth, const char *label, double place,
                     double radius, int network)
{
    struct disturbance disturbance = {place, radius, 0, network, bench->seed};
    struct packing measured;
    char text[100];
    snprintf(text, sizeof text, "%s place %.3g radius %.3g", label, place, radius);
    int status = states_disturb(truth, &disturbance, &measured);
    for (int method = METHOD_CDM; !status && method <= METHOD_MAP; method++) {
        struct force_options options = bench_options();
        options.start = START_OVERLAP;
        options.rescale = !network;
        options.iterations = method == METHOD_CDM ? 1000 : method == METHOD_QSM ? 400 : 0;
        status = bench_measure(truth, &measured, &options, (enum force_method)method, text, NULL);
    }
    if (!status && !network) { /* all of them were rescaled to the loads; now with kn as given */
        struct force_options options = bench_options();
        snprintf(text, sizeof text, "%s place %.3g radius %.3g kn given", label, place, radius);
        status = bench_measure(truth, &measured, &options, METHOD_MAP, text, NULL);
    }
    packing_free(&measured);
    return status;
}

int table_noise(const struct bench *bench, const struct packing *truth, const char *label)
{
    static const double pixels[] = {0.01, 0.03, 0.1, 0.3};
    for (int k = 0; k < 4; k++)
        if (disturbed(bench, truth, label, PIXEL * pixels[k], 0, 0))
            return -1;
    return disturbed(bench, truth, label, PIXEL * 0.1, PIXEL * 0.1, 0);
}

/* Jitter of a share of the mean overlap, contacts found again. */
int table_network(const struct bench *bench, const struct packing *truth, const char *label)
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
int table_lost(const struct bench *bench, const struct packing *truth, const char *label)
{
    static const struct {
        double pixels, share;
        size_t rods;
    } cases[] = {{0.01, 0, 2}, {0.01, 0.02, 0}, {0.01, 0.02, 2}, {0.03, 0, 2}, {0.03, 0.02, 0}, {0.03, 0.02, 2}};
    unsigned char *lost = malloc(truth->contacts.count + 1);
    int status = lost ? 0 : -1;
    for (size_t k = 0; k < sizeof cases / sizeof *cases && !status; k++) {
        struct disturbance disturbance = {.place = PIXEL * cases[k].pixels, .seed = bench->seed};
        struct force_options options = bench_options();
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
            status = bench_measure(truth, &measured, &options, (enum force_method)method, text, NULL);
        }
        packing_free(&measured);
    }
    free(lost);
    return status;
}

/* Share of the true normal forces that the stated 90 % interval holds, and how its width ranks the errors. */
int table_interval(const struct bench *bench, const struct packing *truth, const char *label)
{
    static const double pixels[] = {0.03, 0.1};
    for (int k = 0; k < 2; k++) {
        struct disturbance disturbance = {PIXEL * pixels[k], 0, 0, 0, bench->seed};
        struct force_options options = bench_options();
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

/* kn wrong by 20 %, rescaled to the loads, against the right kn: what it costs in r. */
int table_kn(const struct bench *bench, const struct packing *truth, const char *label)
{
    static const double pixels[] = {0.03, 0.1}, factors[] = {1, 0.8, 1.2};
    for (int k = 0; k < 2; k++) {
        struct disturbance disturbance = {PIXEL * pixels[k], 0, 0, 0, bench->seed};
        struct packing measured;
        if (states_disturb(truth, &disturbance, &measured))
            return -1;
        for (int rescale = 0; rescale < 2; rescale++)
            for (int f = 0; f < 3; f++) {
                struct force_options options = bench_options();
                char text[100];
                options.start = START_OVERLAP;
                options.law.kn *= factors[f];
                options.rescale = rescale;
                snprintf(text, sizeof text, "%s %.2f px kn x %g%s", label, pixels[k], factors[f],
                         rescale ? " rescaled" : "");
                if (bench_measure(truth, &measured, &options, METHOD_MAP, text, NULL))
                    return -1;
            }
        packing_free(&measured);
    }
    return 0;
}
