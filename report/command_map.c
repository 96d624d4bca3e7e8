/* report map: options, read, call, write. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "pipeline/cli.h"
#include "pipeline/error.h"
#include "report/canvas.h"
#include "report/commands.h"
#include "report/map.h"

struct options {
    struct cli cli;
    struct cli_inputs files;
    const char *method, *photo, *title;
    double width, mean_fn;
};

enum { KEY_METHOD = 0x2000, KEY_PHOTO, KEY_TITLE, KEY_WIDTH, KEY_MEAN };

static const struct argp_option option_list[] = {
    {"method", KEY_METHOD, "M", 0, "Which forces (default: the first method in the file; none: contacts only)", 0},
    {"photo", KEY_PHOTO, "P.tif", 0, "Draw over this photo; needs --scene, whose scale and origin place it", 0},
    {"title", KEY_TITLE, "TEXT", 0, "Title in the legend (default: the file's name)", 0},
    {"width", KEY_WIDTH, "PX", 0, "Width of the picture (default 1400)", 0},
    {"mean-fn", KEY_MEAN, "N", 0, "Force that gets the unit of line width (default: <fn> of this state)", 0},
    {0}};

static const char documentation[] =
    "Draw the contact forces of one state: lines between centres as wide as fn, blue where the contact sticks, "
    "vermillion where it slips; walls; grains not to be trusted ringed in purple, floating ones in orange, rattlers in "
    "green. The ending of -o chooses PNG, SVG or PDF.\v"
    "Examples:\n"
    "  report map 0003.forces.hdf --method qsm -o 0003.png\n"
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
        options->cli.needs |= CLI_NEEDS_SCENE;
        return 0;
    case KEY_TITLE:
        options->title = argument;
        return 0;
    case KEY_WIDTH:
        options->width = cli_number(state, "--width", argument, 200, 20000);
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

static int draw(struct map *map, const char *path)
{
    struct canvas canvas;
    if (map_measure(map) || canvas_begin(&canvas, path, map->width, map->height))
        return -1;
    if (map_draw(map, canvas.cairo)) {
        canvas_discard(&canvas);
        return -1;
    }
    return canvas_commit(&canvas);
}

static const char *base_name(const char *path)
{
    const char *slash = strrchr(path, '/');
    return slash ? slash + 1 : path;
}

static int choose_forces(const struct packing *packing, const char *path, const char *method,
                         const struct forces **forces)
{
    *forces = method ? packing_forces(packing, method) : packing->force_count ? &packing->forces[0] : NULL;
    if (method && !*forces)
        return error_input("%s: has no forces of method '%s': choose one that it has", path, method);
    return 0;
}

static int run(const struct options *options)
{
    const char *path = options->files.paths[0];
    struct packing packing = {0};
    struct scene scene = {0};
    struct photo photo = {0};
    struct map map = {.packing = &packing, .width = options->width, .mean_fn = options->mean_fn};
    enum canvas_format format;
    map.title = options->title ? options->title : base_name(path);
    int result = canvas_format_of(options->cli.output, &format) || packing_read(path, &packing) ||
                         choose_forces(&packing, path, options->method, &map.forces)
                     ? -1
                     : 0;
    if (result == 0 && options->photo) {
        struct photo_request request = {.channel = PHOTO_GREY_OF_RGB};
        map.photo = &photo;
        map.scene = &scene;
        result = scene_read(options->cli.scene, &scene) || photo_read(options->photo, &request, &photo) ? -1 : 0;
        if (result == 0 && isnan(scene.scale))
            result = scene_lacks(&scene, "scale_m_per_px", "report map places the photo by it");
    }
    if (result == 0)
        result = draw(&map, options->cli.output);
    packing_free(&packing);
    scene_free(&scene);
    photo_free(&photo);
    return result;
}

int command_map(int argc, char **argv)
{
    const struct argp_child children[] = {CLI_CHILD, {0}};
    const struct argp parser = {option_list, parse_option, "STATE.hdf", documentation, children, NULL, NULL};
    struct options options = {.cli = CLI_DEFAULT, .width = MAP_WIDTH, .mean_fn = NAN};
    options.cli.needs = CLI_NEEDS_OUTPUT;
    cli_parse(&parser, argc, argv, &options);
    int status = cli_finish(&options.cli, run(&options));
    cli_inputs_free(&options.files);
    canvas_forget_fonts();
    return status;
}
