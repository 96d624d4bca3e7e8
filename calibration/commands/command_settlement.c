/* calibration settlement: options, read, call, write. */
#include <errno.h>
#include <math.h>
#include <stdlib.h>

#include "calibration/commands/calibration_commands.h"
#include "calibration/settlement/settle_loop.h"
#include "calibration/settlement/settle_series.h"
#include "pipeline/command/cli.h"
#include "pipeline/draw/chart.h"
#include "pipeline/speak/error.h"
#include "simulation/dem/simulate_scene.h"

enum {
    KEY_INITIAL = 0x2500,
    KEY_TRAIN,
    KEY_AHEAD,
    KEY_CYCLES,
    KEY_TREND,
    KEY_FULL,
    KEY_PAPER,
    KEY_PER_CYCLE,
    KEY_FIRST,
    KEY_ERROR,
    KEY_PROBABILITY,
    KEY_PICTURE
};

struct options {
    struct cli cli;
    struct cli_inputs files;
    struct settle_options loop;
    struct settle_wanted wanted;
    const char *picture;
    int full;
};

static const char documentation[] =
    "Long-term settlement under cycles (Karrech and others 2007): each grain's displacement is split into what remains "
    "and what comes back; what remains is extrapolated.\v"
    "With FILE.hdf: contacts files (or tracks files and --scene) of a cyclic test, in order: residual and reversible "
    "displacement of every grain, its trend, and where it is --ahead cycles later.\n\n"
    "Without: the scene's cyclic test is simulated for --initial cycles, then --train cycles are simulated and --ahead "
    "cycles jumped over, again and again; --full simulates every cycle as well and says the error and the time "
    "gained.\n\n"
    "Examples: calibration settlement --ahead 50 contacts/*.contacts.hdf -o settlement.json\n"
    "  calibration settlement --scene scene.json --cycles 500 --full --picture s.svg -o settlement.json";

static const struct argp_option option_list[] = {
    {"ahead", KEY_AHEAD, "H", 0, "Cycles to extrapolate (default 40)", 0},
    {"trend", KEY_TREND, "KIND", 0, "linear, logarithmic: a ln t + b t, or log: a ln t (default)", 0},
    {"picture", KEY_PICTURE, "FILE", 0, "Settlement over the cycles as a picture (.svg, .pdf, .png)", 0},
    {"per-cycle", KEY_PER_CYCLE, "N", 0, "Files per cycle (default 1)", 1},
    {"first", KEY_FIRST, "T", 0, "Number of the cycle at whose end the first file stands, from 1 (default 1)", 1},
    {"error", KEY_ERROR, "M", 0, "Wanted error of the trend, m: how many cycles that takes (Chernoff's bound)", 1},
    {"probability", KEY_PROBABILITY, "P", 0, "... and the probability to miss it (default 0.05)", 1},
    {"initial", KEY_INITIAL, "K", 0, "Cycles before the first training (default 10)", 2},
    {"train", KEY_TRAIN, "K", 0, "Cycles simulated before each jump (default 20)", 2},
    {"cycles", KEY_CYCLES, "N", 0, "Cycles in all (default 250)", 2},
    {"full", KEY_FULL, NULL, 0, "Simulate every cycle too, and compare", 2},
    {"free-contacts", KEY_PAPER, NULL, 0, "Do not carry the contacts' overlaps through a jump", 2},
    {0}};

