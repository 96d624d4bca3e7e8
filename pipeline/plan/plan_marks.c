/* A result is trusted when its stage said that it is whole and nothing that it was made from is newer. Every program
 * writes whole files or none; but one that was cut off after the renaming has not said its status (done, or flagged),
 * which is why a result with a mark in .running is made again although it is whole.
 *
 * Nothing here follows a name into another folder: all names are the plan's own, relative to the open folder. */
#include "pipeline/plan/plan_marks.h"

#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "pipeline/files/new_file.h"
#include "pipeline/speak/error.h"

enum { NAME = 64 }; /* bytes of ".failed/" or ".scene/" and a name of ours */

int plan_holds(const struct plan *plan, const char *folder, const char *name)
{
    char path[NAME];
    snprintf(path, sizeof path, "%s%s", folder, name);
    return !faccessat(plan->folder, path, F_OK, 0);
}

/* ---- what changed ---- */

/* Does the file say exactly this? What cannot be read says something else. */
static int says(const struct plan *plan, const char *name, const char *text)
{
    size_t length = strlen(text), got = 0;
    char *content = malloc(length + 1);
    int file = openat(plan->folder, name, O_RDONLY | O_CLOEXEC | O_NONBLOCK);
    FILE *stream = file >= 0 ? fdopen(file, "r") : NULL;
    if (stream && content)
        got = fread(content, 1, length + 1, stream);
    int same = stream && content && got == length && !memcmp(content, text, length);
    if (stream)
        fclose(stream);
    free(content);
    return same;
}

void plan_changed_parts(const struct plan *plan, int changed[PLAN_STAGES])
{
    for (int stage = 0; stage < PLAN_STAGES; stage++) {
        char name[NAME];
        snprintf(name, sizeof name, ".scene/%s", PLAN_STAGE[stage]);
        changed[stage] = !says(plan, name, plan->part[stage]);
    }
}

/* A path that is absolute is taken as it is, whatever the folder.
 * Is the file in `folder` newer, or not there? Then the stage will make it again, or complain. */
static int is_newer(int folder, const char *path, const struct stat *than)
{
    struct stat info;
    if (fstatat(folder, path, &info, 0))
        return 1;
    const struct timespec *a = &info.st_mtim, *b = &than->st_mtim;
    return a->tv_sec > b->tv_sec || (a->tv_sec == b->tv_sec && a->tv_nsec > b->tv_nsec);
}

/* Is any of the files gone that the run behind series.csv wrote before it? */
static int lacks_forces(const struct plan *plan)
{
    int lacking = 0;
    for (size_t k = 0; k < plan->count && !lacking; k++) {
        struct plan_name name = plan_name(plan, k);
        lacking = plan_is_made(plan, &name, 1 << RESULT_FORCES) && !plan_holds(plan, "", name.name);
    }
    return lacking;
}

int plan_is_changed(const struct plan *plan, const int parts[PLAN_STAGES], const struct product *product)
{
    struct stat made;
    char part[NAME], program[4096];
    if (!*product->command || fstatat(plan->folder, product->of.name, &made, 0))
        return 0;
    snprintf(part, sizeof part, ".scene/%s", PLAN_STAGE[product->stage]);
    snprintf(program, sizeof program, "%s/%s", plan->words.programs, PLAN_STAGE[product->stage]);
    int changed = parts[product->stage] || plan_holds(plan, ".running/", product->of.name) ||
                  is_newer(plan->folder, part, &made) || is_newer(AT_FDCWD, program, &made) ||
                  (product->of.kind == RESULT_TABLE && lacks_forces(plan));
    for (size_t k = 0; k < product->read_count && !changed; k++)
        changed = is_newer(AT_FDCWD, product->reads[k], &made);
    return changed;
}

/* ---- before a run ---- */

/* The file of that name cannot be written or removed, as errno says. */
static int fail_in(const struct plan *plan, const char *name)
{
    return error_failed("%s/%s: %s: is the disk full, or the folder not yours?", plan->words.out, name,
                        strerror(errno));
}

/* Gone, or never there. */
static int remove_file(const struct plan *plan, const char *folder, const char *name)
{
    char path[NAME];
    snprintf(path, sizeof path, "%s%s", folder, name);
    return unlinkat(plan->folder, path, 0) && errno != ENOENT ? fail_in(plan, path) : 0;
}

/* Of each result: what is not known to be whole, and what its last stage said when it failed. A series.csv speaks of
 * all files at once: it falls with any of them, and with its method. */
static int remove_remains(const struct plan *plan)
{
    for (size_t k = 0; k < plan->count; k++) {
        struct plan_name of = plan_name(plan, k);
        if (plan_holds(plan, ".running/", of.name) &&
            (remove_file(plan, "", of.name) || remove_file(plan, ".running/", of.name)))
            return -1;
        if (remove_file(plan, ".failed/", of.name))
            return -1;
    }
    return !plan->together || lacks_forces(plan) ? remove_file(plan, "", "series.csv") : 0;
}

/* new_file_begin() would follow a link to its target: the folder may be somebody else's, and the link lead to yours. */
static int write_text(const struct plan *plan, const char *path, const char *text)
{
    struct new_file file;
    struct stat info;
    if (!lstat(path, &info) && S_ISLNK(info.st_mode))
        return error_failed("%s: is a symbolic link: remove it, nothing is written through links", path);
    if (new_file_begin(&file, path))
        return -1;
    FILE *stream = fopen(file.temporary, "w");
    int failed = !stream || fputs(text, stream) < 0;
    if ((stream && fclose(stream)) || failed) {
        fail_in(plan, path);
        new_file_discard(&file);
        return -1;
    }
    return new_file_commit(&file);
}

/* The file says this; when it did before it stays, and its time tells when it changed. */
static int keep(const struct plan *plan, const char *name, const char *text)
{
    char *path = NULL;
    if (says(plan, name, text))
        return 0;
    if (asprintf(&path, "%s/%s", plan->words.out, name) < 0)
        return error_memory("plan");
    int failed = write_text(plan, path, text);
    free(path);
    return failed;
}

/* The names of the results of these kinds (bits), of the photos that are there, one a line. */
static int keep_list(const struct plan *plan, const char *name, unsigned kinds)
{
    char *text = NULL;
    size_t size;
    FILE *stream = open_memstream(&text, &size);
    for (size_t k = 0; stream && k < plan->count; k++) {
        struct plan_name of = plan_name(plan, k);
        if (plan_is_made(plan, &of, kinds))
            fprintf(stream, "%s\n", of.name);
    }
    int failed = !stream || fclose(stream) ? error_memory("plan") : keep(plan, name, text);
    free(text);
    return failed;
}

int plan_begin(const struct plan *plan)
{
    char name[NAME];
    if (plan->folder < 0 || (mkdirat(plan->folder, ".scene", 0777) && errno != EEXIST))
        return fail_in(plan, ".scene");
    if (remove_remains(plan))
        return -1;
    for (int stage = 0; stage < PLAN_STAGES; stage++) {
        snprintf(name, sizeof name, ".scene/%s", PLAN_STAGE[stage]);
        if (keep(plan, name, plan->part[stage]))
            return -1;
    }
    return keep_list(plan, PLAN_PAGE_LIST, PLAN_STATES) || keep_list(plan, PLAN_CONTACTS_LIST, 1 << RESULT_CONTACTS)
               ? -1
               : 0;
}
