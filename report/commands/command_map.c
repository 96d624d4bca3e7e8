/* report map: one state as a picture. Files of findgrains and tracker show rims and motions over their photo, px; files
 * in m show contact forces as lines between centres, as wide as fn. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "pipeline/command/cli.h"
#include "pipeline/speak/error.h"
#include "pipeline/draw/canvas.h"
#include "report/commands/report_commands.h"
#include "report/states/loaded.h"
#include "report/states/method_choice.h"
#include "report/pictures/force_map.h"
#include "report/pictures/photo_map.h"

struct options {
    struct cli cli;
    const char *method, *photo, *title;
    double width, mean_fn, arrows;
};

#define AT(field) .at = offsetof(struct options, field)
static const struct option_row rows[] = {
    {"method", NULL, OPTION_TEXT, AT(method), "M",
     .help = "Which forces (default: " METHOD_DEFAULT_ORDER "; a file without forces: its contacts)"},
    {"photo", NULL, OPTION_TEXT, AT(photo), "P.tif",
     .help = "Draw over this photo; files in m need --scene, which places it"},
    {"title", NULL, OPTION_TEXT, AT(title), "TEXT", .help = "Title in the legend (default: the file's name)"},
    {"width", NULL, OPTION_NUMBER, AT(width), "PX", .min = 200, .max = 20000, .help = "Width of the picture"},
    {"mean-fn", NULL, OPTION_NUMBER, AT(mean_fn), "N", .min = 1e-12, .max = 1e12,
     .help = "Force that gets the unit of line width; default: <fn> of this state"},
    {"arrows", NULL, OPTION_NUMBER, AT(arrows), "TIMES", .max = 1e9,
     .help = "Tracks: draw motions so many times longer, 0: none; default: chosen"},
    {0}};

static const char documentation[] =
    "Draw the contact forces of one state: lines between centres as wide as fn, blue where the contact sticks, "
    "vermillion where it slips; walls; grains not to be trusted ringed in purple, floating ones in orange, rattlers "
    "in green. Files of findgrains and tracker: the rims, flagged ones in purple, motions since the reference as "
    "arrows. The ending of -o chooses PNG, SVG or PDF.\v"
    "Examples:\n"
    "  report map 0003.forces.hdf --method qsm -o 0003.png\n"
    "  report map 0003.tracks.hdf --photo photos/0003.tif -o tracks.png\n"
    "  report map 0003.forces.hdf --photo photos/0003.tif --scene scene.json -o 0003.svg";

/* NULL: no photo, which stays empty. */
static int read_photo(const char *path, struct photo *photo)
{
    struct photo_request request = {.channel = PHOTO_GREY_OF_RGB};
    return path ? photo_read(path, &request, photo) : 0;
}

/* Files of findgrains and tracker: px of the photo, so nothing has to place it. */
static int run_photo_side(const struct options *options, const struct loaded *loaded, const char *title)
{
    struct photo photo = {0};
    struct photo_map map = {.grains = &loaded->grains,
                            .photo = options->photo ? &photo : NULL,
                            .title = title,
                            .width = options->width,
                            .arrows = options->arrows};
    int result = read_photo(options->photo, &photo) || photo_map_write(&map, options->cli.output) ? -1 : 0;
    photo_free(&photo);
    return result;
}

/* The scene that places the photo. */
static int read_scene(const struct options *options, struct scene *scene)
{
    if (!options->cli.scene) {
        error_set(EXIT_USAGE, "where does the photo lie? Give --scene SCENE.json");
        return -1;
    }
    if (scene_read(options->cli.scene, scene))
        return -1;
    return isnan(scene->scale) ? scene_lacks(scene, "scale_m_per_px", "report map places the photo by it") : 0;
}

/* Files in m: a photo behind them needs the scene's scale and origin. */
static int run_si_side(const struct options *options, const struct loaded *loaded, const char *title)
{
    struct scene scene = {0};
    struct photo photo = {0};
    struct force_map map = {
        .packing = &loaded->packing, .width = options->width, .mean_fn = options->mean_fn, .title = title};
    int result = method_choose(&loaded->packing, loaded->path, options->method, &map.forces);
    if (result == 0 && options->photo) {
        map.photo = &photo;
        map.scene = &scene;
        result = read_scene(options, &scene) || read_photo(options->photo, &photo) ? -1 : 0;
    }
    if (result == 0)
        result = force_map_write(&map, options->cli.output);
    scene_free(&scene);
    photo_free(&photo);
    return result;
}

/* The ending of -o is looked at before the state is read. */
static int run(const struct options *options)
{
    struct loaded loaded;
    enum canvas_format format;
    if (canvas_format_of(options->cli.output, &format) || loaded_read(options->cli.inputs.paths[0], &loaded))
        return -1;
    const char *title = options->title ? options->title : basename(loaded.path);
    int result = loaded.is_si ? run_si_side(options, &loaded, title) : run_photo_side(options, &loaded, title);
    loaded_free(&loaded);
    return result;
}

int command_map(int argc, char **argv)
{
    struct options options = {
        .cli = CLI_NEEDING(CLI_NEEDS_OUTPUT), .width = FORCE_MAP_WIDTH, .mean_fn = NAN, .arrows = NAN};
    const struct program program = {"STATE.hdf", documentation,         rows, &options, NULL, 1,
                                    1,           "give one state file", NULL};
    cli_parse(&program, argc, argv);
    int status = cli_finish(&options.cli, run(&options));
    canvas_forget_fonts();
    return status;
}
