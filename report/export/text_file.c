/* A text is written beside its target and then renamed onto it (pipeline/files/new_file.h): whoever reads the target
 * finds the old text or the new one, whole. */
#include "report/export/text_file.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "pipeline/speak/error.h"
#include "pipeline/files/new_file.h"

int text_file_write(const char *path, const char *text, size_t length)
{
    struct new_file file;
    if (new_file_begin(&file, path))
        return -1;
    FILE *stream = fopen(file.temporary, "wbe");
    int failed = !stream || fwrite(text, 1, length, stream) != length;
    if (stream && !failed && (length == 0 || text[length - 1] != '\n'))
        failed = fputc('\n', stream) == EOF;
    if (stream)
        failed |= fclose(stream) != 0;
    if (failed) {
        int reason = errno;
        new_file_discard(&file);
        return error_failed("%s: cannot be written: %s: check the room on the disk", path, strerror(reason));
    }
    return new_file_commit(&file);
}
