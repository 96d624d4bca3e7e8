/* Long-term settlement of packings under cycles, against simulating every cycle.
 *
 *     bench_settlement ahead [GRAINS]                 how far off an extrapolation is: trends, k, h (the paper's Figs 6
 *                                                     and 7)
 *     bench_settlement confined [GRAINS [PACKINGS]]   the k_i / k / h loop at 180 % gained (Figs 11 and 12), and how
 * far two full simulations part that differ by a billionth of a radius bench_settlement lateral [GRAINS [PACKINGS]] the
 * same under a lateral pressure (Fig. 13) bench_settlement part [GRAINS]                  parting of grains that
 * overlap (Fig. 9)
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "calibration/settlement/settle_loop.h"
#include "pipeline/speak/error.h"
#include "pipeline/numbers/random.h"
#include "simulation/dem/loading.h"
#include "simulation/dem/placement.h"

static struct grade grading[3];

static int failed(void)
{
    fprintf(stderr, "bench_settlement: %s\n", error_message());
    return 1;
}

/* Loose, as the paper's: the friction of the test during the compression too. */
static struct simulation packing_of(long grains, double kappa, int confined, uint64_t seed)
{
    struct simulation simulation = SIMULATION_DEFAULT;
    grading[0] = (struct grade){grains / 2, 8e-3};
    grading[1] = (struct grade){grains * 3 / 10, 12e-3};
    grading[2] = (struct grade){grains - grains / 2 - grains * 3 / 10, 14e-3};
    simulation.seed = seed;
    simulation.grading = grading;
    simulation.grade_count = 3;
    simulation.law = (struct contact_law){.row = &linear_law, .kn = 1e7, .kt_over_kn = 0.8, .mu = 0.5};
    simulation.kappa = kappa;
    simulation.test = TEST_CYCLIC;
    simulation.amplitude = confined ? 0.9 : 0.3;
    simulation.lateral_fixed = confined;
    simulation.tolerance = 1e-6;
    simulation.time_step = 0.2;
    return simulation;
}

static double seconds(void)
{
    return (double)clock() / CLOCKS_PER_SEC;
}

static void look(const struct dem *dem, double *at)
{
    for (size_t k = 0; k < dem->count; k++)
        at[2 * k] = dem->grains[k].x, at[2 * k + 1] = dem->grains[k].y;
}

/* ---- extrapolation ---- */

static int keep_every_cycle(struct loading *loading, size_t cycles, struct cycle_ends *all)
{
    int status = placement(loading->simulation, &loading->dem) || loading_begin(loading) < 0 ? -1 : 0;
    size_t values = 2 * loading->dem.count;
    double *now = malloc((values + 1) * sizeof *now);
    if (!now)
        return -1;
    for (size_t c = 0; c <= cycles && !status; c++) {
        if (c)
            status = loading_step(loading, 1) < 0 ? -1 : 0;
        look(&loading->dem, now);
        if (!status)
            status = cycle_ends_add(all, (double)c, now, values);
    }
    free(now);
    return status;
}

/* One row: errors of the positions, of the displacements since cycle 0, and since the training began, for each trend.
 */
static int judge_trends(const struct cycle_ends *all, size_t from, size_t k, size_t h, double *guess)
{
    size_t values = all->values;
    const double *truth = all->at + (from + k + h) * values;
    printf("| %zu | %zu | %zu |", from, k, h);
    for (int kind = TREND_LINEAR; kind <= TREND_LOG; kind++) {
        struct cycle_ends part = {values, k + 1, all->at + from * values, all->cycle + from, 0};
        if (cycle_ends_ahead(&part, (enum trend_kind)kind, (double)h, guess, NULL))
            return -1;
        printf(" %.2f %%, %.1f %%, %.0f %% |", 100 * relative_error(truth, guess, NULL, values),
               100 * relative_error(truth, guess, all->at, values),
               100 * relative_error(truth, guess, all->at + from * values, values));
    }
    printf("\n");
    return 0;
}

