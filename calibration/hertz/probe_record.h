/* Every probe of a calibration, one JSON line each: a calibration that was interrupted goes on where it stopped. */
#ifndef CALIBRATION_PROBE_RECORD_H
#define CALIBRATION_PROBE_RECORD_H

#include <stddef.h>

#include "calibration/hertz/hertz_search.h"

struct probe_row {
    double grain_young, grain_poisson; /* asked */
    double young, poisson;             /* answered */
    double porosity, z;
    long steps;
    int rested;
};

struct probe_record {
    char *path; /* NULL: kept in memory only */
    struct probe_row *rows;
    size_t count, resumed; /* rows; those that were there before */
};

/* `what` describes the packing and the probe (one line of JSON): a file that was begun for something else is refused. A
 * last line that was cut off is dropped. */
int probe_record_open(const char *path, const char *what, struct probe_record *record);
/* The row of exactly these parameters, or NULL. */
const struct probe_row *probe_record_find(const struct probe_record *record, double grain_young, double grain_poisson);
/* Add a row, to the file too. */
int probe_record_add(struct probe_record *record, const struct probe_row *row);

enum { PROBES_AT_ONCE = 8 };
/* One probe: asked by the trial, answered in the row. Number k of those that run together. */
typedef int probe_function(const void *probes, const struct hertz_trial *trial, size_t k, struct probe_row *row);
/* Answer up to PROBES_AT_ONCE trials: from the record where it has them, else by probes side by side, which are then
 * recorded in the order of the trials. */
int probe_record_answer(struct probe_record *record, probe_function *probe_once, const void *probes,
                        struct hertz_trial *trials, size_t count);
void probe_record_close(struct probe_record *record);

#endif
