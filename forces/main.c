#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "forces/add_forces.h"
#include "forces/add_series.h"
#include "forces/series/series_options.h"
#include "pipeline/command/cli.h"
#include "pipeline/files/read_record.h"
#include "pipeline/packing/limits.h"
#include "pipeline/speak/error.h"

struct arguments {
    struct cli cli;
    struct cli_inputs inputs;
    const char *previous, *start, *fclib, *range;
    int series;                                  /* --method series: all inputs together */
    struct method_list methods;                  /* count 0: not on the command line */
    double tolerance, iterations, samples, walk; /* NaN: not on the command line */
    int fix;                                     /* -1: not on the command line */
    int stability;
};

enum { METHOD = 256, START, FIX, PREVIOUS, TOLERANCE, ITERATIONS, SAMPLES, WALK, RANGE, STABILITY, FCLIB };

static const struct argp_option option_list[] = {
    {"method", METHOD, "LIST", 0,
     "One or more of cem,cdm,qsm,map, separated by commas (default: the scene's, else map); or series alone, which "
     "takes all states of a test together and writes one file each into the folder -o",
     0},
    {"start", START, "START", 0,
     "zero, mean, overlap, cem, previous, or a file with forces (default: overlap where kn is known, else zero)", 0},
    {"fix", FIX, "PART", 0, "Hold the start's normal or tangential forces: none, normal, tangential", 0},
    {"previous", PREVIOUS, "FILE", 0, "Forces of the previous state: for cem and --start previous", 0},
    {"tolerance", TOLERANCE, "X", 0, "Largest unbalanced force over the mean normal force (1e-6)", 0},
    {"iterations", ITERATIONS, "N", 0, "Stop after N iterations (0: the method's own limit)", 0},
    {"samples", SAMPLES, "N", 0, "map, series: N draws for standard deviations and 90 % intervals (0: none)", 0},
    {"walk", WALK, "N", 0, "cdm, qsm, map: N random jumps from the forces found, for their variability (0: none)", 0},
    {"range", RANGE, "ROWS", 0, "Exact least and largest fn of these contacts: 3,10-14 or all", 0},
    {"stability", STABILITY, NULL, 0,
     "Smallest eigenvalue of the stiffness matrix of the contacts that carry force: below 0 the state is unstable", 0},
    {"fclib", FCLIB, "FILE", 0, "Also write the contact problem for other solvers (Local form of FCLib, HDF5)", 0},
    {0}};

/* A word that is no start is a file to start from. */
static enum force_start start_of(const char *text)
{
    for (int k = START_ZERO; k <= START_PREVIOUS; k++)
        if (!strcmp(text, FORCE_STARTS[k]))
            return (enum force_start)k;
    return START_FILE;
}

/* What only the whole command line tells. */
static void check_together(const struct argp_state *state, const struct arguments *arguments)
{
    if (arguments->inputs.count == 0)
        argp_error(state, "which packing? Give N.contacts.hdf");
    if (arguments->inputs.count > 1 && !arguments->series)
        argp_error(state, "one packing at a time, not also %s; --method series takes many", arguments->inputs.paths[1]);
    if (arguments->series && (arguments->walk > 0 || arguments->range || arguments->stability))
        argp_error(state, "--walk, --range and --stability look at one packing: not with --method series");
    if (arguments->series && (arguments->previous || arguments->start || arguments->fclib || arguments->fix >= 0))
        argp_error(state, "--method series takes all states together, from their overlaps: name every file instead "
                          "of --previous, --start, --fix or --fclib");
    if (arguments->samples > 0 && arguments->walk > 0)
        argp_error(state, "--samples and --walk both fill s_fn and fn_min: give one of them");
}

