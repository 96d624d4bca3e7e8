/* Adding an option of forces: a member of struct force_options (or series_options), and a row below. What changes
 * numbers also goes into force_options_text(), from which the file says how it was made. */
#include "forces/options.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "pipeline/speak/error.h"
#include "pipeline/files/json.h"

int method_list_parse(const char *text, struct method_list *list)
{
    list->count = 0;
    if ((list->series = !strcmp(text, "series")))
        return 0;
    for (const char *c = text;; c++) {
        size_t length = strcspn(c, ",");
        int method = method_find(c, length);
        char *names = method < 0 ? method_names() : NULL;
        if (names)
            error_set(EXIT_INPUT, "method '%.*s': give one or more of %s, or series alone", (int)length, c, names);
        free(names);
        if (method < 0)
            return -1;
        for (int k = 0; k < list->count; k++)
            if (list->method[k] == (enum force_method)method)
                return error_input("method %.*s stands there twice", (int)length, c);
        list->method[list->count++] = (enum force_method)method;
        c += length;
        if (!*c)
            return 0;
    }
}

/* A word that is no start is a file to start from. */
static int parse_start(const char *text, void *member)
{
    struct start_choice *start = member;
    for (int k = START_DEFAULT; k < START_FILE; k++)
        if (!strcmp(text, FORCE_STARTS[k])) {
            *start = (struct start_choice){(enum force_start)k, NULL};
            return 0;
        }
    if (access(text, F_OK))
        return error_input("give zero, mean, overlap, cem, previous, or a file with forces");
    *start = (struct start_choice){START_FILE, text};
    return 0;
}

_Static_assert(sizeof(struct method_list) <= OPTION_ROOM, "a row's member is copied when it is only judged");
static int parse_methods(const char *text, void *member)
{
    return method_list_parse(text, member);
}

static const char help[] =
    "Contact forces of a packing in equilibrium, from its overlaps, motions and loads.\v"
    "cem: measured motions times stiffness, no equilibrium. cdm: contact dynamics, rigid grains (forces.block 10 "
    "in the scene accelerates it, forces.colours uses all threads). qsm: projections "
    "onto equilibrium and friction. map: the most likely admissible forces; the one to use. series: map for all "
    "photos of a test together, which share the errors of their reference: better still where the network changes. "
    "Several methods but series stand side by side in one file. Docs: docs/forces.md, docs/series_forces.md.\n\n"
    "Example:\n  forces --scene scene.json --method qsm,map 0003.contacts.hdf -o 0003.forces.hdf\n"
    "  forces --scene scene.json --method series out/*.contacts.hdf -o out";

#define AT(field) .at = offsetof(struct force_arguments, field)
/* The options of a series stand in a group of their own in the scene: what they name, such as the rim shape, no other
 * method knows. */
