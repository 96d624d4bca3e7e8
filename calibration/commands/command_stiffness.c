/* calibration stiffness: options, read, call, write. */
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "calibration/commands/calibration_commands.h"
#include "calibration/rods/press_series.h"
#include "pipeline/command/cli.h"
#include "pipeline/draw/chart.h"
#include "pipeline/speak/error.h"
#include "pipeline/scene/scene.h"

enum { KEY_RECORD = 0x2100, KEY_RODS, KEY_DELAY, KEY_FORCE_ERROR, KEY_PICTURE };

struct options {
    struct cli cli;
    struct cli_inputs tracks;
    const char *record, *picture;
    struct press_series_options series;
    struct press_options press;
};

static const char documentation[] =
    "The normal stiffness of a contact from a compression test on two rods (thesis 4.1.1.1): photos while a press "
    "loads, unloads and reloads them, and the record of its force.\v"
    "TRACKS.hdf: what tracker found in each photo, in order; the scene gives scale_m_per_px (and photos.interval_s "
    "where the record goes by time). The record is CSV: time_s,force_N or index,force_N.\n\n"
    "Example: calibration stiffness --scene scene.json --record force.csv --picture stiffness.svg tracks/*.tracks.hdf "
    "-o stiffness.json\n\n"
    "The result holds kn_N_per_m (for the scene's contact), its standard error, and for each loading, unloading and "
    "reloading the line, the two lines with their break, the power law, and every point.";

static const struct argp_option option_list[] = {
    {"record", KEY_RECORD, "FORCE.csv", 0, "Force record: time_s,force_N or index,force_N", 0},
    {"rods", KEY_RODS, "I,J", 0, "Rows of the two rods (default 0,1)", 0},
    {"delay", KEY_DELAY, "S", 0, "Added to the photos' time (or index) to give the record's (default 0)", 0},
    {"force-error", KEY_FORCE_ERROR, "N", 0, "Standard error of the force, N (default 0)", 0},
    {"picture", KEY_PICTURE, "FILE", 0, "Curve and fits as a picture (.svg, .pdf, .png)", 0},
    {0}};

static void parse_rods(struct argp_state *state, const char *text, long rods[2])
{
    char rest;
    if (sscanf(text, "%ld,%ld%c", &rods[0], &rods[1], &rest) != 2 || rods[0] < 0 || rods[1] < 0 || rods[0] == rods[1])
        argp_error(state, "--rods '%s': give two different rows, I,J", text);
}

