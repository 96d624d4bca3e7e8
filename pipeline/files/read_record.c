#include "pipeline/files/read_record.h"

#include <errno.h>
#include <search.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "pipeline/files/sha256.h"
#include "pipeline/speak/error.h"

struct read_entry {
    const char *path;
    char digest[65];
    struct stat then;
};

static void *entries; /* of this process: a tree (search.h), reached inside the critical sections only */
static int recording;

void read_record_begin(void)
{
    recording = 1;
}

static int by_path(const void *a, const void *b)
{
    return strcmp(((const struct read_entry *)a)->path, ((const struct read_entry *)b)->path);
}

static const struct read_entry *entry_of(const char *path)
{
    const struct read_entry key = {.path = path};
    struct read_entry *const *found = tfind(&key, &entries, by_path);
    return found ? *found : NULL;
}

/* The same file with the same bytes, as far as its times tell. */
static int is_untouched(const struct stat *then, const struct stat *now)
{
    return then->st_size == now->st_size && then->st_mtim.tv_sec == now->st_mtim.tv_sec &&
           then->st_mtim.tv_nsec == now->st_mtim.tv_nsec;
}

static int is_same_file(const struct stat *a, const struct stat *b)
{
    return a->st_dev == b->st_dev && a->st_ino == b->st_ino;
}

static int add(const char *path, const char digest[65], const struct stat *then)
{
    struct read_entry *entry = calloc(1, sizeof *entry);
    char *name = strdup(path);
    if (entry && name) {
        *entry = (struct read_entry){.path = name, .then = *then};
        memcpy(entry->digest, digest, 65);
        if (tsearch(entry, &entries, by_path))
            return 0;
    }
    free(entry), free(name);
    return error_memory("the record of inputs");
}

static int changed(const char *path)
{
    return error_input("%s: was changed while it was read: let nothing write to it, and run again", path);
}

static int note(const char *path, int fd)
{
    struct stat before, after;
    char digest[65];
    const struct read_entry *entry = entry_of(path);
    if (fstat(fd, &before))
        return error_input("%s: %s: check the file", path, strerror(errno));
    if (entry && is_same_file(&entry->then, &before) && is_untouched(&entry->then, &before))
        return 0;
    if (descriptor_sha256(fd, digest) || lseek(fd, 0, SEEK_SET) || fstat(fd, &after))
        return error_context("%s", path);
    if (!is_untouched(&before, &after) || (entry && strcmp(entry->digest, digest)))
        return changed(path);
    return entry ? 0 : add(path, digest, &before);
}

int read_record_note(const char *path, int fd)
{
    int status = 0;
#pragma omp critical(read_record)
    {
        if (recording)
            status = note(path, fd);
    }
    return status;
}

/* 1: not recorded; else as read_record_digest(). */
static int look_up(const char *path, char digest[65])
{
    struct stat now;
    const struct read_entry *entry = entry_of(path);
    if (!entry)
        return 1;
    /* A file of another inode took its place: what was read is gone from the folder, but was read whole. */
    if (!stat(path, &now) && is_same_file(&entry->then, &now) && !is_untouched(&entry->then, &now))
        return changed(path);
    memcpy(digest, entry->digest, 65);
    return 0;
}

int read_record_digest(const char *path, char digest[65])
{
    int status;
#pragma omp critical(read_record)
    status = look_up(path, digest);
    return status == 1 ? file_sha256(path, digest) : status;
}
