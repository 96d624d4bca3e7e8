/* report export: options, read, call, write. */
#include <stdio.h>
#include <stdlib.h>

#include "pipeline/cli.h"
#include "pipeline/error.h"
#include "report/commands.h"
#include "report/export.h"
#include "report/text_file.h"

struct options {
    struct cli cli;
    struct cli_inputs files;
    int format; /* enum key, 0: not given */
    const char *table;
};

enum { KEY_CSV = 0x2000, KEY_XYZ, KEY_CONF, KEY_DIC, KEY_TABLE };

static const struct argp_option option_list[] = {
    {"csv", KEY_CSV, NULL, 0, "A table with units in its heading, for spreadsheets, pandas, MATLAB, Julia", 0},
    {"xyz", KEY_XYZ, NULL, 0, "Grains as extended XYZ, for OVITO", 0},
    {"conf", KEY_CONF, NULL, 0, "Grains as CONFnnnn of the original programs (contacts or forces files)", 0},
    {"dic", KEY_DIC, NULL, 0, "Motions as dic_out_n.txt of the original programs (tracks files)", 0},
    {"table", KEY_TABLE, "T", 0, "With --csv: grains (default), contacts (with all forces) or walls", 0},
    {0}};

static const char documentation[] = "Write one state file as text that other programs read.\v"
                                    "Examples:\n"
                                    "  report export --csv 0003.tracks.hdf -o 0003.csv\n"
                                    "  report export --csv --table contacts 0003.forces.hdf -o contacts.csv\n"
                                    "  report export --xyz 0003.forces.hdf -o 0003.xyz";

static error_t parse_option(int key, char *argument, struct argp_state *state)
{
    static const char *const tables[] = {"grains", "contacts", "walls", NULL};
    struct options *options = state->input;
    switch (key) {
    case ARGP_KEY_INIT:
        state->child_inputs[0] = &options->cli;
        return 0;
    case KEY_CSV:
    case KEY_XYZ:
    case KEY_CONF:
    case KEY_DIC:
        if (options->format)
            argp_error(state, "give one of --csv --xyz --conf --dic");
        options->format = key;
        return 0;
    case KEY_TABLE:
        options->table = tables[cli_choice(state, "--table", argument, tables)];
        return 0;
    case ARGP_KEY_ARG:
        return cli_inputs_add(&options->files, argument) ? ENOMEM : 0;
    case ARGP_KEY_END:
        if (!options->format)
            argp_error(state, "which format? Give one of --csv --xyz --conf --dic");
        if (options->files.count != 1)
            argp_error(state, "give one state file");
        return 0;
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

static int write_text(const struct options *options, const struct loaded *loaded, FILE *stream)
{
    switch (options->format) {
    case KEY_CSV:
        return export_csv(loaded, options->table, stream);
    case KEY_XYZ:
        return export_xyz(loaded, stream);
    case KEY_CONF:
        return export_conf(loaded, stream);
    default:
        return export_dic(loaded, stream);
    }
}

static int run(const struct options *options)
{
    struct loaded loaded;
    char *text = NULL;
    size_t length = 0;
    if (loaded_read(options->files.paths[0], &loaded))
        return -1;
    FILE *stream = open_memstream(&text, &length);
    int result = stream ? write_text(options, &loaded, stream) : error_memory("an export");
    if (stream && (ferror(stream) | fclose(stream)) && result == 0)
        result = error_memory("an export");
    if (result == 0)
        result = text_file_write(options->cli.output, text, length);
    free(text);
    loaded_free(&loaded);
    return result;
}

int command_export(int argc, char **argv)
{
    const struct argp_child children[] = {CLI_CHILD, {0}};
    const struct argp parser = {option_list, parse_option, "STATE.hdf", documentation, children, NULL, NULL};
    struct options options = {.cli = CLI_DEFAULT, .table = "grains"};
    options.cli.needs = CLI_NEEDS_OUTPUT;
    cli_parse(&parser, argc, argv, &options);
    int status = cli_finish(&options.cli, run(&options));
    cli_inputs_free(&options.files);
    return status;
}
