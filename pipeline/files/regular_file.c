#include "pipeline/files/regular_file.h"

#include <errno.h>
#include <fcntl.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

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

int regular_file(const char *path, size_t most)
{
    int fd = open(path, O_RDONLY | O_CLOEXEC | O_NOCTTY | O_NONBLOCK); /* a pipe without a writer opens at once */
    if (fd < 0)
        return error_input("%s: %s: name a file that can be read", path, strerror(errno));
    if (!check(fd, path, most))
        return fd;
    close(fd);
    return -1;
}
