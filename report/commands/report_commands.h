/* The commands of report, each in a file of its name: options, read, call, write, free. Each parses its own command
 * line (argv[0]: its name) and returns the exit status. A new one is a file, a line here and a row in report/main.c. */
#ifndef REPORT_COMMANDS_H
#define REPORT_COMMANDS_H

int command_map(int argc, char **argv);
int command_compare(int argc, char **argv);
int command_page(int argc, char **argv);
int command_export(int argc, char **argv);
int command_film(int argc, char **argv);
int command_budget(int argc, char **argv);
int command_histogram(int argc, char **argv);
int command_verify(int argc, char **argv);
int command_found(int argc, char **argv);

#endif
