/* Lists of paths from the command line. */
#ifndef PIPELINE_CLI_INPUTS_H
#define PIPELINE_CLI_INPUTS_H

#include <stddef.h>

struct cli_inputs {
    char **paths; /* borrowed from the command line, or from `text` */
    size_t count;
    char *text; /* of cli_inputs_read() */
};

/* Append a path, which is borrowed. -1: out of memory (EXIT_FAILED). */
int cli_inputs_add(struct cli_inputs *inputs, const char *path);
/* Append the paths in a file, one per line (once; NULL: none): more than a command line holds. -1: the file cannot be
 * read (EXIT_FAILED, EXIT_INPUT), or has a zero byte (EXIT_INPUT). */
int cli_inputs_read(struct cli_inputs *inputs, const char *path);
void cli_inputs_free(struct cli_inputs *inputs); /* accepts a zeroed struct */

#endif
