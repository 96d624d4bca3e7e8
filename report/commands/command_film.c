/* report film: options, read, call. */
#include <math.h>

#include "pipeline/command/cli.h"
#include "pipeline/speak/error.h"
#include "pipeline/draw/canvas.h"
#include "report/commands/report_commands.h"
#include "report/pictures/movie.h"
#include "report/pictures/force_map.h"

struct options {
    struct cli cli;
    struct cli_inputs files;
    struct movie film;
};

enum { KEY_METHOD = 0x2000, KEY_WIDTH };

static const struct argp_option option_list[] = {
    {"method", KEY_METHOD, "M", 0,
     "Which forces (default: one for all frames: series, else map, else the first of qsm, cdm, cem, dem, then others "
     "by name that converged in all states)",
     0},
    {"width", KEY_WIDTH, "PX", 0, "Width of the frames (default 1400)", 0},
    {0}};

static const char documentation[] =
    "Draw the force maps of a series as the frames of a film: one view, one unit of line width. With --scene over its "
    "photos, else over circles.\v"
    "Example:\n"
    "  report film --method qsm out/*.forces.hdf -o frames\n"
    "  ffmpeg -framerate 5 -pattern_type glob -i 'frames/*.png' -pix_fmt yuv420p film.mp4";

static error_t parse_option(int key, char *argument, struct argp_state *state)
{
    struct options *options = state->input;
    switch (key) {
    case ARGP_KEY_INIT:
        state->child_inputs[0] = &options->cli;
        return 0;
    case KEY_METHOD:
        options->film.method = argument;
        return 0;
    case KEY_WIDTH:
        options->film.width = cli_number(state, "--width", argument, 200, 20000);
        return 0;
    case ARGP_KEY_ARG:
        return cli_inputs_add(&options->files, argument) ? ENOMEM : 0;
    case ARGP_KEY_NO_ARGS:
        argp_error(state, "give the state files of the series");
        return 0;
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

static int run(const struct options *options)
{
    struct scene scene = {0};
    struct movie film = options->film;
    int result = 0;
    if (options->cli.scene) {
        result = scene_read(options->cli.scene, &scene);
        if (result == 0 && isnan(scene.scale))
            result = scene_lacks(&scene, "scale_m_per_px", "report film places the photos by it");
        film.scene = &scene;
    }
    if (result == 0)
        result = movie_write(&film, options->files.paths, options->files.count, options->cli.output);
    scene_free(&scene);
    return result;
}

int command_film(int argc, char **argv)
{
    const struct argp_child children[] = {CLI_CHILD, {0}};
    const struct argp parser = {option_list, parse_option, "STATE.hdf...", documentation, children, NULL, NULL};
    struct options options = {.cli = CLI_DEFAULT, .film = {.width = FORCE_MAP_WIDTH}};
    options.cli.needs = CLI_NEEDS_OUTPUT;
    cli_parse(&parser, argc, argv, &options);
    int status = cli_finish(&options.cli, run(&options));
    cli_inputs_free(&options.files);
    canvas_forget_fonts();
    return status;
}
