/* report verify: are results whole, and made of what lies on the disk now? Each file holds the SHA-256 of
 * everything that it was made from; the digests are compared in verify.h. */
#include <stdio.h>

#include "pipeline/command/cli.h"
#include "pipeline/speak/error.h"
#include "pipeline/scene/scene.h"
#include "pipeline/speak/version.h"
#include "report/commands/report_commands.h"
#include "report/compare/verify.h"

struct options {
    struct cli cli;
    const char *list;
};

#define AT(field) .at = offsetof(struct options, field)
static const struct option_row rows[] = {
    {"list", NULL, OPTION_TEXT, AT(list), "FILE", .help = "Further files: their paths, one per line"}, {0}};

static const char documentation[] =
    "Read state files whole (every column has a checksum) and compare the SHA-256 of everything that each one was "
    "made from with what lies on the disk now: state files beside it, photos, lens and loads of the scene, and the "
    "part of the scene that the stage reads. Pictures, tables and pages of a series (.png, .csv, .html) are compared "
    "with what their stage noted of them. Prints one line per difference; status 3 when there is one.\v"
    "Example:\n"
    "  report verify --scene scene.json results/*.hdf results/*.png results/report.html";

static int check(void *input)
{
    const struct options *options = input;
    return options->cli.inputs.count || options->list ? 0 : error_input("give the files to verify");
}

/* Differences are data, on stdout; that there are some is an error, for drivers. */
static int run(struct options *options)
{
    struct scene scene = {0};
    struct verify_count found = {0};
    int result =
        scene_read(options->cli.scene, &scene) || cli_inputs_read(&options->cli.inputs, options->list) ? -1 : 0;
    if (result == 0)
        result = verify_files(&scene, options->cli.inputs.paths, options->cli.inputs.count, stdout, &found);
    if (result == 0 && found.of_others && !options->cli.quiet)
        printf("%zu of %zu files were written by other programs than these (%s): numbers may differ from theirs\n",
               found.of_others, found.files, film_version);
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
    struct options options = {.cli = CLI_NEEDING(CLI_NEEDS_SCENE)};
    const struct program program = {"FILE...", documentation, rows, &options, NULL, 0, CLI_MANY, NULL, check};
    cli_parse(&program, argc, argv);
    return cli_finish(&options.cli, run(&options));
}
