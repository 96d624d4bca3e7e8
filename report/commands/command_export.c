/* report export: options, read, call, write. */
#include <stdio.h>
#include <stdlib.h>

#include "pipeline/command/cli.h"
#include "pipeline/speak/error.h"
#include "report/commands/report_commands.h"
#include "report/export/export.h"
#include "report/export/export_series.h"
#include "report/states/method_choice.h"
#include "report/export/text_file.h"

struct options {
    struct cli cli;
    struct cli_inputs files;
    int format; /* enum key, 0: not given */
    const char *table, *method;
};

enum { KEY_CSV = 0x2000, KEY_XYZ, KEY_CONF, KEY_DIC, KEY_LAMMPS, KEY_LAMMPS_LOCAL, KEY_SERIES, KEY_TABLE, KEY_METHOD };

static const struct argp_option option_list[] = {
    {"csv", KEY_CSV, NULL, 0, "A table with units in its heading, for spreadsheets, pandas, MATLAB, Julia", 0},
    {"xyz", KEY_XYZ, NULL, 0, "Grains as extended XYZ, for OVITO; several files: several frames", 0},
    {"lammps", KEY_LAMMPS, NULL, 0, "Grains as a LAMMPS dump, for OVITO; several files: several steps", 0},
    {"lammps-local", KEY_LAMMPS_LOCAL, NULL, 0, "Contacts as a LAMMPS dump local (bonds with fn, ft)", 0},
    {"series", KEY_SERIES, NULL, 0, "A .hdf.series for ParaView: the files with their times", 0},
    {"conf", KEY_CONF, NULL, 0, "Grains as CONFnnnn of the original programs (contacts or forces files)", 0},
    {"dic", KEY_DIC, NULL, 0, "Motions as dic_out_n.txt of the original programs (tracks files)", 0},
    {"table", KEY_TABLE, "T", 0, "With --csv: grains (default), contacts (with all forces) or walls", 0},
    {"method", KEY_METHOD, "M", 0, "With --lammps-local: whose forces (default: " METHOD_DEFAULT_ORDER ")", 0},
    {0}};

static const char documentation[] =
    "Write state files as text that other programs read.\v"
    "Examples:\n"
    "  report export --csv 0003.tracks.hdf -o 0003.csv\n"
    "  report export --csv --table contacts 0003.forces.hdf -o contacts.csv\n"
    "  report export --lammps out/*.forces.hdf -o grains.dump\n"
    "  report export --series out/*.forces.hdf -o out/all.hdf.series\n\n"
    "ParaView opens a .forces.hdf as it is, and the .hdf.series as a film with physical times.";

static int takes_many(int format)
{
    return format == KEY_XYZ || format == KEY_LAMMPS || format == KEY_LAMMPS_LOCAL || format == KEY_SERIES;
}

static error_t parse_option(int key, char *argument, struct argp_state *state)
{
    static const char *const tables[] = {"grains", "contacts", "walls", NULL};
    struct options *options = state->input;
    if (key >= KEY_CSV && key <= KEY_SERIES) {
        if (options->format)
            argp_error(state, "give one format only");
        options->format = key;
        return 0;
    }
    switch (key) {
    case ARGP_KEY_INIT:
        state->child_inputs[0] = &options->cli;
        return 0;
    case KEY_TABLE:
        options->table = tables[cli_choice(state, "--table", argument, tables)];
        return 0;
    case KEY_METHOD:
        options->method = argument;
        return 0;
    case ARGP_KEY_ARG:
        return cli_inputs_add(&options->files, argument) ? ENOMEM : 0;
    case ARGP_KEY_END:
        if (!options->format)
            argp_error(state, "which format? Give --csv, --xyz, --lammps, --lammps-local, --series, --conf or --dic");
        if (options->files.count == 0 || (options->files.count > 1 && !takes_many(options->format)))
            argp_error(state, options->files.count ? "this format takes one state file" : "give a state file");
        return 0;
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

static int write_one(const struct options *options, const struct loaded *loaded, FILE *stream)
{
    switch (options->format) {
    case KEY_CSV:
        return export_csv(loaded, options->table, stream);
    case KEY_XYZ:
        return export_xyz(loaded, stream);
    case KEY_LAMMPS:
        return export_lammps(loaded, stream);
    case KEY_LAMMPS_LOCAL:
        return export_lammps_local(loaded, options->method, stream);
    case KEY_CONF:
        return export_conf(loaded, stream);
    default:
        return export_dic(loaded, stream);
    }
}

static int write_all(const struct options *options, FILE *stream)
{
    int result = 0;
    if (options->format == KEY_SERIES)
        return export_hdf_series(options->files.paths, options->files.count, options->cli.output, stream);
    for (size_t k = 0; k < options->files.count && result == 0; k++) {
        struct loaded loaded;
        if (loaded_read(options->files.paths[k], &loaded))
            return -1;
        result = write_one(options, &loaded, stream);
        loaded_free(&loaded);
    }
    return result;
}

static int run(const struct options *options)
{
    char *text = NULL;
    size_t length = 0;
    FILE *stream = open_memstream(&text, &length);
    int result = stream ? write_all(options, stream) : error_memory("an export");
    if (stream && (ferror(stream) | fclose(stream)) && result == 0)
        result = error_memory("an export");
    if (result == 0)
        result = text_file_write(options->cli.output, text, length);
    free(text);
    return result;
}

int command_export(int argc, char **argv)
{
    const struct argp_child children[] = {CLI_CHILD, {0}};
    const struct argp parser = {option_list, parse_option, "STATE.hdf...", documentation, children, NULL, NULL};
    struct options options = {.cli = CLI_DEFAULT, .table = "grains"};
    options.cli.needs = CLI_NEEDS_OUTPUT;
    cli_parse(&parser, argc, argv, &options);
    int status = cli_finish(&options.cli, run(&options));
    cli_inputs_free(&options.files);
    return status;
}
