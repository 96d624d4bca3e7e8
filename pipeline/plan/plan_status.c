/* What became of each result, for people and for the drivers. */
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <unistd.h>

#include "pipeline/plan/plan_marks.h"
#include "pipeline/speak/error.h"
#include "pipeline/speak/text.h"

enum { DONE, FLAGGED, FAILED, BEGUN, MISSING, OUTCOMES };
static const char *const outcome_words[] = {"done", "flagged", "failed", "begun", "missing"};

struct outcome {
    int word, there;
};

/* Is OUT/folder/name there? Names that are too long for a path are not. */
static int exists(const struct plan *plan, const char *folder, const char *name)
{
    char path[4096];
    int length = snprintf(path, sizeof path, "%s/%s%s", plan->out, folder, name);
    return length < (int)sizeof path && !access(path, F_OK);
}

static struct outcome outcome_of(const struct plan *plan, const char *name)
{
    struct outcome outcome = {.there = exists(plan, "", name)};
    outcome.word = exists(plan, ".failed/", name)    ? FAILED
                   : exists(plan, ".running/", name) ? BEGUN
                   : !outcome.there                  ? MISSING
                   : exists(plan, ".flagged/", name) ? FLAGGED
                                                     : DONE;
    return outcome;
}

int plan_print_results(const struct plan *plan, FILE *stream)
{
    for (size_t k = 0; k < plan->count; k++) {
        struct plan_name name = plan_name(plan, k);
        struct outcome outcome = outcome_of(plan, name.name);
        fprintf(stream, "%s\t%s\t%s\n", name.name, outcome_words[outcome.word], outcome.there ? "there" : "absent");
    }
    return 0;
}

/* What a stage said, line by line, fit for a terminal. */
static void print_mark(const struct plan *plan, const char *folder, const char *name, FILE *stream)
{
    char path[4096], *line = NULL;
    size_t room = 0;
    int length = snprintf(path, sizeof path, "%s/%s/%s", plan->out, folder, name);
    FILE *file = length < (int)sizeof path ? fopen(path, "r") : NULL;
    for (ssize_t got; file && (got = getline(&line, &room, file)) > 0;) {
        line[got - (line[got - 1] == '\n')] = '\0';
        text_print(stream, line);
        fputc('\n', stream);
    }
    free(line);
    if (file)
        fclose(file);
}

/* Does somebody hold the lock of the folder? */
static int is_busy(const struct plan *plan)
{
    char path[4096];
    int length = snprintf(path, sizeof path, "%s/.lock", plan->out);
    int lock = length < (int)sizeof path ? open(path, O_RDONLY | O_NOFOLLOW | O_CLOEXEC) : -1;
    int busy = lock >= 0 && flock(lock, LOCK_EX | LOCK_NB) != 0;
    if (lock >= 0)
        close(lock);
    return busy;
}

/* Words of the results of one kind and photo, in the table's cells. */
static const char *cell(const unsigned char *words, size_t k)
{
    return words[k] == MISSING ? "-" : outcome_words[words[k]];
}

static void print_table(const struct plan *plan, const unsigned char *words, FILE *stream)
{
    static const char line[] = "%-8s %-8s %-8s %-9s %-8s %s\n";
    const struct scene_photos *photos = &plan->scene->photos;
    size_t n = (size_t)plan->photos, forces = 1 + 2 * n + (plan->together != 0);
    fprintf(stream, line, "photo", "grains", "tracks", "contacts", "forces", "picture");
    for (size_t k = 0; k < n; k++) {
        char photo[24];
        int reference = photos->first + (long)k == photos->reference;
        snprintf(photo, sizeof photo, "%04ld", photos->first + (long)k);
        fprintf(stream, line, photo, reference ? cell(words, 0) : "", cell(words, 1 + k), cell(words, 1 + n + k),
                cell(words, forces + k), cell(words, forces + n + k));
    }
    if (plan->together)
        fprintf(stream, "series   %s\n", cell(words, forces - 1));
    fprintf(stream, "report   %s\n", cell(words, plan->count - 1));
}

int plan_print_status(const struct plan *plan, FILE *stream)
{
    size_t count[OUTCOMES] = {0};
    unsigned char *words = malloc(plan->count);
    if (!words)
        return error_memory("table");
    for (size_t k = 0; k < plan->count; k++) {
        words[k] = (unsigned char)outcome_of(plan, plan_name(plan, k).name).word;
        count[words[k]]++;
    }
    if (is_busy(plan))
        fputs("a run works here now\n", stream);
    print_table(plan, words, stream);
    fprintf(stream, "%zu done, %zu flagged, %zu failed, %zu begun, %zu missing\n", count[DONE], count[FLAGGED],
            count[FAILED], count[BEGUN], count[MISSING]);
    for (size_t k = 0; k < plan->count; k++)
        if (words[k] == FAILED)
            print_mark(plan, ".failed", plan_name(plan, k).name, stream);
    for (size_t k = 0; k < plan->count; k++)
        if (words[k] == FLAGGED)
            print_mark(plan, ".flagged", plan_name(plan, k).name, stream);
    free(words);
    return 0;
}
