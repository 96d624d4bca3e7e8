/* Opening a file to read it from beginning to end. */
#ifndef PIPELINE_INPUT_FILE_H
#define PIPELINE_INPUT_FILE_H

#include <stddef.h>
#include <stdio.h>

/* What people write by hand is shorter; a line of such a file fits into memory. */
#define INPUT_FILE_TEXT ((size_t)1 << 28)

/* A descriptor of a regular file of at most `most` bytes (0: any), for reading, to be closed; -1 with an error
 * (EXIT_INPUT). A pipe without a writer would be waited for, a device such as /dev/zero has no end: both are refused.
 */
int input_descriptor(const char *path, size_t most);

/* The same as a stream of text, at its beginning (behind a byte order mark of UTF-8), noted in the record of what was read (files/read_record.h); NULL with an
 * error. */
FILE *input_file_open(const char *path, size_t most);

#endif
