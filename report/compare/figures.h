/* A list of named numbers: what compare finds, printed as a table or written as JSON. */
#ifndef REPORT_FIGURES_H
#define REPORT_FIGURES_H

#include <stdio.h>

struct figure {
    char name[40];    /* key in JSON: lower case, units at its end */
    const char *text; /* for people */
    const char *units;
    double value;
};

struct figures {
    struct figure list[96];
    size_t count;
    int overflow; /* a figure found no room: printing and writing are errors */
};

/* A figure for which the list has no room is noted in `overflow`. */
void figures_add(struct figures *figures, const char *name, double value, const char *units, const char *text);
/* The value of that name; NaN when there is none. */
double figures_value(const struct figures *figures, const char *name);
/* For people: three digits, units in which the number can be read (um, kPa). JSON has all digits, in SI units and px.
 * 0, or -1 when figures are missing. */
int figures_print(const struct figures *figures, FILE *stream);
/* One flat JSON object; a value that is not finite becomes null. Atomically. 0, or -1. */
int figures_write_json(const struct figures *figures, const char *path);

#endif
