/* What argp and getopt say about a wrong command line repeats its words: here they are made fit for a terminal. */
#ifndef PIPELINE_CLI_MESSAGES_H
#define PIPELINE_CLI_MESSAGES_H

#include <stdio.h>

/* Until cli_messages_end(), or the end of the program, what goes to stderr is held back and then printed with '?' for
 * control characters, bytes that are no UTF-8, and line breaks that stand in the words `argv`. */
FILE *cli_messages_begin(char *const argv[]);
void cli_messages_end(FILE *before);

#endif