static error_t parse_option(int key, char *argument, struct argp_state *state)
{
    struct options *options = state->input;
    switch (key) {
    case ARGP_KEY_INIT:
        state->child_inputs[0] = &options->cli;
        return 0;
    case KEY_RECORD:
        options->record = argument;
        return 0;
    case KEY_PICTURE:
        options->picture = argument;
        return 0;
    case KEY_RODS:
        parse_rods(state, argument, options->series.rods);
        return 0;
    case KEY_DELAY:
        options->series.delay = cli_number(state, "delay", argument, -1e9, 1e9);
        return 0;
    case KEY_FORCE_ERROR:
        options->press.force_error = cli_number(state, "force-error", argument, 0, 1e9);
        return 0;
    case ARGP_KEY_ARG:
        return cli_inputs_add(&options->tracks, argument) ? ENOMEM : 0;
    case ARGP_KEY_NO_ARGS:
        argp_error(state, "which photos? Give the tracks files in order");
        return 0;
    case ARGP_KEY_END:
        if (!options->record)
            argp_error(state, "give the force record with --record");
        return 0;
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

static cJSON *describe_phase(const struct press_point *points, const struct press_fit *fit)
{
    cJSON *object = cJSON_CreateObject();
    cJSON_AddStringToObject(object, "kind", PRESS_KINDS[fit->kind]);
    calibration_add(object, "first_index", (double)points[fit->begin].index);
    calibration_add(object, "last_index", (double)points[fit->end - 1].index);
    calibration_add(object, "points", (double)fit->points);
    cJSON_AddItemToObject(object, "force_N", cJSON_CreateDoubleArray(fit->force, 2));
    calibration_add(object, "k_line_N_per_m", fit->k_line);
    calibration_add(object, "s_k_line_N_per_m", fit->s_line);
    calibration_add(object, "rms_line_m", fit->rms_line);
    calibration_add(object, "break_N", fit->break_force);
    calibration_add(object, "s_break_N", fit->s_break);
    calibration_add(object, "k_low_N_per_m", fit->k_low);
    calibration_add(object, "s_k_low_N_per_m", fit->s_low);
    calibration_add(object, "k_high_N_per_m", fit->k_high);
    calibration_add(object, "s_k_high_N_per_m", fit->s_high);
    calibration_add(object, "rms_bilinear_m", fit->rms_bilinear);
    calibration_add(object, "power_exponent", fit->power_n);
    calibration_add(object, "s_power_exponent", fit->s_n);
    calibration_add(object, "power_factor", fit->power_c);
    calibration_add(object, "rms_power_m", fit->rms_power);
    return object;
}

static cJSON *describe_point(const struct press_point *point)
{
    cJSON *object = cJSON_CreateObject();
    calibration_add(object, "index", (double)point->index);
    calibration_add(object, "time_s", point->time);
    calibration_add(object, "force_N", point->force);
    calibration_add(object, "deflection_m", point->deflection);
    calibration_add(object, "s_deflection_m", point->s);
    cJSON_AddBoolToObject(object, "used", point->used);
    return object;
}

static cJSON *describe(const struct press_point *points, size_t count, const struct stiffness *stiffness)
{
    cJSON *object = cJSON_CreateObject(), *phases = cJSON_CreateArray(), *rows = cJSON_CreateArray();
    cJSON_AddStringToObject(object, "schema", "film.stiffness/1");
    calibration_add(object, "kn_N_per_m", stiffness->kn);
    calibration_add(object, "s_kn_N_per_m", stiffness->s_kn);
    calibration_add(object, "half_spread_N_per_m", stiffness->spread);
    calibration_add(object, "unloading_N_per_m", stiffness->unloading);
    calibration_add(object, "s_unloading_N_per_m", stiffness->s_unloading);
    for (size_t p = 0; p < stiffness->phase_count; p++)
        cJSON_AddItemToArray(phases, describe_phase(points, &stiffness->phase[p]));
    for (size_t k = 0; k < count; k++)
        cJSON_AddItemToArray(rows, describe_point(&points[k]));
    cJSON_AddItemToObject(object, "phases", phases);
    cJSON_AddItemToObject(object, "points", rows);
    return object;
}

/* The points of each phase, deflections in um. */
static int draw(const char *path, const struct press_point *points, const struct stiffness *stiffness)
{
    struct chart chart = {.title = "Two rods pressed together", .x_label = "deflection, um", .y_label = "force, N"};
    int status = 0;
    for (size_t p = 0; p < stiffness->phase_count && p < CHART_LINES && !status; p++) {
        const struct press_fit *fit = &stiffness->phase[p];
        struct chart_line *line = chart_add(&chart, PRESS_KINDS[fit->kind], fit->end - fit->begin);
        status = line ? 0 : -1;
        for (size_t k = fit->begin; line && k < fit->end; k++)
            chart_put(line, points[k].used ? 1e6 * points[k].deflection : NAN, points[k].force);
        if (line)
            line->scattered = line->unjoined = 1;
    }
    if (!status)
        status = chart_write(path, &chart, 1, CALIBRATION_CHART_WIDTH, CALIBRATION_CHART_HEIGHT);
    chart_free(&chart);
    return status;
}

static int fit_and_write(const struct options *options, const struct press_photo *photos, size_t count)
{
    struct press_point *points = calloc(count, sizeof *points);
    struct force_record record = {0};
    struct stiffness stiffness = {0};
    size_t unused = 0;
    int status = points ? 0 : error_memory("points");
    if (!status)
        status = force_record_read(options->record, &record);
    if (!status)
        status = press_series_points(photos, count, &record, &options->series, points);
    if (!status)
        status = stiffness_fit(points, count, &options->press, &stiffness);
    if (!status)
        status = calibration_write(options->cli.output, describe(points, count, &stiffness));
    if (!status && options->picture)
        status = draw(options->picture, points, &stiffness);
    for (size_t k = 0; points && k < count; k++)
        unused += !points[k].used;
    if (!status)
        status = cli_flagged(&options->cli, unused, count, "photos were not used");
    stiffness_free(&stiffness);
    force_record_free(&record);
    free(points);
    return status;
}

static int run(struct options *options)
{
    struct scene scene = {0};
    size_t count = options->tracks.count;
    struct press_photo *photos = calloc(count, sizeof *photos);
    int status = photos ? scene_read(options->cli.scene, &scene) : error_memory("photos");
    if (!status && isnan(scene.scale))
        status = scene_lacks(&scene, "scale_m_per_px", "calibration stiffness measures lengths");
    options->series.scale = scene.scale;
    for (size_t k = 0; k < count && !status; k++)
        status = press_photo_read(options->tracks.paths[k], &photos[k]);
    if (!status)
        status = fit_and_write(options, photos, count);
    for (size_t k = 0; photos && k < count; k++)
        press_photo_free(&photos[k]);
    free(photos);
    scene_free(&scene);
    return status;
}

int command_stiffness(int argc, char **argv)
{
    const struct argp_child children[] = {CLI_CHILD, {0}};
    const struct argp parser = {option_list, parse_option, "TRACKS.hdf...", documentation, children, NULL, NULL};
    struct options options = {.cli = CLI_DEFAULT, .series = {.rods = {0, 1}}, .press = PRESS_DEFAULT};
    cli_parse(&parser, argc, argv, &options);
    int status = cli_finish(&options.cli, canvas_check_path(options.picture) ? -1 : run(&options));
    cli_inputs_free(&options.tracks);
    return status;
}
