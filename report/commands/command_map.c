/* report map: options, read, call, write. */
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
    struct cli_inputs files;
    const char *method, *photo, *title;
    double width, mean_fn, arrows;
};

enum { KEY_METHOD = 0x2000, KEY_PHOTO, KEY_TITLE, KEY_WIDTH, KEY_MEAN, KEY_ARROWS };

static const struct argp_option option_list[] = {
    {"method", KEY_METHOD, "M", 0,
     "Which forces (default: " METHOD_DEFAULT_ORDER "; a file without forces: its contacts)", 0},
    {"photo", KEY_PHOTO, "P.tif", 0, "Draw over this photo; files in m need --scene, which places it", 0},
    {"title", KEY_TITLE, "TEXT", 0, "Title in the legend (default: the file's name)", 0},
    {"width", KEY_WIDTH, "PX", 0, "Width of the picture (default 1400)", 0},
    {"mean-fn", KEY_MEAN, "N", 0, "Force that gets the unit of line width (default: <fn> of this state)", 0},
    {"arrows", KEY_ARROWS, "TIMES", 0, "Tracks: draw motions so many times longer (default: chosen; 0: none)", 0},
    {0}};

static const char documentation[] =
    "Draw the contact forces of one state: lines between centres as wide as fn, blue where the contact sticks, "
    "vermillion where it slips; walls; grains not to be trusted ringed in purple, floating ones in orange, rattlers in "
    "green. Files of findgrains and tracker: the rims, flagged ones in purple, motions since the reference as arrows. "
    "The "
    "ending of -o chooses PNG, SVG or PDF.\v"
    "Examples:\n"
    "  report map 0003.forces.hdf --method qsm -o 0003.png\n"
    "  report map 0003.tracks.hdf --photo photos/0003.tif -o tracks.png\n"
    "  report map 0003.forces.hdf --photo photos/0003.tif --scene scene.json -o 0003.svg";

static error_t parse_option(int key, char *argument, struct argp_state *state)
{
    struct options *options = state->input;
    switch (key) {
    case ARGP_KEY_INIT:
        state->child_inputs[0] = &options->cli;
        return 0;
    case KEY_METHOD:
        options->method = argument;
        return 0;
    case KEY_PHOTO:
        options->photo = argument;
        return 0;
    case KEY_TITLE:
        options->title = argument;
        return 0;
    case KEY_WIDTH:
        options->width = cli_number(state, "--width", argument, 200, 20000);
        return 0;
    case KEY_ARROWS:
        options->arrows = cli_number(state, "--arrows", argument, 0, 1e9);
        return 0;
    case KEY_MEAN:
        options->mean_fn = cli_number(state, "--mean-fn", argument, 1e-12, 1e12);
        return 0;
    case ARGP_KEY_ARG:
        return cli_inputs_add(&options->files, argument) ? ENOMEM : 0;
    case ARGP_KEY_END:
        if (options->files.count != 1)
            argp_error(state, "give one state file");
        return 0;
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

static int read_photo(const char *path, struct photo *photo)
{
    struct photo_request request = {.channel = PHOTO_GREY_OF_RGB};
    return path ? photo_read(path, &request, photo) : 0;
}

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

static int run(const struct options *options)
{
    struct loaded loaded;
    enum canvas_format format;
    if (canvas_format_of(options->cli.output, &format) || loaded_read(options->files.paths[0], &loaded))
        return -1;
    const char *title = options->title ? options->title : basename(loaded.path);
    int result = loaded.is_si ? run_si_side(options, &loaded, title) : run_photo_side(options, &loaded, title);
    loaded_free(&loaded);
    return result;
}

int command_map(int argc, char **argv)
{
    const struct argp_child children[] = {CLI_CHILD, {0}};
    const struct argp parser = {option_list, parse_option, "STATE.hdf", documentation, children, NULL, NULL};
    struct options options = {.cli = CLI_DEFAULT, .width = FORCE_MAP_WIDTH, .mean_fn = NAN, .arrows = NAN};
    options.cli.needs = CLI_NEEDS_OUTPUT;
    cli_parse(&parser, argc, argv, &options);
    int status = cli_finish(&options.cli, run(&options));
    cli_inputs_free(&options.files);
    canvas_forget_fonts();
    return status;
}