/* Every cycle of one long test kept: all trends, starts and lengths are judged on it. */
static int ahead(long grains)
{
    static const size_t initials[] = {10, 50, 100}, trains[] = {10, 20, 40}, far[] = {10, 20};
    struct simulation simulation = packing_of(grains, 500, 1, 1);
    struct loading loading = {.simulation = &simulation};
    struct cycle_ends all = {0};
    double *guess = malloc(2 * (size_t)grains * sizeof *guess);
    int status = guess ? keep_every_cycle(&loading, 160, &all) : -1;
    printf("| k_i | k | h | linear: positions, displacements since cycle 0, since the training began | logarithmic | "
           "log |\n"
           "| --- | --- | --- | --- | --- | --- |\n");
    for (size_t i = 0; i < 3; i++)
        for (size_t t = 0; t < 3; t++)
            for (size_t f = 0; f < 2 && !status; f++)
                status = judge_trends(&all, initials[i], trains[t], far[f], guess);
    cycle_ends_free(&all);
    dem_free(&loading.dem);
    free(guess);
    return status ? failed() : 0;
}

/* ---- the loop against every cycle ---- */

enum { CYCLES = 140, SIMULATED = 50 }; /* 180 % gained */

struct course {
    double height, settled, z; /* z of the end */
    double *start, *end;
    long steps;
    double cpu;
};

static int run_cycles(struct loading *loading, size_t cycles)
{
    for (size_t c = 0; c < cycles; c++)
        if (loading_step(loading, 1) < 0)
            return -1;
    return 0;
}

static void finish(const struct loading *loading, double height, struct course *course)
{
    const struct dem *dem = &loading->dem;
    size_t contacts = 0;
    for (size_t p = 0; p < dem->first[dem->count]; p++)
        contacts += (size_t)dem->pairs[p].touching;
    course->height = height;
    course->settled = height - dem->box.size[BOX_HEIGHT];
    course->z = 2 * (double)contacts / (double)dem->count;
    look(dem, course->end);
}

/* Every cycle; and the same again from cycle SIMULATED on, grains nudged by a billionth of their radius. */
static int every_cycle(const struct simulation *simulation, struct course *full, struct course *twin)
{
    struct loading loading = {.simulation = simulation}, other;
    double begin = seconds();
    if (placement(simulation, &loading.dem) || loading_begin(&loading) < 0)
        return -1;
    double height = loading.dem.box.size[BOX_HEIGHT];
    long steps = loading.steps;
    look(&loading.dem, full->start);
    int status = run_cycles(&loading, SIMULATED);
    other = loading;
    memset(&other.dem, 0, sizeof other.dem);
    if (!status)
        status = dem_copy(&loading.dem, &other.dem) || run_cycles(&loading, CYCLES - SIMULATED) ? -1 : 0;
    full->cpu = seconds() - begin;
    full->steps = loading.steps - steps;
    for (size_t k = 0; k < other.dem.count && !status; k++)
        other.dem.grains[k].y += 1e-9 * other.dem.grains[k].radius * random_normal(2, k);
    if (!status)
        status = run_cycles(&other, CYCLES - SIMULATED);
    if (!status) {
        finish(&loading, height, full);
        finish(&other, height, twin);
    }
    dem_free(&loading.dem);
    dem_free(&other.dem);
    return status;
}

/* Errors over the packings. */
struct tally {
    double settlement, squares, worst, height, positions, displacements, z, steps, cpu;
    double settled, truth;
    int n;
};

static void tally_add(struct tally *tally, const struct course *full, const struct course *other, size_t values)
{
    double error = other->settled / full->settled - 1;
    tally->settlement += error, tally->squares += error * error;
    tally->worst = fmax(tally->worst, fabs(error));
    tally->settled += other->settled / other->height, tally->truth += full->settled / full->height;
    tally->height += fabs(full->settled - other->settled) / (full->height - full->settled);
    tally->positions += relative_error(full->end, other->end, NULL, values);
    tally->displacements += relative_error(full->end, other->end, full->start, values);
    tally->z += fabs(other->z / full->z - 1);
    tally->steps += (double)full->steps / (double)other->steps - 1, tally->cpu += full->cpu / other->cpu - 1;
    tally->n++;
}

static void tally_print(const char *name, const struct tally *t)
{
    double n = 0.01 * t->n; /* means in percent */
    printf("| %s | %+.2f %% | %+.2f %% | %.2f %% | %.2f %% | %.3f %% | %.3f %% | %.1f %% | %.1f %% | ", name,
           100 * (t->settled / t->truth - 1), t->settlement / n, 100 * sqrt(t->squares / t->n), 100 * t->worst,
           t->height / n, t->positions / n, t->displacements / n, t->z / n);
    printf("%.0f %%, %.0f %% |\n", t->steps / n, t->cpu / n);
    fflush(stdout);
}

