/* report found: frame and radii that findgrains found, as members of a scene: what it had to look for once need not be
 * looked for again in every photo. */
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
};

static const char documentation[] =
    "Print what findgrains found where the scene left it out, as members of a scene to be pasted into its braces: the "
    "frame (corners to 0.01 px) and the range of the radii of all grains without a flag (whole px, outwards). Look at "
    "the picture first (findgrains --picture): false circles without a flag widen the range.\v"
    "Example:\n"
    "  report found 0000.grains.hdf";

/* On stdout, or into -o. A frame that is missing is said on stderr: stdout is pasted into a scene. */
static int run(const struct options *options)
{
    struct found found;
    if (found_read(options->cli.inputs.paths[0], &found))
        return -1;
    char *text = found_print(&found);
    if (!text)
        return -1;
    int status = 0;
    if (!*text)
        status = error_input("%s: neither a frame nor a grain without a flag: look at the picture of findgrains",
                             options->cli.inputs.paths[0]);
    else if (options->cli.output)
        status = text_file_write(options->cli.output, text, strlen(text));
    else
        puts(text);
    if (status == 0 && !found.has_frame && !options->cli.quiet)
        fprintf(stderr, "report found: %s: %s\n", options->cli.inputs.paths[0],
                found.frame_given ? "the scene gave the frame, none was looked for"
                                  : "no frame was found: read its corners off the picture");
    free(text);
    return status;
}

int command_found(int argc, char **argv)
{
    struct options options = {.cli = CLI_NEEDING(0)};
    const struct program program = {
        "N.grains.hdf", documentation, NULL, &options, NULL, 1, 1, "which file? Give one of findgrains", NULL};
    cli_parse(&program, argc, argv);
    return cli_finish(&options.cli, run(&options));
}
