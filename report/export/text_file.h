/* Text in memory, then a whole file or none. */
#ifndef REPORT_TEXT_FILE_H
#define REPORT_TEXT_FILE_H

#include <stddef.h>

/* Atomically; ends the text with a line end when it lacks one. 0, or -1 with a line that names the path; the target is
 * untouched then. */
int text_file_write(const char *path, const char *text, size_t length);

#endif
