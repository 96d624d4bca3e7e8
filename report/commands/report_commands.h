/* The commands of report: options, read, call, write, free. */
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
