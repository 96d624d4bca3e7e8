/* Opening a file to read it from beginning to end. */
#ifndef PIPELINE_INPUT_FILE_H
#define PIPELINE_INPUT_FILE_H

#include <stddef.h>
#include <stdio.h>

/* What people write by hand is shorter; a line of such a file fits into memory. */
#define INPUT_FILE_TEXT ((size_t)1 << 28)

/* A regular file (files/regular_file.h) as a stream of text, at its beginning (behind a byte order mark of UTF-8),
 * noted in the record of what was read (files/read_record.h); NULL with an error. */
FILE *input_file_open(const char *path, size_t most);

#endif
