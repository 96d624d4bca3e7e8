/* report compare: options, read, call, print. */
#include <stdio.h>
#include <string.h>

#include "pipeline/command/cli.h"
#include "pipeline/speak/error.h"
#include "pipeline/speak/text.h"
#include "report/commands/report_commands.h"
#include "report/compare/compare.h"
#include "report/states/loaded.h"
#include "report/states/method_choice.h"

struct options {
    struct cli cli;
    struct cli_inputs files;
    const char *method, *truth_method, *from, *from_a, *json;
};

enum { KEY_METHOD = 0x2000, KEY_TRUTH_METHOD, KEY_FROM, KEY_FROM_A, KEY_JSON };

static const struct argp_option option_list[] = {
    {"method", KEY_METHOD, "M", 0, "Forces of A to judge (default: " METHOD_DEFAULT_ORDER ")", 0},
    {"truth-method", KEY_TRUTH_METHOD, "M", 0, "Forces of B (default: dem when B has it, else as for A)", 0},
    {"from", KEY_FROM, "B0.hdf", 0, "Truth of the reference photo: compare motions since then", 0},
    {"from-a", KEY_FROM_A, "A0.hdf", 0, "Where A's grains started, when A does not say it itself (tracks do)", 0},
    {"json", KEY_JSON, "OUT.json", 0, "Write the numbers here too, as one JSON object", 0},
    {0}};

static const char documentation[] =
    "Compare A with B, the truth or another opinion, and print a table. Both files are photo side (grains, tracks; "
    "truth: photo-truth) or both SI side (contacts, forces; truth: truth). Grains are matched by position, one to one, "
    "so the files may number them differently.\v"
    "Photo side: grains found, missed and false, errors of centres and radii; with --from also of displacements and "
    "rotations. SI side: contact lists (precision, recall, F1), overlaps, Pearson r of fn and ft, dist, <fn>, Weber "
    "stress, unbalanced forces.\n\n"
    "Examples:\n"
    "  report compare 0000.grains.hdf truth/0000.photo-truth.hdf\n"
    "  report compare --from truth/0000.photo-truth.hdf 0003.tracks.hdf truth/0003.photo-truth.hdf\n"
    "  report compare --method qsm 0003.forces.hdf truth/0003.truth.hdf --json qsm.json";

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
    case KEY_TRUTH_METHOD:
        options->truth_method = argument;
        return 0;
    case KEY_FROM:
        options->from = argument;
        return 0;
    case KEY_FROM_A:
        options->from_a = argument;
        return 0;
    case KEY_JSON:
        options->json = argument;
        return 0;
    case ARGP_KEY_ARG:
        return cli_inputs_add(&options->files, argument) ? ENOMEM : 0;
    case ARGP_KEY_END:
        if (options->files.count != 2)
            argp_error(state, "give two state files: A, then B");
        return 0;
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

static int compare_photos(const struct options *options, const struct loaded *a, const struct loaded *b,
                          struct figures *figures)
{
    struct loaded a0 = {0}, b0 = {0};
    struct compare_photo pair = {.a = &a->grains, .b = &b->grains, .a_is_seen = !strcmp(a->info.coordinates, "seen")};
    int result = 0;
    if (options->from_a && (result = loaded_read(options->from_a, &a0)) == 0)
        pair.a0 = &a0.grains;
    if (options->from && result == 0 && (result = loaded_read(options->from, &b0)) == 0)
        pair.b0 = &b0.grains;
    if (result == 0)
        result = compare_photo(&pair, figures);
    loaded_free(&a0);
    loaded_free(&b0);
    return result;
}

static const char *truth_method(const struct options *options, const struct packing *b)
{
    if (options->truth_method || !packing_forces(b, "dem"))
        return options->truth_method;
    return "dem";
}

static int run(const struct options *options)
{
    struct loaded a = {0}, b = {0};
    struct figures figures = {.count = 0};
    int result = loaded_read(options->files.paths[0], &a) || loaded_read(options->files.paths[1], &b) ? -1 : 0;
    if (result == 0 && a.is_si != b.is_si)
        result = error_input("%s and %s: one is in px, the other in m: compare files of the same side", a.path, b.path);
    else if (result == 0 && a.is_si)
        result = compare_packings(&a.packing, &b.packing, options->method, truth_method(options, &b.packing), &figures);
    else if (result == 0)
        result = compare_photos(options, &a, &b, &figures);
    if (result == 0) {
        if (options->json)
            result = figures_write_json(&figures, options->json);
    }
    if (result == 0) {
        for (int k = 0; k < 2; k++) {
            fputs(k ? "\nB: " : "A: ", stdout);
            text_print(stdout, k ? b.path : a.path);
        }
        putchar('\n');
        result = figures_print(&figures, stdout);
    }
    loaded_free(&a);
    loaded_free(&b);
    return result;
}

int command_compare(int argc, char **argv)
{
    const struct argp_child children[] = {CLI_CHILD, {0}};
    const struct argp parser = {option_list, parse_option, "A.hdf B.hdf", documentation, children, NULL, NULL};
    struct options options = {.cli = CLI_DEFAULT};
    options.cli.needs = 0;
    cli_parse(&parser, argc, argv, &options);
    int status = cli_finish(&options.cli, run(&options));
    cli_inputs_free(&options.files);
    return status;
}
