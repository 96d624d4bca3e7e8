/* The file: one line that says what the probes are of, then a line a probe. A row is found again by its two numbers bit
 * for bit, which %.17g keeps: a search that is started anew asks the same questions in the same order. */
#include "calibration/hertz/probe_record.h"

#include <errno.h>
#include <float.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "pipeline/command/cli.h"
#include "pipeline/speak/error.h"
#include "pipeline/files/json.h"

void probe_record_close(struct probe_record *record)
{
    free(record->path);
    free(record->rows);
    memset(record, 0, sizeof *record);
}

static int keep(struct probe_record *record, const struct probe_row *row)
{
    struct probe_row *rows = realloc(record->rows, (record->count + 1) * sizeof *rows);
    if (!rows)
        return error_memory("record of probes");
    record->rows = rows;
    rows[record->count++] = *row;
    return 0;
}

static int parse_row(const char *path, long number, const char *line, size_t length, struct probe_row *row)
{
    char name[512];
    long rested = 0;
    snprintf(name, sizeof name, "%s: line %ld", path, number);
    struct json *json = json_parse(line, length, name);
    const cJSON *root = json ? json_root(json) : NULL;
    int whole = root && json_number(json, root, "grain_young", DBL_MIN, DBL_MAX, &row->grain_young) == 1 &&
                json_number(json, root, "grain_poisson", 0, 0.5, &row->grain_poisson) == 1 &&
                json_number(json, root, "young", -DBL_MAX, DBL_MAX, &row->young) == 1 &&
                json_number(json, root, "poisson", -DBL_MAX, DBL_MAX, &row->poisson) == 1 &&
                json_number(json, root, "porosity", -DBL_MAX, 1, &row->porosity) == 1 &&
                json_number(json, root, "z", 0, DBL_MAX, &row->z) == 1 &&
                json_integer(json, root, "steps", 0, 1L << 53, &row->steps) == 1 &&
                json_integer(json, root, "rested", 0, 1, &rested) == 1;
    row->rested = (int)rested;
    json_free(json);
    return whole ? 0 : error_input("%s: not a row of a calibration's record: delete the file to begin anew", name);
}

/* Lines after the first; a last one without its end of line was being written when the program was stopped. */
static int read_rows(FILE *file, const char *what, struct probe_record *record, long *good)
{
    char *line = NULL;
    size_t size = 0;
    ssize_t length;
    int status = 0;
    *good = 0;
    for (long number = 1; !status && (length = getline(&line, &size, file)) > 0; number++) {
        if (line[length - 1] != '\n')
            break;
        line[--length] = 0;
        struct probe_row row;
        if (number == 1 && strcmp(line, what))
            status = error_input("%s: begun for another packing or another probe: give another file, or delete it",
                                 record->path);
        else if (number > 1 && !(status = parse_row(record->path, number, line, (size_t)length, &row)))
            status = keep(record, &row);
        *good = status ? *good : ftell(file);
    }
    if (!status && !feof(file)) /* a failing disk, or memory gone: nothing may be cut off */
        status = error_failed("%s: %s", record->path, strerror(errno));
    free(line);
    return status;
}

static int append(const char *path, const char *text)
{
    FILE *file = fopen(path, "a");
    if (!file)
        return error_failed("%s: %s", path, strerror(errno));
    int failed = fprintf(file, "%s\n", text) < 0;
    failed |= fclose(file) != 0;
    return failed ? error_failed("%s: %s: is the disk full?", path, strerror(errno)) : 0;
}

int probe_record_open(const char *path, const char *what, struct probe_record *record)
{
    long good = 0;
    memset(record, 0, sizeof *record);
    if (!path)
        return 0;
    record->path = strdup(path);
    if (!record->path)
        return error_memory("record of probes");
    FILE *file = fopen(path, "r+");
    int status = file ? read_rows(file, what, record, &good) : 0;
    if (!file && errno != ENOENT)
        status = error_failed("%s: %s", path, strerror(errno));
    if (file && !status && ftruncate(fileno(file), good))
        status = error_failed("%s: %s", path, strerror(errno));
    if (file)
        fclose(file);
    if (!status && !good)
        status = append(path, what);
    record->resumed = record->count;
    if (status)
        probe_record_close(record);
    return status;
}

const struct probe_row *probe_record_find(const struct probe_record *record, double grain_young, double grain_poisson)
{
    for (size_t k = 0; k < record->count; k++)
        if (record->rows[k].grain_young == grain_young && record->rows[k].grain_poisson == grain_poisson)
            return &record->rows[k];
    return NULL;
}

int probe_record_add(struct probe_record *record, const struct probe_row *row)
{
    char text[400];
    snprintf(text, sizeof text,
             "{\"grain_young\":%.17g,\"grain_poisson\":%.17g,\"young\":%.17g,\"poisson\":%.17g,\"porosity\":%.17g,"
             "\"z\":%.17g,\"steps\":%ld,\"rested\":%d}",
             row->grain_young, row->grain_poisson, row->young, row->poisson, row->porosity, row->z, row->steps,
             row->rested);
    if (record->path && append(record->path, text))
        return -1;
    return keep(record, row);
}

int probe_record_answer(struct probe_record *record, probe_function *probe_once, const void *probes,
                        struct hertz_trial *trials, size_t count)
{
    struct error_shared failures = ERROR_SHARED_NONE;
    struct probe_row rows[PROBES_AT_ONCE];
    int known[PROBES_AT_ONCE];
    if (count > PROBES_AT_ONCE)
        return error_input("%zu probes at once: at most %d", count, PROBES_AT_ONCE);
    for (size_t k = 0; k < count; k++) {
        const struct probe_row *row = probe_record_find(record, trials[k].grain_young, trials[k].grain_poisson);
        known[k] = row != NULL;
        if (row)
            rows[k] = *row;
    }
#pragma omp parallel for schedule(dynamic, 1)
    for (size_t k = 0; k < count; k++)
        if (!known[k] && probe_once(probes, &trials[k], k, &rows[k]))
            error_share(&failures, (long)k);
    if (error_collect(&failures))
        return -1;
    for (size_t k = 0; k < count; k++) {
        if (!known[k] && probe_record_add(record, &rows[k]))
            return -1;
        trials[k].young = rows[k].young;
        trials[k].poisson = rows[k].poisson;
        log_event("probe", "grain_young", rows[k].grain_young, "grain_poisson", rows[k].grain_poisson, "young",
                  rows[k].young, "poisson", rows[k].poisson, "steps", (double)rows[k].steps, NULL);
    }
    return 0;
}
