/* A file is whole or absent: written beside its target under an unpredictable name, flushed to the disk, renamed.
 *
 *     struct new_file file;
 *     if (new_file_begin(&file, path))
 *         return -1;
 *     if (write_everything(file.temporary))
 *         return new_file_discard(&file), -1;
 *     return new_file_commit(&file);
 */
#ifndef PIPELINE_NEW_FILE_H
#define PIPELINE_NEW_FILE_H

struct new_file {
    char *path;      /* the target; a symbolic link is followed */
    char *temporary; /* in the same folder; exists and is empty after new_file_begin() */
};

/* Refuses a target that exists and is not a regular file (a folder, /dev/null): rename would replace it. */
int new_file_begin(struct new_file *file, const char *path);
/* fsync the temporary file, rename it, fsync the folder. Whatever happens, `file` is freed and nothing temporary
 * stays. */
int new_file_commit(struct new_file *file);
/* Remove the temporary file, free `file`; keeps the error line. Accepts a zeroed struct. */
void new_file_discard(struct new_file *file);

/* From now on SIGHUP, SIGINT and SIGTERM remove the temporary files of this process before they end it. Signals that
 * are ignored (nohup) stay ignored. SIGXFSZ is: a file that grows beyond the limit (ulimit -f) is a write that fails.
 */
void new_file_remove_on_signals(void);

#endif
