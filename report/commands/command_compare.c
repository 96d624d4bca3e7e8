/* report compare: a state file against another opinion or the truth.
 *
 * Both are photo side (px) or both SI side (m, N). Grains are matched by position, one to one, because files may number
 * them differently. Figures go to stdout as a table, and with --json into a file as one object. */
#include <stdio.h>
#include <string.h>

#include "pipeline/command/cli.h"
#include "pipeline/speak/error.h"
#include "pipeline/speak/text.h"
#include "report/commands/report_commands.h"
#include "report/compare/compare.h"
#include "report/states/loaded.h"
#include "report/states/method_choice.h"

/* What the command line says; texts are borrowed from argv, NULL where they are left out. */
struct options {
    struct cli cli;
    const char *method, *truth_method, *from, *from_a, *json;
};

#define AT(field) .at = offsetof(struct options, field)
static const struct option_row rows[] = {
    {"method", NULL, OPTION_TEXT, AT(method), "M", .help = "Forces of A to judge (default: " METHOD_DEFAULT_ORDER ")"},
    {"truth-method", NULL, OPTION_TEXT, AT(truth_method), "M",
     .help = "Forces of B (default: dem when B has it, else as for A)"},
    {"from", NULL, OPTION_TEXT, AT(from), "B0.hdf", .help = "Truth of the reference photo: compare motions since then"},
    {"from-a", NULL, OPTION_TEXT, AT(from_a), "A0.hdf",
     .help = "Where A's grains started, when A does not say it itself (tracks do)"},
    {"json", NULL, OPTION_OUTPUT, AT(json), "OUT.json", .help = "Write the numbers here too, as one JSON object"},
    {0}};

static const char documentation[] =
    "Compare A with B, the truth or another opinion, and print a table. Both files are photo side (grains, tracks; "
    "truth: photo-truth) or both SI side (contacts, forces; truth: truth). Grains are matched by position, one to "
    "one, so the files may number them differently.\v"
    "Photo side: grains found, missed and false, errors of centres and radii; with --from also of displacements and "
    "rotations. SI side: contact lists (precision, recall, F1), overlaps, Pearson r of fn and ft, dist, <fn>, Weber "
    "stress, unbalanced forces.\n\n"
    "Examples:\n"
    "  report compare 0000.grains.hdf truth/0000.photo-truth.hdf\n"
    "  report compare --from truth/0000.photo-truth.hdf 0003.tracks.hdf truth/0003.photo-truth.hdf\n"
    "  report compare --method qsm 0003.forces.hdf truth/0003.truth.hdf --json qsm.json";

/* Photo side, px. Where A's grains started is in its own columns (tracks), else in --from-a; B's is in --from. */
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

/* NULL: the default order, as for A. */
static const char *truth_method(const struct options *options, const struct packing *b)
{
    if (options->truth_method || !packing_forces(b, "dem"))
        return options->truth_method;
    return "dem";
}

/* The JSON file is written before the table is printed: a failure leaves no table that looks good. */
static int run(const struct options *options)
{
    struct loaded a = {0}, b = {0};
    struct figures figures = {.count = 0};
    int result =
        loaded_read(options->cli.inputs.paths[0], &a) || loaded_read(options->cli.inputs.paths[1], &b) ? -1 : 0;
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
    struct options options = {.cli = CLI_NEEDING(0)};
    const struct program program = {
        "A.hdf B.hdf", documentation, rows, &options, NULL, 2, 2, "give two state files: A, then B", NULL};
    cli_parse(&program, argc, argv);
    return cli_finish(&options.cli, run(&options));
}
