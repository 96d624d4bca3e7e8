/* calibration stiffness: k_n of one contact from two rods in a press (thesis 4.1.1.1).
 *
 * Deflection: how much nearer the tracked centres of the two rods are than in the first photo that shows both, px times
 * the scene's scale, m. Force: the press's record at the photo's time (or index) plus --delay, interpolated, N.
 *
 * Out: film.stiffness/1: kn_N_per_m, its standard error, and every loading, unloading and reloading with its fits. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "calibration/commands/calibration_commands.h"
#include "calibration/rods/press_series.h"
#include "pipeline/command/cli.h"
#include "pipeline/draw/chart.h"
#include "pipeline/speak/error.h"
#include "pipeline/scene/scene.h"
#include "pipeline/files/json.h"

struct options {
    struct cli cli;
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

/* Two rows, "I,J". */
static int parse_rods(const char *text, void *member)
{
    long *rods = member;
    char rest;
    if (sscanf(text, "%ld,%ld%c", &rods[0], &rods[1], &rest) != 2 || rods[0] < 0 || rods[1] < 0 || rods[0] == rods[1])
        return error_input("give two different rows, I,J");
    return 0;
}

#define AT(field) .at = offsetof(struct options, field)
static const struct option_row rows[] = {
    {"record", NULL, OPTION_TEXT, AT(record), "FORCE.csv", .help = "Force record: time_s,force_N or index,force_N"},
    {"rods", NULL, OPTION_TEXT, AT(series.rods), "I,J", .parse = parse_rods,
     .help = "Rows of the two rods (default 0,1)"},
    {"delay", NULL, OPTION_NUMBER, AT(series.delay), "S", .min = -1e9, .max = 1e9,
     .help = "Added to the photos' time (or index) to give the record's"},
    {"force-error", NULL, OPTION_NUMBER, AT(press.force_error), "N", .max = 1e9,
     .help = "Standard error of the force, N"},
    {"picture", NULL, OPTION_OUTPUT, AT(picture), "FILE", .help = "Curve and fits as a picture (.svg, .pdf, .png)"},
    {0}};

static int check(void *input)
{
    return ((const struct options *)input)->record ? 0 : error_input("give the force record with --record");
}

/* A loading, unloading or reloading: a line, two lines that meet at a break, and the power law, each with its rms, m.
 */
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

/* A photo; `used` 0: a rod was lost, or the record does not reach there. */
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

/* Photos that were not used are flagged rows: too many of them are status 4. */
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
    if (!status)
        calibration_tell(&options->cli, "kn_N_per_m", stiffness.kn, stiffness.s_kn);
    stiffness_free(&stiffness);
    force_record_free(&record);
    free(points);
    return status;
}

/* Only the scene's scale is needed: deflections are px times it. */
static int run(struct options *options)
{
    struct scene scene = {0};
    size_t count = options->cli.inputs.count;
    struct press_photo *photos = calloc(count, sizeof *photos);
    int status = photos ? scene_read(options->cli.scene, &scene) : error_memory("photos");
    if (!status && isnan(scene.scale))
        status = scene_lacks(&scene, "scale_m_per_px", "calibration stiffness measures lengths");
    options->series.scale = scene.scale;
    for (size_t k = 0; k < count && !status; k++)
        status = press_photo_read(options->cli.inputs.paths[k], &photos[k]);
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
    struct options options = {.cli = CLI_DEFAULT, .series = {.rods = {0, 1}}, .press = PRESS_DEFAULT};
    const struct program program = {"TRACKS.hdf...",
                                    documentation,
                                    rows,
                                    &options,
                                    NULL,
                                    1,
                                    CLI_MANY,
                                    "which photos? Give the tracks files in order",
                                    check};
    cli_parse(&program, argc, argv);
    return cli_finish(&options.cli, canvas_check_path(options.picture) ? -1 : run(&options));
}
