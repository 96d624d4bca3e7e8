/* forces: contact forces of one packing by several methods, or of all states of a test together. */
#include <stdio.h>

#include "forces/add_forces.h"
#include "forces/add_series.h"
#include "forces/options.h"
#include "pipeline/files/read_record.h"
#include "pipeline/packing/limits.h"

#define UNBALANCED "grains are out of balance by more than 1 %"

/* Forces can be in equilibrium and yet not what the photos say. */
static void say_misfit(const struct series_outcome *outcome)
{
    if (outcome->misfit > LIMIT_MISFIT || outcome->worst_misfit > LIMIT_MISFIT)
        fprintf(stderr,
                "forces: the photos do not fit together: misfit %.2g of all, %.2g of %s (below 1 where they do): look "
                "for unknown loads (forces.series.softness: their size over <fn>), a wrong mu, files from another "
                "reference photo\n",
                outcome->misfit, outcome->worst_misfit, outcome->worst);
}

/* Stresses follow from the loads, whatever the scale: only the overlaps can tell that it is wrong. */
static void say_overlaps(const char *input, double ratio)
{
    if (ratio > LIMIT_OVERLAPS_OVER_LOADS || ratio < 1 / LIMIT_OVERLAPS_OVER_LOADS)
        fprintf(stderr,
                "forces: %s: overlaps times k_n are %.2g times the loads: scale_m_per_px, kn_N_per_m or the loads are "
                "wrong, or overlaps are no more than their errors\n",
                input, ratio);
}

static int run_series(const struct force_arguments *arguments, const struct scene *scene)
{
    const struct cli *cli = &arguments->cli;
    const struct series_request request = {scene,       cli->inputs.paths,  cli->inputs.count,
                                           cli->output, arguments->options, arguments->series};
    struct series_outcome outcome = {0};
    if (add_series(&request, &outcome))
        return -1;
    say_misfit(&outcome);
    return cli_flagged(cli, outcome.unbalanced, outcome.grains, UNBALANCED);
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
    say_overlaps(request.input, outcome.overlaps_over_loads);
    return cli_flagged(&arguments->cli, outcome.unbalanced, outcome.grains, UNBALANCED);
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