static const struct option_row rows[] = {
    {"method", "method", OPTION_TEXT, AT(methods), "LIST", .parse = parse_methods,
     .help = "One or more of cem,cdm,qsm,map, separated by commas (default map); or series alone, which takes all "
             "states of a test together and writes one file each into the folder -o"},
    {"start", "start", OPTION_TEXT, AT(start), "START", .parse = parse_start,
     .help = "zero, mean, overlap, cem, previous, or (command line only) a file with forces; default: overlap where kn "
             "is known, else zero"},
    {"fix", "fix", OPTION_CHOICE, AT(options.fix), "PART", .words = FORCE_FIXES,
     .help = "Hold the start's normal or tangential forces"},
    {"previous", NULL, OPTION_TEXT, AT(previous), "FILE",
     .help = "Forces of the previous state: for cem and --start previous"},
    {"tolerance", "tolerance", OPTION_NUMBER, AT(options.tolerance), "X", .min = 1e-14, .max = 1,
     .help = "Largest unbalanced force over the mean normal force"},
    {"iterations", "iterations", OPTION_WHOLE, AT(options.iterations), "N", .max = 1e8,
     .help = "Stop after N iterations, 0: the method's own limit"},
    {"samples", "samples", OPTION_WHOLE, AT(options.samples), "N", .min = 2, .max = 1e5, .zero = 1,
     .help = "map, series: N draws for standard deviations and 90 % intervals, 0: none"},
    {"walk", "walk", OPTION_WHOLE, AT(options.walk), "N", .max = 1e6,
     .help = "cdm, qsm, map: N random jumps from the forces found, for their variability, 0: none"},
    {"range", NULL, OPTION_TEXT, AT(options.range), "ROWS",
     .help = "Exact least and largest fn of these contacts: 3,10-14 or all"},
    {"stability", "stability", OPTION_SWITCH, AT(options.stability),
     .help = "Smallest eigenvalue of the stiffness matrix of the contacts that carry force: below 0 the state is "
             "unstable"},
    {"fclib", NULL, OPTION_OUTPUT, AT(fclib), "FILE",
     .help = "Also write the contact problem for other solvers (Local form of FCLib, HDF5)"},
    {NULL, "rescale", OPTION_SWITCH, AT(options.rescale)},
    {NULL, "relaxation", OPTION_NUMBER, AT(options.relaxation), .min = 0.1, .max = 1.9},
    {NULL, "thickness", OPTION_NUMBER, AT(options.thickness), .max = 1},
    {NULL, "wall_mass", OPTION_NUMBER, AT(options.wall_mass), .min = 1e-6, .max = 1e12},
    {NULL, "block", OPTION_WHOLE, AT(options.block), .max = 100000},
    {NULL, "colours", OPTION_SWITCH, AT(options.colours)},
    {NULL, "candidates", OPTION_SWITCH, AT(options.candidates)},
    {NULL, "orthogonal", OPTION_SWITCH, AT(options.orthogonal)},
    {NULL, "anderson", OPTION_WHOLE, AT(options.anderson), .max = 30},
    {NULL, "series.softness", OPTION_NUMBER, AT(series.softness), .min = 1e-5, .max = 1},
    {NULL, "series.shape_px", OPTION_NUMBER, AT(shape_px), .max = 100},
    {NULL, "series.offset", OPTION_SWITCH, AT(series.fit_offset)},
    {NULL, "series.stiffness", OPTION_SWITCH, AT(series.fit_stiffness)},
    {NULL, "series.tangential", OPTION_SWITCH, AT(series.tangential)},
    {0}};

/* What one packing takes and a series does not: a wrong command line, wherever the method was named. */
static int check_series(const struct force_arguments *arguments)
{
    const struct cli *cli = &arguments->cli;
    const char *wrong = NULL;
    if (!arguments->methods.series && cli->inputs.count > 1)
        wrong = "one packing at a time; --method series takes many";
    else if (arguments->methods.series &&
             (cli_given(cli, "walk") || cli_given(cli, "range") || cli_given(cli, "stability")))
        wrong = "--walk, --range and --stability look at one packing: not with --method series";
    else if (arguments->methods.series && (cli_given(cli, "previous") || cli_given(cli, "start") ||
                                           cli_given(cli, "fclib") || cli_given(cli, "fix")))
        wrong = "--method series takes all states together, from their overlaps: name every file instead of "
                "--previous, --start, --fix or --fclib";
    return wrong ? (error_set(EXIT_USAGE, "%s", wrong), -1) : 0;
}

/* Of the whole command line, and again with what the scene added. */
static int check_errors(const struct force_arguments *arguments)
{
    if (arguments->options.samples > 0 && arguments->options.walk > 0 && !arguments->methods.series)
        return error_input("samples and walk both fill s_fn and fn_min: give one of them, or 0 for the other");
    return 0;
}

static int check(void *options)
{
    const struct force_arguments *arguments = options;
    if (cli_given(&arguments->cli, "method") && check_series(arguments))
        return -1;
    return check_errors(arguments);
}

