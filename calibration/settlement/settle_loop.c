/* The loop: simulate, learn, jump, come to rest. Times are cycles; a jump moves the phase of the loading by whole
 * cycles. After a jump contacts would be lost or crushed: they are carried along first (their overlaps kept), then what
 * still overlaps too much is parted, then everything relaxes under the stress. Relaxing gives a part of the settlement
 * back; the jump is repeated by an affine stretch until the height is as promised. */
#include "calibration/settlement/settle_loop.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "pipeline/command/cli.h"
#include "pipeline/speak/error.h"
#include "pipeline/speak/progress.h"
#include "simulation/dem/loading.h"
#include "simulation/dem/placement.h"

struct run {
    const struct settle_options *options;
    struct simulation simulation;
    struct loading loading;
    struct settle_result *result;
    double *now; /* positions, then width and height */
    size_t values;
    size_t cycle;
    struct progress progress; /* of all cycles, jumped over or not */
};

void settle_result_free(struct settle_result *result)
{
    free(result->settlement);
    free(result->z);
    free(result->jump);
    free(result->start);
    free(result->end);
    memset(result, 0, sizeof *result);
}

static void look(struct run *run)
{
    const struct dem *dem = &run->loading.dem;
    for (size_t k = 0; k < dem->count; k++)
        run->now[2 * k] = dem->grains[k].x, run->now[2 * k + 1] = dem->grains[k].y;
    run->now[2 * dem->count] = dem->box.size[BOX_WIDTH];
    run->now[2 * dem->count + 1] = dem->box.size[BOX_HEIGHT];
}

static double coordination(const struct dem *dem)
{
    size_t contacts = 0;
    for (size_t p = 0; p < dem->first[dem->count]; p++)
        contacts += (size_t)dem->pairs[p].touching;
    return 2 * (double)contacts / (double)dem->count;
}

static void note(struct run *run)
{
    run->result->settlement[run->cycle] = run->result->height - run->loading.dem.box.size[BOX_HEIGHT];
    run->result->z[run->cycle] = coordination(&run->loading.dem);
}

static double largest_overlap(const struct dem *dem)
{
    double most = 0;
    for (size_t p = 0; p < dem->pair_count; p++)
        if (dem->pairs[p].touching)
            most = fmax(most, dem->pairs[p].overlap);
    return most;
}

/* Simulate so many cycles; their ends go to `ends` (NULL: no one needs them). */
static int simulate_cycles(struct run *run, size_t count, struct cycle_ends *ends)
{
    if (ends) {
        look(run);
        if (!ends->cycles && cycle_ends_add(ends, (double)run->cycle, run->now, run->values))
            return -1;
    }
    for (size_t c = 0; c < count && run->cycle < run->options->cycles; c++) {
        int rested = loading_step(&run->loading, 1);
        if (rested < 0)
            return -1;
        run->result->unrested += !rested;
        run->result->simulated++;
        run->cycle++;
        progress_step(&run->progress);
        note(run);
        look(run);
        if (ends && cycle_ends_add(ends, (double)run->cycle, run->now, run->values))
            return -1;
    }
    return 0;
}

/* Grains that fewer than two contacts hold go nowhere in particular: their way has no trend. */
static int is_held(const struct dem *dem, size_t grain)
{
    int contacts = 0;
    for (size_t p = 0; p < dem->pair_count; p++) {
        const struct dem_pair *pair = &dem->pairs[p];
        contacts += pair->touching && ((size_t)pair->i == grain || (size_t)pair->j == grain);
    }
    return contacts >= 2;
}

/* No value goes faster than it went on average while the trend was learned: what slows down keeps its trend, a single
 * slip is not made a habit. */
static void keep_pace(const struct cycle_ends *ends, double h, double *ahead)
{
    size_t k = ends->cycles - 1;
    const double *first = ends->at, *last = ends->at + k * ends->values;
    for (size_t v = 0; v < ends->values; v++) {
        double most = fabs(last[v] - first[v]) * h / (double)k, way = ahead[v] - last[v];
        ahead[v] = last[v] + fmax(-most, fmin(most, way));
    }
}

