#include "pipeline/plan/plan_marks.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "pipeline/files/new_file.h"
#include "pipeline/speak/error.h"

/* OUT/folder/name, to be freed; folder "": OUT/name. */
static char *inside(const struct plan *plan, const char *folder, const char *name)
{
    char *path = NULL;
    if (asprintf(&path, "%s/%s%s%s", plan->out, folder, *folder ? "/" : "", name) >= 0)
        return path;
    error_set(EXIT_FAILED, "out of memory: plan: use a machine with more memory");
    return NULL;
}

/* 1: there; 0: not, or a symbolic link that leads nowhere; -1 with an error. `info` may be NULL. */
static int is_there(const struct plan *plan, const char *folder, const char *name, struct stat *info)
{
    struct stat own;
    char *path = inside(plan, folder, name);
    int there = path ? !stat(path, info ? info : &own) : -1;
    free(path);
    return there;
}

/* ---- what changed ---- */

/* Does the file say exactly this? What cannot be read says something else. */
static int says(const char *path, const char *text)
{
    size_t length = strlen(text), used = 0;
    FILE *file = fopen(path, "r");
    int c = EOF;
    while (file && used < length && (c = fgetc(file)) != EOF && c == (unsigned char)text[used])
        used++;
    int same = file && used == length && fgetc(file) == EOF;
    if (file)
        fclose(file);
    return same;
}

int plan_marks_read(const struct plan *plan, struct plan_marks *marks)
{
    for (int stage = 0; stage < PLAN_STAGES; stage++) {
        char *path = inside(plan, ".scene", PLAN_STAGE[stage]);
        if (!path)
            return -1;
        marks->part_changed[stage] = !says(path, plan->part[stage]);
        free(path);
    }
    return 0;
}

/* As make compares: newer by a nanosecond is newer. What is not there must be made, or complained about, again. */
static int is_newer(const char *path, const struct stat *than)
{
    struct stat info;
    if (stat(path, &info))
        return 1;
    const struct timespec *a = &info.st_mtim, *b = &than->st_mtim;
    return a->tv_sec > b->tv_sec || (a->tv_sec == b->tv_sec && a->tv_nsec > b->tv_nsec);
}

static int lacks_forces(const struct plan *plan)
{
    int there = 1;
    for (size_t k = 0; k < plan->count && there > 0; k++) {
        struct plan_name name = plan_name(plan, k);
        if (name.kind == RESULT_FORCES)
            there = is_there(plan, "", name.name, NULL);
    }
    return there < 0 ? -1 : !there;
}

int plan_is_changed(const struct plan *plan, const struct plan_marks *marks, const struct product *product)
{
    struct stat made;
    int there = is_there(plan, "", product->of.name, &made);
    if (there <= 0 || !*product->command)
        return there < 0 ? -1 : 0;
    int cut_off = is_there(plan, ".running", product->of.name, NULL);
    if (cut_off || marks->part_changed[product->stage])
        return cut_off < 0 ? -1 : 1;
    char *part = inside(plan, ".scene", PLAN_STAGE[product->stage]);
    char *program = NULL;
    if (!part || asprintf(&program, "%s/%s", plan->programs, PLAN_STAGE[product->stage]) < 0) {
        free(part);
        return error_memory("plan");
    }
    int changed = is_newer(part, &made) || is_newer(program, &made);
    free(part);
    free(program);
    for (size_t k = 0; k < product->read_count && !changed; k++)
        changed = is_newer(product->reads[k], &made);
    return !changed && product->of.kind == RESULT_TABLE ? lacks_forces(plan) : changed;
}

/* ---- before a run ---- */

/* Gone, or never there. */
static int remove_file(const struct plan *plan, const char *folder, const char *name)
{
    char *path = inside(plan, folder, name);
    int failed = !path || (unlink(path) && errno != ENOENT);
    if (failed && path)
        error_set(EXIT_FAILED, "%s: %s: make the folder writable", path, strerror(errno));
    free(path);
    return failed ? -1 : 0;
}

static int remove_remains(const struct plan *plan)
{
    for (size_t k = 0; k < plan->count; k++) {
        const char *name = plan_name(plan, k).name;
        int cut_off = is_there(plan, ".running", name, NULL);
        if (cut_off < 0 || (cut_off && (remove_file(plan, "", name) || remove_file(plan, ".running", name))) ||
            remove_file(plan, ".failed", name))
            return -1;
    }
    int lost = plan->together ? lacks_forces(plan) : 1;
    return lost > 0 ? remove_file(plan, "", "series.csv") : lost;
}

/* Writes OUT/name unless it says just that: its time tells when it changed. */
static int keep(const struct plan *plan, const char *name, const char *text)
{
    struct new_file file = {0};
    struct stat info;
    char *path = inside(plan, "", name);
    int failed = !path;
    if (path && !lstat(path, &info) && S_ISLNK(info.st_mode))
        failed = error_failed("%s: is a symbolic link: remove it, nothing is written through links", path);
    if (!failed && !says(path, text) && !(failed = new_file_begin(&file, path))) {
        FILE *stream = fopen(file.temporary, "w");
        failed = !stream || fputs(text, stream) < 0;
        if ((stream && fclose(stream)) || failed) {
            failed = error_failed("%s: %s: is the disk full?", path, strerror(errno));
            new_file_discard(&file);
        } else
            failed = new_file_commit(&file);
    }
    free(path);
    return failed ? -1 : 0;
}

/* The names of some results, one a line; to be freed. */
static char *list_of(const struct plan *plan, unsigned kinds)
{
    char *text = NULL;
    size_t size;
    FILE *stream = open_memstream(&text, &size);
    for (size_t k = 0; stream && k < plan->count; k++) {
        struct plan_name name = plan_name(plan, k);
        if (kinds >> name.kind & 1)
            fprintf(stream, "%s\n", name.name);
    }
    if (!stream || fclose(stream)) {
        error_set(EXIT_FAILED, "out of memory: plan: use a machine with more memory");
        free(text);
        return NULL;
    }
    return text;
}

static int keep_list(const struct plan *plan, const char *name, unsigned kinds)
{
    char *text = list_of(plan, kinds);
    int failed = !text || keep(plan, name, text);
    free(text);
    return failed ? -1 : 0;
}

int plan_begin(const struct plan *plan)
{
    char *folder = inside(plan, "", ".scene");
    int failed = !folder || (mkdir(folder, 0777) && errno != EEXIST);
    if (failed && folder)
        error_set(EXIT_FAILED, "%s: %s: name a folder that can be written", folder, strerror(errno));
    free(folder);
    failed = failed || remove_remains(plan);
    for (int stage = 0; stage < PLAN_STAGES && !failed; stage++) {
        char name[40];
        snprintf(name, sizeof name, ".scene/%s", PLAN_STAGE[stage]);
        failed = keep(plan, name, plan->part[stage]);
    }
    enum { STATES = 1 << RESULT_GRAINS | 1 << RESULT_TRACKS | 1 << RESULT_CONTACTS | 1 << RESULT_FORCES };
    return failed || keep_list(plan, PLAN_PAGE_LIST, STATES) ||
                   keep_list(plan, PLAN_CONTACTS_LIST, 1 << RESULT_CONTACTS)
               ? -1
               : 0;
}
