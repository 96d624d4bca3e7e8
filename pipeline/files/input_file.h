/* Opening a file to read it from beginning to end. */
#ifndef PIPELINE_INPUT_FILE_H
#define PIPELINE_INPUT_FILE_H

#include <stddef.h>
#include <stdio.h>

/* What people write by hand is shorter; a line of such a file fits into memory. */
#define INPUT_FILE_TEXT ((size_t)1 << 28)

/* A regular file of at most `most` bytes (0: any), for reading; NULL with an error (EXIT_INPUT). A pipe without a
 * writer would be waited for, a device such as /dev/zero has no end: both are refused. */
FILE *input_file_open(const char *path, size_t most);

#endif