static error_t parse_option(int key, char *arg, struct argp_state *state)
{
    struct arguments *arguments = state->input;
    switch (key) {
    case ARGP_KEY_INIT:
        state->child_inputs[0] = &arguments->cli;
        return 0;
    case METHOD:
        arguments->series = !strcmp(arg, "series");
        if (!arguments->series && method_list_parse(arg, &arguments->methods))
            argp_error(state, "--method %s: %s", arg, error_message());
        return 0;
    case START:
        if (start_of(arg) == START_FILE && access(arg, F_OK))
            argp_error(state, "--start %s: give zero, mean, overlap, cem, previous, or a file with forces", arg);
        arguments->start = arg;
        return 0;
    case FIX:
        arguments->fix = cli_choice(state, "--fix", arg, FORCE_FIXES);
        return 0;
    case PREVIOUS:
        arguments->previous = arg;
        return 0;
    case TOLERANCE:
        arguments->tolerance = cli_number(state, "--tolerance", arg, 1e-14, 1);
        return 0;
    case ITERATIONS:
        arguments->iterations = cli_number(state, "--iterations", arg, 0, 1e8);
        return 0;
    case SAMPLES:
        arguments->samples = cli_number(state, "--samples", arg, 0, 1e5);
        return 0;
    case WALK:
        arguments->walk = cli_number(state, "--walk", arg, 0, 1e6);
        return 0;
    case RANGE:
        arguments->range = arg;
        return 0;
    case STABILITY:
        arguments->stability = 1;
        return 0;
    case FCLIB:
        arguments->fclib = arg;
        return 0;
    case ARGP_KEY_ARG:
        return cli_inputs_add(&arguments->inputs, arg) ? ENOMEM : 0;
    case ARGP_KEY_END:
        check_together(state, arguments);
        return 0;
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

/* Forces can be in equilibrium and yet not what the photos say. */
static void say_misfit(const struct series_outcome *outcome)
{
    if (outcome->misfit > LIMIT_MISFIT || outcome->worst_misfit > LIMIT_MISFIT)
        fprintf(
            stderr,
            "forces: the photos do not fit together: misfit %.2g of all, %.2g of %s (below 1 where they do): look for "
            "unknown loads (forces.series.softness: their size over <fn>), a wrong mu, files from another reference "
            "photo\n",
            outcome->misfit, outcome->worst_misfit, outcome->worst);
}

/* Stresses follow from the loads, whatever the scale: only the overlaps can tell that it is wrong. */
static void say_overlaps(const struct arguments *arguments, double ratio)
{
    if (ratio > LIMIT_OVERLAPS_OVER_LOADS || ratio < 1 / LIMIT_OVERLAPS_OVER_LOADS)
        fprintf(stderr,
                "forces: %s: overlaps times k_n are %.2g times the loads: scale_m_per_px, kn_N_per_m or the loads are "
                "wrong, "
                "or overlaps are no more than their errors\n",
                arguments->inputs.paths[0], ratio);
}

static int run_series(const struct arguments *arguments)
{
    struct scene scene = {0};
    struct method_list methods = {{METHOD_MAP}, 1};
    struct series_request request = {.scene = &scene,
                                     .inputs = arguments->inputs.paths,
                                     .count = arguments->inputs.count,
                                     .output = arguments->cli.output,
                                     .options = FORCE_OPTIONS_DEFAULT,
                                     .series_options = SERIES_OPTIONS_DEFAULT};
    struct series_outcome outcome = {0};
    int status = scene_read(arguments->cli.scene, &scene) || force_options_read(&scene, &methods, &request.options) ||
                 series_options_read(&scene, &request.series_options);
    if (!status) {
        request.series_options.samples = arguments->samples >= 0 ? (int)arguments->samples : request.options.samples;
        status = add_series(&request, &outcome);
    }
    scene_free(&scene);
    if (!status)
        say_misfit(&outcome);
    return status ? -1
                  : cli_flagged(&arguments->cli, outcome.unbalanced, outcome.grains,
                                "grains are out of balance by more than 1 %");
}

static int run(const struct arguments *arguments)
{
    struct scene scene = {0};
    struct force_request request = {.scene = &scene,
                                    .input = arguments->inputs.paths[0],
                                    .previous = arguments->previous,
                                    .output = arguments->cli.output,
                                    .fclib = arguments->fclib,
                                    .methods = {{METHOD_MAP}, 1},
                                    .options = FORCE_OPTIONS_DEFAULT};
    struct force_outcome outcome = {0};
    int status =
        scene_read(arguments->cli.scene, &scene) || force_options_read(&scene, &request.methods, &request.options);
    if (!status) {
        if (arguments->methods.count > 0)
            request.methods = arguments->methods;
        if (arguments->start)
            request.options.start = start_of(arguments->start);
        if (request.options.start == START_FILE)
            request.from = arguments->start;
        if (arguments->fix >= 0)
            request.options.fix = (enum force_fix)arguments->fix;
        if (arguments->tolerance > 0)
            request.options.tolerance = arguments->tolerance;
        if (arguments->iterations >= 0)
            request.options.iterations = (int)arguments->iterations;
        if (arguments->samples >= 0)
            request.options.samples = (int)arguments->samples;
        if (arguments->walk >= 0)
            request.options.walk = (int)arguments->walk;
        request.options.range = arguments->range;
        request.options.stability |= arguments->stability;
        status = add_forces(&request, &outcome);
    }
    scene_free(&scene);
    if (status)
        return -1;
    say_overlaps(arguments, outcome.overlaps_over_loads);
    return cli_flagged(&arguments->cli, outcome.unbalanced, outcome.grains,
                       "grains are out of balance by more than 1 %");
}

int main(int argc, char **argv)
{
    static const struct argp_child children[] = {CLI_CHILD, {0}};
    static const struct argp parser = {
        option_list,
        parse_option,
        "N.contacts.hdf [more for --method series]",
        "Contact forces of a packing in equilibrium, from its overlaps, motions and loads.\v"
        "cem: measured motions times stiffness, no equilibrium. cdm: contact dynamics, rigid grains (forces.block 10 "
        "in the scene accelerates it, forces.colours uses all threads). qsm: projections "
        "onto equilibrium and friction. map: the most likely admissible forces; the one to use. series: map for all "
        "photos of a test together, which share the errors of their reference: better still where the network changes. "
        "Several methods but series stand side by side in one file. Docs: docs/forces.md, docs/series_forces.md.\n\n"
        "Example:\n  forces --scene scene.json --method qsm,map 0003.contacts.hdf -o 0003.forces.hdf\n"
        "  forces --scene scene.json --method series out/*.contacts.hdf -o out",
        children,
        NULL,
        NULL};
    struct arguments arguments = {
        .cli = CLI_DEFAULT, .tolerance = NAN, .iterations = NAN, .samples = NAN, .walk = NAN, .fix = -1};
    read_record_begin();
    cli_parse(&parser, argc, argv, &arguments);
    int status = arguments.series ? run_series(&arguments) : run(&arguments);
    cli_inputs_free(&arguments.inputs);
    return cli_finish(&arguments.cli, status);
}
