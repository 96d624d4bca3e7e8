/* report verify: options, read, call. */
#include <stdio.h>

#include "pipeline/command/cli.h"
#include "pipeline/speak/error.h"
#include "pipeline/scene/scene.h"
#include "report/commands/report_commands.h"
#include "report/compare/verify.h"

struct options {
    struct cli cli;
    struct cli_inputs files;
    const char *list;
};

enum { KEY_LIST = 0x2000 };

static const struct argp_option option_list[] = {
    {"list", KEY_LIST, "FILE", 0, "Further state files: their paths, one per line", 0}, {0}};

static const char documentation[] =
    "Read state files whole (every column has a checksum) and compare the SHA-256 of everything that each one was made "
    "from with what lies on the disk now: state files beside it, photos, lens and loads of the scene, and the part of "
    "the scene that the stage reads. Prints one line per difference; status 3 when there is one.\v"
    "Example:\n"
    "  report verify --scene scene.json results/*.hdf";

static error_t parse_option(int key, char *argument, struct argp_state *state)
{
    struct options *options = state->input;
    switch (key) {
    case ARGP_KEY_INIT:
        state->child_inputs[0] = &options->cli;
        return 0;
    case ARGP_KEY_ARG:
        return cli_inputs_add(&options->files, argument) ? ENOMEM : 0;
    case KEY_LIST:
        options->list = argument;
        return 0;
    case ARGP_KEY_END:
        if (options->files.count == 0 && !options->list)
            argp_error(state, "give the state files to verify");
        return 0;
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

static int run(struct options *options)
{
    struct scene scene = {0};
    struct verify_count found = {0};
    int result = scene_read(options->cli.scene, &scene) || cli_inputs_read(&options->files, options->list) ? -1 : 0;
    if (result == 0)
        result = verify_files(&scene, options->files.paths, options->files.count, stdout, &found);
    if (result == 0 && found.wrong)
        result = error_input("%zu differences in %zu files of %zu inputs: make the files named above again",
                             found.wrong, found.files, found.inputs);
    else if (result == 0 && !options->cli.quiet)
        printf("%zu files, %zu inputs: all as recorded\n", found.files, found.inputs);
    scene_free(&scene);
    return result;
}

int command_verify(int argc, char **argv)
{
    const struct argp_child children[] = {CLI_CHILD, {0}};
    const struct argp parser = {option_list, parse_option, "STATE.hdf...", documentation, children, NULL, NULL};
    struct options options = {.cli = CLI_DEFAULT};
    options.cli.needs = CLI_NEEDS_SCENE;
    cli_parse(&parser, argc, argv, &options);
    int status = cli_finish(&options.cli, run(&options));
    cli_inputs_free(&options.files);
    return status;
}