static error_t parse_number(int key, char *argument, struct argp_state *state)
{
    struct options *o = state->input;
    switch (key) {
    case KEY_INITIAL:
        o->loop.initial = (size_t)cli_number(state, "--initial", argument, 1, 1e6);
        return 0;
    case KEY_TRAIN:
        o->loop.train = (size_t)cli_number(state, "--train", argument, 2, 1e6);
        return 0;
    case KEY_AHEAD:
        o->wanted.ahead = cli_number(state, "--ahead", argument, 1, 1e9);
        o->loop.ahead = (size_t)o->wanted.ahead;
        return 0;
    case KEY_CYCLES:
        o->loop.cycles = (size_t)cli_number(state, "--cycles", argument, 1, 1e7);
        return 0;
    case KEY_PER_CYCLE:
        o->wanted.per_cycle = (size_t)cli_number(state, "--per-cycle", argument, 1, 1e6);
        return 0;
    case KEY_FIRST:
        o->wanted.first = cli_number(state, "--first", argument, 1, 1e9);
        return 0;
    case KEY_ERROR:
        o->wanted.error = cli_number(state, "--error", argument, 1e-300, 1e3);
        return 0;
    case KEY_PROBABILITY:
        o->wanted.p = cli_number(state, "--probability", argument, 1e-300, 0.999999);
        return 0;
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

static error_t parse_option(int key, char *argument, struct argp_state *state)
{
    struct options *o = state->input;
    switch (key) {
    case ARGP_KEY_INIT:
        state->child_inputs[0] = &o->cli;
        return 0;
    case KEY_TREND:
        o->loop.trend = o->wanted.trend = (enum trend_kind)cli_choice(state, "--trend", argument, TREND_KINDS);
        return 0;
    case KEY_FULL:
        o->full = 1;
        return 0;
    case KEY_PAPER:
        o->loop.carry = 0;
        return 0;
    case KEY_PICTURE:
        o->picture = argument;
        return 0;
    case ARGP_KEY_ARG:
        return cli_inputs_add(&o->files, argument) ? ENOMEM : 0;
    case ARGP_KEY_END:
        if (!o->files.count && !o->cli.scene)
            argp_error(state, "give the files of a cyclic test, or a scene to simulate with --scene");
        return 0;
    default:
        return parse_number(key, argument, state);
    }
}

/* ---- tracked ---- */

static cJSON *describe_grain(size_t row, const struct grain_settlement *grain)
{
    cJSON *object = cJSON_CreateObject();
    calibration_add(object, "grain", (double)row);
    cJSON_AddBoolToObject(object, "used", grain->used);
    calibration_add(object, "residual_x_m", grain->residual[0]);
    calibration_add(object, "residual_y_m", grain->residual[1]);
    calibration_add(object, "ahead_x_m", grain->ahead[0]);
    calibration_add(object, "ahead_y_m", grain->ahead[1]);
    calibration_add(object, "a_x_m", grain->trend[0].a);
    calibration_add(object, "b_x_m", grain->trend[0].b);
    calibration_add(object, "a_y_m", grain->trend[1].a);
    calibration_add(object, "b_y_m", grain->trend[1].b);
    calibration_add(object, "rms_m", hypot(grain->trend[0].rms, grain->trend[1].rms));
    calibration_add(object, "reversible_m", grain->reversible);
    return object;
}

static int write_estimate(const struct options *o, const struct settle_estimate *estimate)
{
    cJSON *object = cJSON_CreateObject(), *rows = cJSON_CreateArray();
    cJSON_AddStringToObject(object, "schema", "film.settlement/1");
    cJSON_AddStringToObject(object, "trend", TREND_KINDS[o->wanted.trend]);
    calibration_add(object, "cycles", (double)estimate->cycles);
    calibration_add(object, "ahead", o->wanted.ahead);
    calibration_add(object, "held_out_error", estimate->held_out);
    calibration_add(object, "chernoff_cycles_median", estimate->chernoff[0]);
    calibration_add(object, "chernoff_cycles_largest", estimate->chernoff[1]);
    for (size_t k = 0; k < estimate->grains; k++)
        cJSON_AddItemToArray(rows, describe_grain(k, &estimate->grain[k]));
    cJSON_AddItemToObject(object, "grains", rows);
    if (calibration_write(o->cli.output, object))
        return -1;
    return cli_flagged(&o->cli, estimate->unused, estimate->grains, "grains were lost at the end of a cycle");
}

static int run_tracked(const struct options *o)
{
    struct scene scene = {.scale = NAN};
    struct settle_series series = {0};
    struct settle_estimate estimate = {0};
    int status = o->cli.scene ? scene_read(o->cli.scene, &scene) : 0;
    if (!status)
        status = settle_series_read(o->files.paths, o->files.count, scene.scale, &series);
    if (!status)
        status = settle_estimate(&series, &o->wanted, &estimate);
    if (!status)
        status = write_estimate(o, &estimate);
    settle_estimate_free(&estimate);
    settle_series_free(&series);
    if (o->cli.scene)
        scene_free(&scene);
    return status;
}

/* ---- simulated ---- */

static cJSON *describe_jumps(const struct settle_result *result)
{
    cJSON *rows = cJSON_CreateArray();
    for (size_t j = 0; j < result->jumps; j++) {
        const struct settle_jump *jump = &result->jump[j];
        cJSON *row = cJSON_CreateObject();
        calibration_add(row, "to_cycle", (double)jump->cycle);
        calibration_add(row, "before_m", jump->before);
        calibration_add(row, "promised_m", jump->promised);
        calibration_add(row, "arrived_m", jump->arrived);
        cJSON_AddItemToArray(rows, row);
    }
    return rows;
}

static cJSON *describe_run(const struct settle_result *result)
{
    cJSON *object = cJSON_CreateObject(), *cycles = cJSON_CreateArray(), *settlement = cJSON_CreateArray();
    cJSON *z = cJSON_CreateArray();
    calibration_add(object, "simulated_cycles", (double)result->simulated);
    cJSON_AddItemToObject(object, "jumps", describe_jumps(result));
    calibration_add(object, "partings", (double)result->parted);
    calibration_add(object, "steps", (double)result->steps);
    calibration_add(object, "height_m", result->height);
    calibration_add(object, "largest_overlap_before_parting_m", result->worst.overlap[0]);
    calibration_add(object, "largest_overlap_after_parting_m", result->worst.overlap[1]);
    for (size_t c = 0; c <= result->cycles; c++)
        if (isfinite(result->settlement[c])) {
            cJSON_AddItemToArray(cycles, cJSON_CreateNumber((double)c));
            cJSON_AddItemToArray(settlement, cJSON_CreateNumber(result->settlement[c]));
            cJSON_AddItemToArray(z, cJSON_CreateNumber(result->z[c]));
        }
    cJSON_AddItemToObject(object, "cycle", cycles);
    cJSON_AddItemToObject(object, "settlement_m", settlement);
    cJSON_AddItemToObject(object, "z", z);
    return object;
}

/* What was extrapolated as dots over a line of what every cycle gave, which is left out when there is none (NULL). */
static int add_cycles(struct chart *chart, const double *full, const double *quick, size_t count)
{
    struct chart_line *line = full ? chart_add(chart, "every cycle simulated", count) : NULL;
    struct chart_line *dots = !full || line ? chart_add(chart, "extrapolated", count) : NULL;
    if (!dots)
        return -1;
    dots->style = 0, dots->scattered = dots->unjoined = 1;
    if (line)
        line->style = 1, line->unmarked = 1;
    for (size_t c = 0; c < count; c++) {
        chart_put(dots, (double)c, quick[c]);
        if (line)
            chart_put(line, (double)c, full[c]);
    }
    return 0;
}

static int draw(const char *path, const struct settle_result *quick, const struct settle_result *full)
{
    size_t n = quick->cycles + 1;
    struct chart charts[] = {{.title = "Settlement", .x_label = "cycles", .y_label = "m", .whole_x = 1},
                             {.title = "Coordination", .x_label = "cycles", .y_label = "2 Nc / Np", .whole_x = 1}};
    int status =
        add_cycles(&charts[0], full->settlement, quick->settlement, n) || add_cycles(&charts[1], full->z, quick->z, n)
            ? -1
            : chart_write(path, charts, 2, CALIBRATION_CHART_WIDTH, CALIBRATION_CHART_HEIGHT);
    chart_free(&charts[0]);
    chart_free(&charts[1]);
    return status;
}

static int write_runs(const struct options *o, const struct settle_result *quick, const struct settle_result *full)
{
    cJSON *object = cJSON_CreateObject();
    cJSON_AddStringToObject(object, "schema", "film.settlement/1");
    cJSON_AddStringToObject(object, "trend", TREND_KINDS[o->loop.trend]);
    cJSON_AddItemToObject(object, "extrapolated", describe_run(quick));
    if (o->full) {
        double truth = full->settlement[full->cycles];
        cJSON_AddItemToObject(object, "full", describe_run(full));
        calibration_add(object, "settlement_error", quick->settlement[quick->cycles] / truth - 1);
        calibration_add(object, "position_error", relative_error(full->end, quick->end, NULL, 2 * full->grains));
        calibration_add(object, "displacement_error",
                        relative_error(full->end, quick->end, full->start, 2 * full->grains));
        calibration_add(object, "gained", (double)full->steps / (double)quick->steps - 1);
    }
    int status = calibration_write(o->cli.output, object);
    if (!status && o->picture)
        status = draw(o->picture, quick, full);
    return status
               ? status
               : cli_flagged(&o->cli, quick->unrested, quick->simulated + quick->jumps, "states did not come to rest");
}

static int run_simulated(const struct options *o)
{
    struct scene scene = {0};
    struct simulation_plan plan = {0};
    struct settle_result quick = {0}, full = {0};
    struct settle_options all = o->loop;
    all.ahead = 0;
    int status = scene_read(o->cli.scene, &scene);
    if (!status)
        status = simulation_read(&scene, &plan);
    if (!status)
        status = settle_run(&plan.simulation, &o->loop, &quick);
    if (!status && o->full)
        status = settle_run(&plan.simulation, &all, &full);
    if (!status)
        status = write_runs(o, &quick, &full);
    settle_result_free(&quick);
    settle_result_free(&full);
    simulation_plan_free(&plan);
    scene_free(&scene);
    return status;
}

int command_settlement(int argc, char **argv)
{
    const struct argp_child children[] = {CLI_CHILD, {0}};
    const struct argp parser = {option_list, parse_option, "[FILE.hdf...]", documentation, children, NULL, NULL};
    struct options options = {
        .cli = {.max_flagged = CLI_MAX_FLAGGED, .needs = CLI_NEEDS_OUTPUT},
        .loop = SETTLE_DEFAULT,
        .wanted = {.trend = TREND_LOG, .per_cycle = 1, .first = 1, .ahead = 40, .error = NAN, .p = 0.05}};
    cli_parse(&parser, argc, argv, &options);
    int status = canvas_check_path(options.picture);
    if (!status)
        status = options.files.count ? run_tracked(&options) : run_simulated(&options);
    status = cli_finish(&options.cli, status);
    cli_inputs_free(&options.files);
    return status;
}