/* Grains and box to where their trends lead. */
static int place_ahead(struct run *run, const struct cycle_ends *ends, size_t h, struct trend *trends)
{
    struct dem *dem = &run->loading.dem;
    double *ahead = run->now;
    if (cycle_ends_ahead(ends, run->options->trend, (double)h, ahead, trends))
        return -1;
    if (run->options->trend != TREND_LOG)
        keep_pace(ends, (double)h, ahead);
    for (size_t k = 0; k < dem->count; k++)
        if (!dem->grains[k].fixed && is_held(dem, k))
            dem->grains[k].x = ahead[2 * k], dem->grains[k].y = ahead[2 * k + 1];
    if (run->loading.servo.hold[BOX_WIDTH] == HOLD_STRESS)
        dem->box.size[BOX_WIDTH] = ahead[2 * dem->count];
    dem->box.size[BOX_HEIGHT] = ahead[2 * dem->count + 1];
    run->result->last = trends[run->values - 1];
    return 0;
}

static int part(struct run *run, double before)
{
    struct unpress unpressed;
    struct dem *dem = &run->loading.dem;
    if (dem_forces_static(dem, 0))
        return -1;
    if (!(largest_overlap(dem) > run->options->excess * before))
        return 0;
    if (unpress(dem, NULL, 0, &unpressed))
        return -1;
    run->result->parted++;
    run->result->steps += unpressed.iterations;
    if (unpressed.overlap[0] > run->result->worst.overlap[0])
        run->result->worst = unpressed;
    return 0;
}

static int relax(struct run *run)
{
    int rested = loading_relax(&run->loading);
    run->result->unrested += rested == 0;
    return rested < 0 ? -1 : 0;
}

static int jump_note(struct run *run, double before, double promised)
{
    struct settle_result *result = run->result;
    struct settle_jump *all = realloc(result->jump, (result->jumps + 1) * sizeof *all);
    if (!all)
        return error_memory("jumps");
    double arrived = result->settlement[run->cycle];
    all[result->jumps++] = (struct settle_jump){run->cycle, before, promised, arrived};
    result->jump = all;
    log_event("jump", "cycle", (double)run->cycle, "before_m", before, "promised_m", promised, "arrived_m", arrived,
              NULL);
    return 0;
}

/* The box to these sizes, the grains with it. */
static void stretch(struct dem *dem, const double *size)
{
    double x = size[BOX_WIDTH] / dem->box.size[BOX_WIDTH], y = size[BOX_HEIGHT] / dem->box.size[BOX_HEIGHT];
    for (size_t k = 0; k < dem->count; k++)
        if (!dem->grains[k].fixed)
            dem->grains[k].x *= x, dem->grains[k].y *= y;
    memcpy(dem->box.size, size, 2 * sizeof *size);
}

static int come_to_rest(struct run *run, double before)
{
    struct unpress carried;
    if (run->options->carry && carry_contacts(&run->loading.dem, &carried))
        return -1;
    return part(run, before) || relax(run) ? -1 : 0;
}

/* What relaxes gives back a part of the way: take it again, until the height is as promised to a hundredth of it. */
static int arrive(struct run *run, double before, const double *promised, double way)
{
    enum { TRIES = 4 };
    struct dem *dem = &run->loading.dem;
    int status = come_to_rest(run, before);
    for (int try = 0; try < TRIES && !status && run->options->carry; try++) {
        if (fabs(promised[BOX_HEIGHT] - dem->box.size[BOX_HEIGHT]) <= 0.01 * fabs(way))
            break;
        stretch(dem, promised);
        status = come_to_rest(run, before);
    }
    return status;
}

