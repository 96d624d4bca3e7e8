/* report: one program of many commands; each is a row here and a file in report/commands. */
#include "report/commands/report_commands.h"
#include "pipeline/command/cli.h"

static const struct subcommand commands[] = {
    {"map", "report map", command_map, "a picture of the contact forces, PNG, SVG or PDF"},
    {"compare", "report compare", command_compare, "one state file against another, or against the truth"},
    {"page", "report page", command_page, "one HTML page about a whole series"},
    {"export", "report export", command_export, "state files as CSV, XYZ, LAMMPS dump, ParaView series, CONF, dic_out"},
    {"film", "report film", command_film, "the force maps of a series as frames in one view"},
    {"budget", "report budget", command_budget, "the error of forces to expect, before going to the lab"},
    {"histogram", "report histogram", command_histogram, "the grey levels of a photo"},
    {"found", "report found", command_found, "frame and radii that findgrains found, as a piece of a scene"},
    {"verify", "report verify", command_verify, "are state files whole, and still made of what lies on the disk?"},
    {0}};

int main(int argc, char **argv)
{
    return cli_command("report", "Pictures, tables, comparisons and exports of state files.", commands, argc, argv);
}