struct plan {
    const char *name;
    size_t initial, train, ahead;
    enum trend_kind trend;
    int carry;
};

static int follow(const struct simulation *simulation, const struct plan *plan, struct course *course)
{
    struct settle_options options = {.initial = plan->initial,
                                     .train = plan->train,
                                     .ahead = plan->ahead,
                                     .cycles = CYCLES,
                                     .trend = plan->trend,
                                     .carry = plan->carry,
                                     .excess = 3};
    struct settle_result result;
    double begin = seconds();
    if (settle_run(simulation, &options, &result))
        return -1;
    course->cpu = seconds() - begin;
    course->steps = result.steps;
    course->height = result.height;
    course->settled = result.settlement[CYCLES];
    course->z = result.z[CYCLES];
    memcpy(course->end, result.end, 2 * result.grains * sizeof *result.end);
    for (size_t j = 0; j < result.jumps; j++)
        fprintf(stderr, "  %s: jump to cycle %zu: %.5f of the height, promised %.5f, arrived %.5f\n", plan->name,
                result.jump[j].cycle, result.jump[j].before / result.height, result.jump[j].promised / result.height,
                result.jump[j].arrived / result.height);
    settle_result_free(&result);
    return 0;
}

static int loop(int confined, long grains, int packings)
{
    static const struct plan plans[] = {{"log, 10, 20, 45", 10, 20, 45, TREND_LOG, 1},
                                        {"log, 30, 20, 90", 30, 20, 90, TREND_LOG, 1},
                                        {"log, 25, 5, 18", 25, 5, 18, TREND_LOG, 1},
                                        {"logarithmic, 10, 20, 45", 10, 20, 45, TREND_LOGARITHMIC, 1},
                                        {"the same, contacts free (the paper)", 10, 20, 45, TREND_LOGARITHMIC, 0}};
    enum { PLANS = sizeof plans / sizeof *plans };
    struct tally tallies[PLANS + 1] = {0};
    size_t values = 2 * (size_t)grains;
    double *block = malloc(4 * values * sizeof *block);
    if (!block)
        return 1;
    struct course full = {.start = block, .end = block + values}, twin = {.end = block + 2 * values},
                  quick = {.end = block + 3 * values};
    int status = 0;
    for (int seed = 1; seed <= packings && !status; seed++) {
        struct simulation simulation = packing_of(grains, 500, confined, (uint64_t)seed);
        status = every_cycle(&simulation, &full, &twin);
        twin.steps = full.steps, twin.cpu = full.cpu;
        if (!status)
            tally_add(&tallies[PLANS], &full, &twin, values);
        for (int p = 0; p < PLANS && !status; p++) {
            status = follow(&simulation, &plans[p], &quick);
            if (!status)
                tally_add(&tallies[p], &full, &quick, values);
        }
        fprintf(stderr, "packing %d: settled %.5f of the height, %.1f s\n", seed, full.settled / full.height, full.cpu);
    }
    free(block);
    if (status)
        return failed();
    printf(
        "%d packings of %ld discs, %s, settlement %.4f of the height; cycles simulated %d of %d\n\n"
        "| trend, k_i, k, h | settlement: of all packings together | mean of the errors | RMS | worst | of the height "
        "| of the positions | of the displacements | of z | gained: steps, CPU |\n"
        "| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |\n",
        packings, grains, confined ? "confined" : "lateral pressure", tallies[0].truth / packings, SIMULATED, CYCLES);
    for (int p = 0; p < PLANS; p++)
        tally_print(plans[p].name, &tallies[p]);
    tally_print("every cycle, nudged at cycle 50", &tallies[PLANS]);
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
        struct simulation simulation = packing_of(grains, 5000, 1, 1);
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
    int packings = argc > 3 ? atoi(argv[3]) : 1;
    if (argc > 1 && !strcmp(argv[1], "ahead"))
        return ahead(grains);
    if (argc > 1 && (!strcmp(argv[1], "confined") || !strcmp(argv[1], "lateral")))
        return loop(argv[1][0] == 'c', grains, packings);
    if (argc > 1 && !strcmp(argv[1], "part"))
        return part(grains);
    fputs("bench_settlement ahead|part [GRAINS] | confined|lateral [GRAINS [PACKINGS]]\n", stderr);
    return 2;
}
