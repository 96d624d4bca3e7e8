/* report export: state files as text for other programs.
 *
 * A new format is a word of `enum format`, a row, a case of write_one() and a function in report/export/export.h that
 * prints one state to a stream. */
#include <stdio.h>
#include <stdlib.h>

#include "pipeline/command/cli.h"
#include "pipeline/speak/error.h"
#include "report/commands/report_commands.h"
#include "report/export/export.h"
#include "report/export/export_series.h"
#include "report/states/method_choice.h"
#include "report/export/text_file.h"

enum format { CSV, XYZ, LAMMPS, LAMMPS_LOCAL, SERIES, CONF, DIC, FORMATS };
static const char *const tables[] = {"grains", "contacts", "walls", NULL};

struct options {
    struct cli cli;
    int format[FORMATS]; /* one is 1 */
    int table;           /* among `tables` */
    const char *method;
};

#define AT(field) .at = offsetof(struct options, field)
static const struct option_row rows[] = {
    {"csv", NULL, OPTION_SWITCH, AT(format[CSV]),
     .help = "A table with units in its heading, for spreadsheets, pandas, MATLAB, Julia"},
    {"xyz", NULL, OPTION_SWITCH, AT(format[XYZ]),
     .help = "Grains as extended XYZ, for OVITO; several files: several frames"},
    {"lammps", NULL, OPTION_SWITCH, AT(format[LAMMPS]),
     .help = "Grains as a LAMMPS dump, for OVITO; several files: several steps"},
    {"lammps-local", NULL, OPTION_SWITCH, AT(format[LAMMPS_LOCAL]),
     .help = "Contacts as a LAMMPS dump local (bonds with fn, ft)"},
    {"series", NULL, OPTION_SWITCH, AT(format[SERIES]),
     .help = "A .hdf.series for ParaView: the files with their times"},
    {"conf", NULL, OPTION_SWITCH, AT(format[CONF]),
     .help = "Grains as CONFnnnn of the original programs (contacts or forces files)"},
    {"dic", NULL, OPTION_SWITCH, AT(format[DIC]),
     .help = "Motions as dic_out_n.txt of the original programs (tracks files)"},
    {"table", NULL, OPTION_CHOICE, AT(table), "T", .words = tables,
     .help = "With --csv: which table; contacts come with all forces"},
    {"method", NULL, OPTION_TEXT, AT(method), "M",
     .help = "With --lammps-local: whose forces (default: " METHOD_DEFAULT_ORDER ")"},
    {0}};

static const char documentation[] =
    "Write state files as text that other programs read.\v"
    "Examples:\n"
    "  report export --csv 0003.tracks.hdf -o 0003.csv\n"
    "  report export --csv --table contacts 0003.forces.hdf -o contacts.csv\n"
    "  report export --lammps out/*.forces.hdf -o grains.dump\n"
    "  report export --series out/*.forces.hdf -o out/all.hdf.series\n\n"
    "ParaView opens a .forces.hdf as it is, and the .hdf.series as a film with physical times.";

/* The first that was asked for; check() has seen that it is the only one. */
static enum format format_of(const struct options *options)
{
    int k = 0;
    while (k < FORMATS && !options->format[k])
        k++;
    return (enum format)k;
}

/* Formats with frames or steps; the others hold one state. */
static int takes_many(enum format format)
{
    return format == XYZ || format == LAMMPS || format == LAMMPS_LOCAL || format == SERIES;
}

/* For struct program: exactly one format, and several files only where the format holds several states. */
static int check(void *input)
{
    const struct options *options = input;
    int wanted = 0;
    for (int k = 0; k < FORMATS; k++)
        wanted += options->format[k];
    if (wanted == 0)
        return error_input("which format? Give --csv, --xyz, --lammps, --lammps-local, --series, --conf or --dic");
    if (wanted > 1)
        return error_input("give one format only");
    if (options->cli.inputs.count > 1 && !takes_many(format_of(options)))
        return error_input("this format takes one state file");
    return 0;
}

/* One state in the format asked for; 0, or -1 with an error. A series is written by write_all(). */
static int write_one(const struct options *options, const struct loaded *loaded, FILE *stream)
{
    switch (format_of(options)) {
    case CSV:
        return export_csv(loaded, tables[options->table], stream);
    case XYZ:
        return export_xyz(loaded, stream);
    case LAMMPS:
        return export_lammps(loaded, stream);
    case LAMMPS_LOCAL:
        return export_lammps_local(loaded, options->method, stream);
    case CONF:
        return export_conf(loaded, stream);
    default:
        return export_dic(loaded, stream);
    }
}

/* A series for ParaView is made of names and times: its states are not read whole. */
static int write_all(const struct options *options, FILE *stream)
{
    int result = 0;
    if (options->format[SERIES])
        return export_hdf_series(options->cli.inputs.paths, options->cli.inputs.count, options->cli.output, stream);
    for (size_t k = 0; k < options->cli.inputs.count && result == 0; k++) {
        struct loaded loaded;
        if (loaded_read(options->cli.inputs.paths[k], &loaded))
            return -1;
        result = write_one(options, &loaded, stream);
        loaded_free(&loaded);
    }
    return result;
}

/* Into memory first: an output file is whole or is not there. */
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
    struct options options = {.cli = CLI_NEEDING(CLI_NEEDS_OUTPUT)};
    const struct program program = {"STATE.hdf...", documentation,       rows, &options, NULL, 1,
                                    CLI_MANY,       "give a state file", check};
    cli_parse(&program, argc, argv);
    return cli_finish(&options.cli, run(&options));
}