static int jump(struct run *run, const struct cycle_ends *ends)
{
    const double *size = run->loading.dem.box.size;
    size_t left = run->options->cycles - run->cycle, h = run->options->ahead < left ? run->options->ahead : left;
    struct trend *trends = calloc(run->values, sizeof *trends);
    double before = largest_overlap(&run->loading.dem), settled = run->result->settlement[run->cycle];
    int status = trends ? place_ahead(run, ends, h, trends) : error_memory("trends");
    double promised[] = {size[BOX_WIDTH], size[BOX_HEIGHT]}, settles = run->result->height - promised[BOX_HEIGHT];
    free(trends);
    if (status || arrive(run, before, promised, settles - settled))
        return -1;
    run->cycle += h;
    run->loading.turns += (double)h;
    for (size_t c = 0; c < h; c++)
        progress_step(&run->progress);
    note(run);
    return jump_note(run, settled, settles);
}

static int run_all(struct run *run)
{
    const struct settle_options *options = run->options;
    note(run);
    if (simulate_cycles(run, options->ahead ? options->initial : options->cycles, NULL))
        return -1;
    struct cycle_ends ends = {0};
    int status = 0;
    while (run->cycle < options->cycles && !status) {
        if (options->trend != TREND_LOG) /* a ln t learns from all cycles since the first training */
            cycle_ends_free(&ends);
        status = simulate_cycles(run, options->train, &ends);
        if (!status && run->cycle < options->cycles)
            status = jump(run, &ends);
    }
    cycle_ends_free(&ends);
    return status;
}

static int result_alloc(struct run *run)
{
    struct settle_result *result = run->result;
    result->cycles = run->options->cycles;
    result->grains = run->loading.dem.count;
    run->values = 2 * result->grains + 2;
    result->settlement = malloc((result->cycles + 1) * sizeof *result->settlement);
    result->z = malloc((result->cycles + 1) * sizeof *result->z);
    result->start = malloc(run->values * sizeof *result->start);
    result->end = malloc(run->values * sizeof *result->end);
    run->now = malloc(run->values * sizeof *run->now);
    if (!result->settlement || !result->z || !result->start || !result->end || !run->now)
        return error_memory("settlement");
    for (size_t c = 0; c <= result->cycles; c++)
        result->settlement[c] = result->z[c] = NAN;
    result->height = run->loading.dem.box.size[BOX_HEIGHT];
    return 0;
}

static int check(const struct simulation *simulation, const struct settle_options *options)
{
    if (simulation->test != TEST_CYCLIC)
        return error_input("settlement needs simulation.test \"cyclic\"");
    if (options->cycles < 1 || (options->ahead && options->train < 2))
        return error_input("%zu cycles in all, %zu to learn from: give 1 and 2 or more", options->cycles,
                           options->train);
    if (options->ahead && options->initial < 1)
        return error_input("trends count cycles from 1: give one initial cycle or more");
    if (options->ahead && options->initial + options->train >= options->cycles)
        return error_input("%zu + %zu cycles are simulated before the first jump, and there are %zu in all: nothing is "
                           "left to extrapolate",
                           options->initial, options->train, options->cycles);
    return 0;
}

int settle_run(const struct simulation *simulation, const struct settle_options *options, struct settle_result *result)
{
    struct run run = {.options = options, .simulation = *simulation, .result = result};
    run.loading.simulation = &run.simulation;
    memset(result, 0, sizeof *result);
    if (check(simulation, options))
        return -1;
    int status = placement(simulation, &run.loading.dem) || loading_begin(&run.loading) < 0 ? -1 : 0;
    if (!status)
        status = result_alloc(&run);
    long begun = run.loading.steps;
    if (!status) {
        look(&run);
        memcpy(result->start, run.now, run.values * sizeof *run.now);
        progress_begin(&run.progress, options->ahead ? "cycles, some jumped over" : "cycles", options->cycles);
        status = run_all(&run);
        progress_end(&run.progress);
    }
    if (!status) {
        look(&run);
        memcpy(result->end, run.now, run.values * sizeof *run.now);
        result->steps += run.loading.steps - begun;
    }
    free(run.now);
    dem_free(&run.loading.dem);
    if (status)
        settle_result_free(result);
    return status;
}
