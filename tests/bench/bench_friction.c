/* mu from the forces that --method map infers from overlaps with errors, against the mu of the simulation:
 *
 *     bench_friction [GRAINS]    (400) discs, kappa 100 and 1000, sheared to sliding; map is given mu = 2, so that it
 *                                does not cut forces at the answer
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "calibration/rods/friction.h"
#include "pipeline/speak/error.h"
#include "tests/bench/force_states.h"

/* px at 6e-5 m/px in units of the overlap, with <fn> = 66 N and kn = 1e7 N/m. */
#define PIXEL (1e7 * 6e-5 / 66)
static const double TRUTH = 0.5;

struct gathered {
    double *fn, *ft;
    size_t count;
    double r; /* sum over the states */
};

/* The contacts between grains of one state, inferred from its disturbed positions; place < 0: the true forces. */
static int gather(const struct packing *truth, double place, uint64_t seed, struct gathered *gathered)
{
    struct disturbance disturbance = {.place = fmax(place, 0), .seed = seed};
    struct force_options options = FORCE_OPTIONS_DEFAULT;
    struct packing measured = {0};
    struct forces forces = {0};
    const struct forces *dem = packing_forces(truth, "dem"), *use = dem;
    options.law.kn = 1.09e7, options.law.mu = 2;
    options.start = START_OVERLAP;
    options.rescale = 1;
    int status = states_disturb(truth, &disturbance, &measured);
    if (!status && place >= 0) {
        status = infer_forces(&measured, &options, METHOD_MAP, &forces);
        use = &forces;
    }
    for (size_t c = 0; c < truth->contacts.count && !status; c++) {
        if (truth->contacts.flags[c] & CONTACT_WALL)
            continue;
        gathered->fn[gathered->count] = use->contact.fn[c];
        gathered->ft[gathered->count++] = use->contact.ft[c];
    }
    if (!status)
        gathered->r += states_r(truth, &measured, dem->contact.ft, use->contact.ft, 0);
    forces_free(&forces);
    packing_free(&measured);
    return status;
}

static int row(const struct states *states, double kappa, double pixels)
{
    size_t room = 0;
    for (size_t s = 0; s < states->count; s++)
        room += states->state[s].contacts.count;
    struct gathered gathered = {.fn = malloc((room + 1) * sizeof(double)), .ft = malloc((room + 1) * sizeof(double))};
    struct mobilised mobilised;
    int status = gathered.fn && gathered.ft ? 0 : -1;
    for (size_t s = 1; s < states->count && !status; s++)
        status = gather(&states->state[s], pixels * PIXEL, 7 * s, &gathered);
    if (!status) {
        int refused = friction_mobilised(gathered.fn, gathered.ft, gathered.count, &mobilised);
        if (pixels < 0)
            printf("| %g | true forces |", kappa);
        else
            printf("| %g | %g |", kappa, pixels);
        printf(" %zu | %.3f | ", mobilised.contacts, gathered.r / (double)(states->count - 1));
        if (refused)
            printf("no end | |");
        else
            printf("%.4f | %+.1f %% |", mobilised.mu, 100 * (mobilised.mu / TRUTH - 1));
        printf(" %.3f, %.3f, %.3f |\n", mobilised.quantile[2], mobilised.quantile[3], mobilised.quantile[4]);
        fflush(stdout);
    }
    free(gathered.fn);
    free(gathered.ft);
    return status;
}

int main(int argc, char **argv)
{
    static const double kappas[] = {100, 1000}, pixels[] = {-1, 0, 0.0003, 0.001, 0.003, 0.01, 0.03, 0.1};
    double grains = argc > 1 ? atof(argv[1]) : 400;
    int status = 0;
    printf("| kappa | error of the places, px | contacts | r(ft) | mu found (0.5) | error | 90, 95, 99 %% of the "
           "ratios |\n"
           "| --- | --- | --- | --- | --- | --- | --- |\n");
    for (int k = 0; k < 2 && !status; k++) {
        struct states states = {0};
        status = states_simulate(grains, kappas[k], 1, 5, 4e-3, &states);
        for (size_t p = 0; p < sizeof pixels / sizeof *pixels && !status; p++)
            status = row(&states, kappas[k], pixels[p]);
        states_free(&states);
    }
    if (status)
        fprintf(stderr, "bench_friction: %s\n", error_message());
    return status ? 1 : 0;
}
