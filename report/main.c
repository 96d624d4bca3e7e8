#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "pipeline/speak/version.h"
#include "pipeline/speak/error.h"
#include "report/commands/report_commands.h"

static const struct command {
    const char *name, *full_name;
    int (*run)(int argc, char **argv);
    const char *what;
} commands[] = {
    {"map", "report map", command_map, "a picture of the contact forces, PNG, SVG or PDF"},
    {"compare", "report compare", command_compare, "one state file against another, or against the truth"},
    {"page", "report page", command_page, "one HTML page about a whole series"},
    {"export", "report export", command_export, "state files as CSV, XYZ, LAMMPS dump, ParaView series, CONF, dic_out"},
    {"film", "report film", command_film, "the force maps of a series as frames in one view"},
    {"budget", "report budget", command_budget, "the error of forces to expect, before going to the lab"},
    {"histogram", "report histogram", command_histogram, "the grey levels of a photo"},
    {"found", "report found", command_found, "frame and radii that findgrains found, as a piece of a scene"},
    {"verify", "report verify", command_verify, "are state files whole, and still made of what lies on the disk?"},
};

static void print_help(void)
{
    puts("Usage: report COMMAND [OPTION...]\nPictures, tables, comparisons and exports of state files.\n");
    for (size_t k = 0; k < sizeof commands / sizeof *commands; k++)
        printf("  %-10s %s\n", commands[k].name, commands[k].what);
    puts("\n'report COMMAND --help' teaches one command.");
}

int main(int argc, char **argv)
{
    if (argc > 1 && !strcmp(argv[1], "--help")) {
        print_help();
        return EXIT_DONE;
    }
    if (argc > 1 && !strcmp(argv[1], "--version")) {
        printf("report (film) %s\n", film_version);
        return EXIT_DONE;
    }
    for (size_t k = 0; argc > 1 && k < sizeof commands / sizeof *commands; k++)
        if (!strcmp(argv[1], commands[k].name)) {
            program_invocation_short_name = (char *)commands[k].full_name;
            return commands[k].run(argc - 1, argv + 1);
        }
    fprintf(stderr, "report: %s 'report --help' lists the commands\n",
            argc > 1 ? "there is no such command:" : "which command?");
    return EXIT_USAGE;
}
