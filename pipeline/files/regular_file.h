/* A descriptor that can be read from beginning to end. */
#ifndef PIPELINE_REGULAR_FILE_H
#define PIPELINE_REGULAR_FILE_H

#include <stddef.h>

/* Of a regular file of at most `most` bytes (0: any), for reading, to be closed; -1 with an error (EXIT_INPUT). A pipe
 * without a writer would be waited for, a device such as /dev/zero has no end: both are refused. */
int regular_file(const char *path, size_t most);

#endif
