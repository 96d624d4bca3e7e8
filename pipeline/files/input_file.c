#include "pipeline/files/input_file.h"

#include <string.h>
#include <unistd.h>

#include "pipeline/files/read_record.h"
#include "pipeline/files/regular_file.h"
#include "pipeline/speak/error.h"

/* Editors of Windows begin a text with one; nobody sees it. */
static FILE *skip_byte_order_mark(FILE *file)
{
    char mark[3];
    if (file && (fread(mark, 1, sizeof mark, file) != sizeof mark || memcmp(mark, "\xEF\xBB\xBF", sizeof mark)))
        rewind(file);
    return file;
}

FILE *input_file_open(const char *path, size_t most)
{
    int fd = regular_file(path, most);
    if (fd < 0)
        return NULL;
    int refused = read_record_note(path, fd);
    FILE *file = refused ? NULL : skip_byte_order_mark(fdopen(fd, "r"));
    if (file)
        return file;
    if (!refused)
        (void)error_memory(path);
    close(fd);
    return NULL;
}
