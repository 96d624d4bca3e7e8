/* calibration settlement: what remains after many cycles, from few (Karrech and others 2007).
 *
 * With files: each grain's displacement at the end of the cycles is split into what remains and what comes back, and
 * what remains is carried --ahead cycles on by a trend in the number of cycles (settlement.h).
 * Without: the scene's cyclic test is simulated, with jumps over cycles that are not simulated (settle_loop.h).
 *
 * Out: film.settlement/1, lengths in m: every grain, or every cycle that was simulated. */
#include <math.h>
#include <stdlib.h>

#include "calibration/commands/calibration_commands.h"
#include "calibration/settlement/settle_loop.h"
#include "calibration/settlement/settle_series.h"
#include "pipeline/command/cli.h"
#include "pipeline/draw/chart.h"
#include "pipeline/speak/error.h"
#include "simulation/dem/simulate_scene.h"
#include "pipeline/files/json.h"

struct options {
    struct cli cli;
    struct settle_options loop;
    struct settle_wanted wanted;
    const char *picture;
    int full, free_contacts;
};

static const char documentation[] =
    "Long-term settlement under cycles (Karrech and others 2007): each grain's displacement is split into what "
    "remains and what comes back; what remains is extrapolated.\v"
    "With FILE.hdf: contacts files (or tracks files and --scene) of a cyclic test, in order: residual and reversible "
    "displacement of every grain, its trend, and where it is --ahead cycles later.\n\n"
    "Without: the scene's cyclic test is simulated for --initial cycles, then --train cycles are simulated and "
    "--ahead cycles jumped over, again and again; --full simulates every cycle as well and says the error and the "
    "time gained.\n\n"
    "Examples: calibration settlement --ahead 50 contacts/*.contacts.hdf -o settlement.json\n"
    "  calibration settlement --scene scene.json --cycles 500 --full --picture s.svg -o settlement.json";

#define AT(field) .at = offsetof(struct options, field)
static const struct option_row rows[] = {
    {"ahead", NULL, OPTION_NUMBER, AT(wanted.ahead), "H", .min = 1, .max = 1e9, .help = "Cycles to extrapolate"},
    {"trend", NULL, OPTION_CHOICE, AT(loop.trend), "KIND", .words = TREND_KINDS,
     .help = "How settlement grows; logarithmic: a ln t + b t; log: a ln t"},
    {"picture", NULL, OPTION_OUTPUT, AT(picture), "FILE",
     .help = "Settlement over the cycles as a picture (.svg, .pdf, .png)"},
    {"per-cycle", NULL, OPTION_LONG, AT(wanted.per_cycle), "N", .min = 1, .max = 1e6, .group = 1,
     .help = "Files per cycle"},
    {"first", NULL, OPTION_NUMBER, AT(wanted.first), "T", .min = 1, .max = 1e9, .group = 1,
     .help = "Number of the cycle at whose end the first file stands, from 1"},
    {"error", NULL, OPTION_NUMBER, AT(wanted.error), "M", .min = 1e-300, .max = 1e3, .group = 1,
     .help = "Wanted error of the trend, m: how many cycles that takes (Chernoff's bound)"},
    {"probability", NULL, OPTION_NUMBER, AT(wanted.p), "P", .min = 1e-300, .max = 0.999999, .group = 1,
     .help = "... and the probability to miss it"},
    {"initial", NULL, OPTION_LONG, AT(loop.initial), "K", .min = 1, .max = 1e6, .group = 2,
     .help = "Cycles before the first training"},
    {"train", NULL, OPTION_LONG, AT(loop.train), "K", .min = 2, .max = 1e6, .group = 2,
     .help = "Cycles simulated before each jump"},
    {"cycles", NULL, OPTION_LONG, AT(loop.cycles), "N", .min = 1, .max = 1e7, .group = 2, .help = "Cycles in all"},
    {"full", NULL, OPTION_SWITCH, AT(full), .group = 2, .help = "Simulate every cycle too, and compare"},
    {"free-contacts", NULL, OPTION_SWITCH, AT(free_contacts), .group = 2,
     .help = "Do not carry the contacts' overlaps through a jump"},
    {0}};

/* --trend and --ahead serve both uses, files and simulation. A trend can be read at any time, but a simulation jumps
 * over whole cycles. */
static int check(void *input)
{
    struct options *o = input;
    if (!o->cli.inputs.count && !o->cli.scene)
        return error_input("give the files of a cyclic test, or a scene to simulate with --scene");
    if (!o->cli.inputs.count && o->wanted.ahead != floor(o->wanted.ahead))
        return error_input("--ahead %g: give a whole number of cycles to jump over", o->wanted.ahead);
    o->loop.ahead = (size_t)o->wanted.ahead;
    o->wanted.trend = o->loop.trend;
    o->loop.carry = !o->free_contacts;
    return 0;
}

/* ---- tracked ---- */

/* One grain's displacements (m) and trends; owned by the caller. */
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

/* The estimate from tracked grains as JSON. 0, or -1 with an error. */
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

/* From state files: trends of grains that were seen. */
static int run_tracked(const struct options *o)
{
    struct scene scene = {.scale = NAN};
    struct settle_series series = {0};
    struct settle_estimate estimate = {0};
    int status = o->cli.scene ? scene_read(o->cli.scene, &scene) : 0;
    if (!status)
        status = settle_series_read(o->cli.inputs.paths, o->cli.inputs.count, scene.scale, &series);
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

/* What each jump promised and where it arrived, m; owned by the caller. */
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

/* Cycles that were jumped over have no settlement: only those that were simulated are listed. */
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

/* Settlement and coordination over the cycles, extrapolated against simulated. */
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

/* The extrapolated run, and its errors against the full one where that was asked for. */
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

/* --full: once more without jumps, as the truth that the errors are measured by. */
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
    struct options options = {
        .cli = CLI_NEEDING(CLI_NEEDS_OUTPUT),
        .loop = SETTLE_DEFAULT,
        .wanted = {.trend = TREND_LOG, .per_cycle = 1, .first = 1, .ahead = 40, .error = NAN, .p = 0.05}};
    const struct program program = {"[FILE.hdf...]", documentation, rows, &options, NULL, 0, CLI_MANY, NULL, check};
    cli_parse(&program, argc, argv);
    int status = canvas_check_path(options.picture);
    if (!status)
        status = options.cli.inputs.count ? run_tracked(&options) : run_simulated(&options);
    return cli_finish(&options.cli, status);
}
