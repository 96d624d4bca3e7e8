#include "pipeline/files/input_file.h"

#include <errno.h>
#include <fcntl.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "pipeline/files/read_record.h"
#include "pipeline/speak/error.h"

static int check(int fd, const char *path, size_t most)
{
    struct stat status;
    if (fstat(fd, &status))
        return error_input("%s: %s: name a file that can be read", path, strerror(errno));
    if (S_ISDIR(status.st_mode))
        return error_input("%s: is a folder: name a file", path);
    if (!S_ISREG(status.st_mode))
        return error_input("%s: is a pipe or a device: name a regular file", path);
    if (most && (unsigned long long)status.st_size > most)
        return error_input("%s: %lld bytes, more than %zu: is this the right file?", path, (long long)status.st_size,
                           most);
    return 0;
}

int input_descriptor(const char *path, size_t most)
{
    int fd = open(path, O_RDONLY | O_CLOEXEC | O_NOCTTY | O_NONBLOCK); /* a pipe without a writer opens at once */
    if (fd < 0)
        return error_input("%s: %s: name a file that can be read", path, strerror(errno));
    if (!check(fd, path, most))
        return fd;
    close(fd);
    return -1;
}

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
    int fd = input_descriptor(path, most);
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
