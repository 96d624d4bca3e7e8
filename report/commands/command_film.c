/* report film: the force maps of a series as frames that can be shown one after the other: the same view, the same unit
 * of line width and the same method in all of them (movie.h). */
#include <math.h>

#include "pipeline/command/cli.h"
#include "pipeline/speak/error.h"
#include "pipeline/draw/canvas.h"
#include "report/commands/report_commands.h"
#include "report/pictures/movie.h"
#include "report/pictures/force_map.h"

struct options {
    struct cli cli;
    struct movie film;
};

#define AT(field) .at = offsetof(struct options, field)
static const struct option_row rows[] = {
    {"method", NULL, OPTION_TEXT, AT(film.method), "M",
     .help = "Which forces (default: one for all frames: series, else map, else the first of qsm, cdm, cem, dem, then "
             "others by name that converged in all states)"},
    {"width", NULL, OPTION_NUMBER, AT(film.width), "PX", .min = 200, .max = 20000, .help = "Width of the frames"},
    {0}};

static const char documentation[] =
    "Draw the force maps of a series as the frames of a film: one view, one unit of line width. With --scene over its "
    "photos, else over circles.\v"
    "Example:\n"
    "  report film --method qsm out/*.forces.hdf -o frames\n"
    "  ffmpeg -framerate 5 -pattern_type glob -i 'frames/*.png' -pix_fmt yuv420p film.mp4";

/* The scene places the photos behind the forces; without it there are circles. */
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
        result = movie_write(&film, options->cli.inputs.paths, options->cli.inputs.count, options->cli.output);
    scene_free(&scene);
    return result;
}

int command_film(int argc, char **argv)
{
    struct options options = {.cli = CLI_NEEDING(CLI_NEEDS_OUTPUT), .film = {.width = FORCE_MAP_WIDTH}};
    const struct program program = {
        "STATE.hdf...", documentation, rows, &options, NULL, 1, CLI_MANY, "give the state files of the series", NULL};
    cli_parse(&program, argc, argv);
    int status = cli_finish(&options.cli, run(&options));
    canvas_forget_fonts();
    return status;
}
