/* report found: options, read, print. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "pipeline/command/cli.h"
#include "pipeline/speak/error.h"
#include "report/commands/report_commands.h"
#include "report/compare/found.h"
#include "report/export/text_file.h"

struct options {
    struct cli cli;
    const char *file;
};

static const char documentation[] =
    "Print what findgrains found where the scene left it out, as members of a scene to be pasted into its braces: the "
    "frame (corners to 0.01 px) and the range of the radii of all grains without a flag (whole px, outwards). Look at "
    "the picture first (findgrains --picture): false circles without a flag widen the range.\v"
    "Example:\n"
    "  report found 0000.grains.hdf";

static error_t parse_option(int key, char *argument, struct argp_state *state)
{
    struct options *options = state->input;
    switch (key) {
    case ARGP_KEY_INIT:
        state->child_inputs[0] = &options->cli;
        return 0;
    case ARGP_KEY_ARG:
        if (options->file)
            argp_error(state, "one file at a time: '%s' is one too many", argument);
        options->file = argument;
        return 0;
    case ARGP_KEY_NO_ARGS:
        argp_error(state, "which file? Give one of findgrains");
        return 0;
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

static int run(const struct options *options)
{
    struct found found;
    if (found_read(options->file, &found))
        return -1;
    char *text = found_print(&found);
    if (!text)
        return -1;
    int status = 0;
    if (!*text)
        status = error_input("%s: neither a frame nor a grain without a flag: look at the picture of findgrains",
                             options->file);
    else if (options->cli.output)
        status = text_file_write(options->cli.output, text, strlen(text));
    else
        puts(text);
    if (status == 0 && !found.has_frame && !options->cli.quiet)
        fprintf(stderr, "report found: %s: %s\n", options->file,
                found.frame_given ? "the scene gave the frame, none was looked for"
                                  : "no frame was found: read its corners off the picture");
    free(text);
    return status;
}

int command_found(int argc, char **argv)
{
    const struct argp_child children[] = {CLI_CHILD, {0}};
    const struct argp parser = {NULL, parse_option, "N.grains.hdf", documentation, children, NULL, NULL};
    struct options options = {.cli = CLI_DEFAULT};
    options.cli.needs = 0;
    cli_parse(&parser, argc, argv, &options);
    return cli_finish(&options.cli, run(&options));
}