void force_arguments_parse(int argc, char **argv, struct force_arguments *arguments)
{
    static struct program program = {
        "N.contacts.hdf [more for --method series]", help, rows, NULL, "forces", 1, CLI_MANY,
        "which packing? Give N.contacts.hdf",        check};
    program.options = arguments;
    cli_parse(&program, argc, argv);
}

int force_arguments_read(const struct scene *scene, struct force_arguments *arguments)
{
    struct force_options *options = &arguments->options;
    if (!scene->contact_given || !isfinite(scene->contact.mu))
        return scene_lacks(scene, "contact.mu", "forces needs the friction coefficient");
    options->law = scene->contact;
    if (options_read(rows, scene, "forces", arguments->cli.given, arguments) || check_series(arguments))
        return -1;
    if (check_errors(arguments))
        return error_context("%s: forces", scene->path);
    if (arguments->start.how == START_FILE && !cli_given(&arguments->cli, "start"))
        return error_input("%s: forces.start: name the file on the command line, --start FILE", scene->path);
    options->start = arguments->start.how;
    if (arguments->shape_px > 0 && !(scene->scale > 0))
        return scene_lacks(scene, "scale_m_per_px", "forces.series.shape_px is in px");
    if (!isnan(arguments->shape_px))
        arguments->series.shape = arguments->shape_px > 0 ? arguments->shape_px * scene->scale : 0;
    arguments->series.samples = options->samples;
    return 0;
}

/* The methods as a list, so that readers need not cut text at commas. */
static int add_words(cJSON *object, const struct method_list *list, const struct force_options *options)
{
    cJSON *methods = cJSON_AddArrayToObject(object, "method");
    for (int k = 0; methods && k < list->count; k++)
        if (!cJSON_AddItemToArray(methods, cJSON_CreateString(method_row(list->method[k])->name)))
            return -1;
    return methods && cJSON_AddStringToObject(object, "start", FORCE_STARTS[options->start]) &&
                   cJSON_AddStringToObject(object, "fix", FORCE_FIXES[options->fix])
               ? 0
               : -1;
}

/* NaN (kn is not known) becomes null: JSON has no NaN. */
static int add_number(cJSON *object, const char *key, double value)
{
    cJSON *added = isfinite(value) ? cJSON_AddNumberToObject(object, key, value) : cJSON_AddNullToObject(object, key);
    return added ? 0 : -1;
}

char *force_options_text(const struct method_list *list, const struct force_options *options)
{
    cJSON *object = cJSON_CreateObject();
    char *text = NULL;
    int failed =
        !object || add_words(object, list, options) || add_number(object, "kn_N_per_m", options->law.kn) ||
        add_number(object, "kt_over_kn", options->law.kt_over_kn) || add_number(object, "mu", options->law.mu) ||
        add_number(object, "mu_wall", options->law.mu_wall) || add_number(object, "rescale", options->rescale) ||
        add_number(object, "tolerance", options->tolerance) || add_number(object, "iterations", options->iterations) ||
        add_number(object, "relaxation", options->relaxation) || add_number(object, "thickness", options->thickness) ||
        add_number(object, "wall_mass", options->wall_mass) || add_number(object, "candidates", options->candidates) ||
        add_number(object, "orthogonal", options->orthogonal) || add_number(object, "anderson", options->anderson) ||
        add_number(object, "block", options->block) || add_number(object, "colours", options->colours) ||
        add_number(object, "samples", options->samples) || add_number(object, "walk", options->walk) ||
        add_number(object, "stability", options->stability) ||
        (options->range && !cJSON_AddStringToObject(object, "range", options->range));
    if (!failed)
        text = json_print(object);
    cJSON_Delete(object);
    if (!text)
        error_set(EXIT_FAILED, "out of memory: parameters");
    return text;
}
