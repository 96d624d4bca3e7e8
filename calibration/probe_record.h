/* Every probe of a calibration, one JSON line each: a calibration that was interrupted goes on where it stopped. */
#ifndef CALIBRATION_PROBE_RECORD_H
#define CALIBRATION_PROBE_RECORD_H

#include <stddef.h>

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
void probe_record_close(struct probe_record *record);

#endif
