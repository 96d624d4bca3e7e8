/* Atomic by rename(2): in one file system it replaces the target in one step, so that readers see the old file or
 * the new one. Flushed before (the content is on the disk when the name is) and after (the name is).
 *
 * Signals: a handler may neither lock nor allocate (POSIX signal-safety), so the names that it has to remove lie in
 * a fixed table, each row guarded by an atomic state; a handler sees whole names only. */
#include "pipeline/files/new_file.h"

#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <limits.h>
#include <signal.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/random.h>
#include <sys/stat.h>
#include <unistd.h>

#include "pipeline/speak/error.h"

/* ---- what a signal has to remove ---- */

enum { PENDING_FILES = 8 }; /* a program has one or two at a time; more of them are only left behind, not wrong */
static struct pending {
    atomic_int state; /* 0 free, 1 being written, 2 names a file */
    char path[PATH_MAX];
} pending[PENDING_FILES];

/* Note a temporary name for the handler; without room it is left out. */
static void remember(const char *path)
{
    size_t length = strlen(path);
    for (int k = 0; k < PENDING_FILES && length < PATH_MAX; k++) {
        int was_free = 0;
        if (!atomic_compare_exchange_strong(&pending[k].state, &was_free, 1))
            continue;
        memcpy(pending[k].path, path, length + 1);
        atomic_store(&pending[k].state, 2);
        return;
    }
}

/* The name is gone, or a file that stays. */
static void forget(const char *path)
{
    for (int k = 0; k < PENDING_FILES; k++)
        if (atomic_load(&pending[k].state) == 2 && strcmp(pending[k].path, path) == 0)
            atomic_store(&pending[k].state, 0);
}

/* Only calls that POSIX allows in a handler. */
static void remove_and_die(int number)
{
    for (int k = 0; k < PENDING_FILES; k++)
        if (atomic_load(&pending[k].state) == 2)
            unlink(pending[k].path);
    signal(number, SIG_DFL);
    raise(number);
}

void new_file_remove_on_signals(void)
{
    static const int numbers[] = {SIGHUP, SIGINT, SIGTERM};
    for (size_t k = 0; k < sizeof numbers / sizeof *numbers; k++) {
        struct sigaction action = {.sa_handler = remove_and_die}, before;
        if (sigaction(numbers[k], NULL, &before) == 0 && before.sa_handler == SIG_DFL)
            sigaction(numbers[k], &action, NULL);
    }
    signal(SIGXFSZ, SIG_IGN); /* a file beyond `ulimit -f`: the write fails with EFBIG, like one on a full disk */
}

/* ---- one file ---- */

/* Accepts a zeroed struct; leaves one. */
static void free_names(struct new_file *file)
{
    free(file->path);
    free(file->temporary);
    memset(file, 0, sizeof *file);
}

/* The target itself, or what a symbolic link points at. */
static char *resolve(const char *path)
{
    struct stat status;
    if (lstat(path, &status) || !S_ISLNK(status.st_mode))
        return strdup(path);
    return realpath(path, NULL);
}

/* 0 when the target is absent or a regular file; -1 with an error. */
static int check_target(const char *path)
{
    struct stat status;
    if (stat(path, &status))
        return 0; /* absent: what is wrong with its folder shows when the temporary file is made */
    if (S_ISDIR(status.st_mode))
        return error_failed("%s: is a folder: name a file", path);
    if (!S_ISREG(status.st_mode))
        return error_failed("%s: is not a regular file: name a file that may be replaced", path);
    return 0;
}

/* Create FOLDER/.BASE.RANDOM.tmp, which must not exist yet; permissions follow the umask. */
static int create_temporary(struct new_file *file)
{
    const char *slash = strrchr(file->path, '/');
    const char *base = slash ? slash + 1 : file->path;
    for (int attempt = 0; attempt < 16; attempt++) {
        uint64_t name;
        if (getrandom(&name, sizeof name, 0) != sizeof name)
            return error_failed("%s: no random numbers for a temporary name: %s", file->path, strerror(errno));
        if (asprintf(&file->temporary, "%.*s.%.200s.%016" PRIx64 ".tmp", (int)(base - file->path), file->path, base,
                     name) < 0) {
            file->temporary = NULL;
            return error_memory("a file name");
        }
        remember(file->temporary);
        int fd = open(file->temporary, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC | O_NOFOLLOW, 0666);
        if (fd >= 0)
            return close(fd), 0;
        int reason = errno;
        forget(file->temporary);
        free(file->temporary);
        errno = reason;
        file->temporary = NULL;
        if (errno != EEXIST)
            break;
    }
    return error_failed("%s: cannot be written: %s: check the folder and the disk", file->path, strerror(errno));
}

int new_file_begin(struct new_file *file, const char *path)
{
    memset(file, 0, sizeof *file);
    file->path = resolve(path);
    if (!file->path)
        return error_failed("%s: cannot be written: %s: check the link", path, strerror(errno));
    if (check_target(file->path) || create_temporary(file)) {
        free_names(file);
        return -1;
    }
    return 0;
}

void new_file_discard(struct new_file *file)
{
    if (file->temporary) {
        unlink(file->temporary);
        forget(file->temporary);
    }
    free_names(file);
}

/* fsync through a descriptor of its own; -1 with errno. */
static int sync_path(const char *path, int flags)
{
    int fd = open(path, O_RDONLY | O_CLOEXEC | flags);
    if (fd < 0)
        return -1;
    int failed = fsync(fd);
    int reason = errno;
    close(fd);
    errno = reason;
    return failed;
}

/* The folder of that path, where rename() has changed an entry. -1 with errno. */
static int sync_folder(const char *path)
{
    const char *slash = strrchr(path, '/');
    char *folder = slash ? strndup(path, (size_t)(slash - path) + 1) : strdup(".");
    if (!folder)
        return -1;
    int failed = sync_path(folder, O_DIRECTORY);
    int reason = errno;
    free(folder);
    errno = reason;
    return failed && reason != EINVAL ? -1 : 0; /* some network file systems cannot flush a folder */
}

int new_file_commit(struct new_file *file)
{
    int result = 0;
    if (sync_path(file->temporary, 0))
        result =
            error_failed("%s: cannot be flushed to the disk: %s: make room and run again", file->path, strerror(errno));
    else if (rename(file->temporary, file->path))
        result = error_failed("%s: cannot be renamed into place: %s: check the folder", file->path, strerror(errno));
    else if (sync_folder(file->path))
        result = error_failed("%s: its folder cannot be flushed to the disk: %s: check the disk", file->path,
                              strerror(errno));
    else {
        forget(file->temporary);
        free_names(file);
        return 0;
    }
    new_file_discard(file);
    return result;
}
