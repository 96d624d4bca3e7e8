/* report histogram: the grey levels of a photo, whether voids and grains can be told apart by a threshold.
 *
 * Shares stand in decades upwards: saturated pixels at either end are few, and would not be seen on a linear scale. */
#include <math.h>
#include <string.h>

#include "pipeline/command/cli.h"
#include "pipeline/speak/error.h"
#include "pipeline/files/json.h"
#include "pipeline/state/state.h"
#include "pipeline/draw/canvas.h"
#include "pipeline/draw/chart.h"
#include "report/commands/report_commands.h"
#include "report/pictures/histogram.h"

/* grains: a file of findgrains, NULL where it is left out. */
struct options {
    struct cli cli;
    const char *grains;
};

#define AT(field) .at = offsetof(struct options, field)
static const struct option_row rows[] = {{"grains", NULL, OPTION_TEXT, AT(grains), "N.grains.hdf",
                                          .help = "Mark the threshold between voids and grains that findgrains took"},
                                         {0}};

static const char documentation[] =
    "Draw the grey levels of a photo, inside the frame of --scene when it has one: share of the pixels in 256 bins, "
    "upwards in decades. Two hills, voids and grains, far apart, and nothing at both ends make a good photo.\v"
    "Example:\n"
    "  report histogram --scene scene.json --grains 0000.grains.hdf photos/0000.tif -o levels.png";

/* The threshold in the attribute `found` of a file of findgrains; NaN without a file. */
static int read_threshold(const char *path, double *threshold)
{
    char text[4096];
    *threshold = NAN;
    if (!path)
        return 0;
    struct state *state = state_open(path);
    int status = state ? state_read_text(state, "grains", "found", text, sizeof text) : -1;
    state_close(state);
    if (status == 1)
        return error_input("%s: does not say what findgrains found: give a file of findgrains", path);
    struct json *json = status ? NULL : json_parse(text, strlen(text), path);
    if (json && json_number(json, json_root(json), "threshold", -1e9, 1e9, threshold) != 1)
        status = error_input("%s: does not say the threshold: give a file of findgrains", path);
    else if (!json)
        status = -1;
    json_free(json);
    return status;
}

/* Bins in the middle of their levels; the threshold a vertical line from the least to the largest share. */
static int draw(const struct histogram *histogram, double threshold, const char *path)
{
    struct chart chart = {
        .title = "Grey levels", .x_label = "grey level", .y_label = "share of the pixels", .log_y = 1};
    struct chart_line *levels = chart_add(&chart, "pixels", HISTOGRAM_BINS),
                      *mark = levels && isfinite(threshold) ? chart_add(&chart, "threshold", 2) : NULL;
    double least = 1, most = 0;
    struct canvas canvas;
    int result = levels && (mark || isnan(threshold)) ? 0 : -1;
    for (int b = 0; b < HISTOGRAM_BINS && result == 0; b++) {
        double density = histogram->density[b];
        chart_put(levels, histogram->most * (b + 0.5) / HISTOGRAM_BINS, density);
        least = density > 0 ? fmin(least, density) : least;
        most = fmax(most, density);
    }
    if (mark) {
        chart_put(mark, threshold, least);
        chart_put(mark, threshold, most);
    }
    if (result == 0)
        result = canvas_begin(&canvas, path, 640, 400);
    if (result == 0) {
        chart_draw(&chart, &canvas, 640, 400);
        result = canvas_commit(&canvas);
    }
    chart_free(&chart);
    return result;
}

/* With a scene: its channel and size, and only the pixels inside its frame. */
static int run(const struct options *options)
{
    struct scene scene = {0};
    struct photo photo = {0};
    struct photo_request request = {.channel = PHOTO_GREY_OF_RGB};
    struct histogram histogram;
    double threshold;
    int result = read_threshold(options->grains, &threshold);
    if (result == 0 && options->cli.scene && (result = scene_read(options->cli.scene, &scene)) == 0)
        request = scene_photo_request(&scene);
    if (result == 0)
        result = photo_read(options->cli.inputs.paths[0], &request, &photo);
    if (result == 0) {
        histogram_make(&photo, options->cli.scene ? &scene : NULL, &histogram);
        result = draw(&histogram, threshold, options->cli.output);
    }
    photo_free(&photo);
    scene_free(&scene);
    return result;
}

int command_histogram(int argc, char **argv)
{
    struct options options = {.cli = CLI_NEEDING(CLI_NEEDS_OUTPUT)};
    const struct program program = {
        "PHOTO.tif", documentation, rows, &options, NULL, 1, 1, "which photo? Give one photo at a time, a TIFF file",
        NULL};
    cli_parse(&program, argc, argv);
    int status = cli_finish(&options.cli, run(&options));
    canvas_forget_fonts();
    return status;
}
