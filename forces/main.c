/* forces: contact forces of one packing by several methods, or of all states of a test together. */
#include "forces/add_forces.h"
#include "forces/add_series.h"
#include "forces/notes.h"
#include "forces/options.h"
#include "pipeline/files/read_record.h"

static int run_series(const struct force_arguments *arguments, const struct scene *scene)
{
    const struct cli *cli = &arguments->cli;
    const struct series_request request = {scene,       cli->inputs.paths,  cli->inputs.count,
                                           cli->output, arguments->options, arguments->series};
    struct series_outcome outcome = {0};
    if (add_series(&request, &outcome))
        return -1;
    return note_series(cli, &outcome);
}

static int run_one(const struct force_arguments *arguments, const struct scene *scene)
{
    const struct force_request request = {.scene = scene,
                                          .input = arguments->cli.inputs.paths[0],
                                          .previous = arguments->previous,
                                          .from = arguments->start.file,
                                          .output = arguments->cli.output,
                                          .fclib = arguments->fclib,
                                          .methods = arguments->methods,
                                          .options = arguments->options};
    struct force_outcome outcome = {0};
    if (add_forces(&request, &outcome))
        return -1;
    return note_forces(&arguments->cli, &request, &outcome);
}

/* The method may stand in the scene: only after reading it is known which of the two is run. */
static int run(struct force_arguments *arguments)
{
    struct scene scene = {0};
    int status = scene_read(arguments->cli.scene, &scene) || force_arguments_read(&scene, arguments) ? -1 : 0;
    if (!status)
        status = arguments->methods.series ? run_series(arguments, &scene) : run_one(arguments, &scene);
    scene_free(&scene);
    return status;
}

int main(int argc, char **argv)
{
    struct force_arguments arguments = FORCE_ARGUMENTS_DEFAULT;
    read_record_begin();
    force_arguments_parse(argc, argv, &arguments);
    return cli_finish(&arguments.cli, run(&arguments));
}
