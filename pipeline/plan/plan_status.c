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

/* A failure comes first: an older file may still be there. A flag is believed only of a file that is there. */
static int outcome_of(const struct plan *plan, const char *name)
{
    return plan_holds(plan, ".failed/", name)    ? FAILED
           : plan_holds(plan, ".running/", name) ? BEGUN
           : !plan_holds(plan, "", name)         ? MISSING
           : plan_holds(plan, ".flagged/", name) ? FLAGGED
                                                 : DONE;
}

void plan_print_results(const struct plan *plan, FILE *stream)
{
    for (size_t k = 0; k < plan->count; k++) {
        struct plan_name of = plan_name(plan, k);
        fprintf(stream, "%s\t%s\t%s\n", of.name, outcome_words[outcome_of(plan, of.name)],
                plan_holds(plan, "", of.name) ? "there" : "absent");
    }
}

/* What the stages of that outcome said, line by line, fit for a terminal. */
static void print_marks(const struct plan *plan, const unsigned char *words, int outcome, FILE *stream)
{
    char path[64], *line = NULL;
    size_t room = 0;
    for (size_t k = 0; k < plan->count; k++) {
        if (words[k] != outcome)
            continue;
        snprintf(path, sizeof path, ".%s/%s", outcome_words[outcome], plan_name(plan, k).name);
        int mark = openat(plan->folder, path, O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC);
        FILE *file = mark >= 0 ? fdopen(mark, "r") : NULL;
        for (ssize_t got; file && (got = getline(&line, &room, file)) > 0;) {
            line[got - (line[got - 1] == '\n')] = '\0';
            text_print(stream, line);
            fputc('\n', stream);
        }
        if (file)
            fclose(file);
    }
    free(line);
}

/* Does somebody hold the lock of the folder? */
static int is_busy(const struct plan *plan)
{
    int lock = openat(plan->folder, ".lock", O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC);
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

/* The order of the words is that of plan_name(): grains, tracks, contacts, series.csv, forces, pictures, page. */
static void print_table(const struct plan *plan, const unsigned char *words, FILE *stream)
{
    static const char line[] = "%-8s %-8s %-8s %-9s %-8s %s\n";
    const struct scene_photos *photos = &plan->scene->photos;
    size_t n = (size_t)plan->photos, forces = 1 + 2 * n + (plan->together != 0);
    fprintf(stream, line, "photo", "grains", "tracks", "contacts", "forces", "picture");
    for (size_t k = 0; k < n; k++) {
        char photo[24];
        int reference = plan->number[k] == photos->reference;
        snprintf(photo, sizeof photo, "%04ld", plan->number[k]);
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
        words[k] = (unsigned char)outcome_of(plan, plan_name(plan, k).name);
        count[words[k]]++;
    }
    if (is_busy(plan))
        fputs("a run works here now\n", stream);
    print_table(plan, words, stream);
    fprintf(stream, "%zu done, %zu flagged, %zu failed, %zu begun, %zu missing\n", count[DONE], count[FLAGGED],
            count[FAILED], count[BEGUN], count[MISSING]);
    print_marks(plan, words, FAILED, stream);
    print_marks(plan, words, FLAGGED, stream);
    free(words);
    return 0;
}
