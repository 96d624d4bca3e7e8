/* State files (docs/files.md): HDF5, one group per table, one 1-D dataset per column with its unit and long name.
 * A file is whole or absent: it is written beside its target under a temporary name, every return code is checked,
 * then fsync and rename. Two identical runs give identical bytes. HDF5 is not called from parallel regions. */
#ifndef PIPELINE_STATE_H
#define PIPELINE_STATE_H

#include <math.h>

#include "pipeline/state/columns.h"

struct scene;

/* A number, or a few, of the state as a whole: an attribute of the group /state; the name ends with the unit. */
struct state_number {
    const char *name;
    const double *values; /* NaN: not known */
    size_t count;
};

/* Where the numbers of a file come from. All strings are borrowed by state_create(). */
struct provenance {
    const char *stage;         /* "findgrains" ... */
    const char *parameters;    /* JSON text of what changes numbers; no threads, no paths */
    const struct scene *scene; /* NULL: none was read. Its part for this stage and the files that the stage reads */
                               /* because the scene names them (lens, loads) are inputs, too */
    const char *const *input_paths; /* further files that were read; base name and SHA-256 go into the file */
    size_t input_count;
    int64_t index;                      /* of the photo in its series; -1: not known */
    double time_s;                      /* since the first photo; NaN: not known */
    const char *taken;                  /* photo.taken; NULL or "": not known */
    const char *coordinates;            /* photo side: "seen" or "corrected"; SI side: "si" */
    double strain[3];                   /* exx, eyy, gamma from the walls since the reference; NaN: not known */
    double length_m;                    /* of the rods; NaN: not known. Attribute length_m of the root */
    const struct state_number *numbers; /* /state; none: no such group */
    size_t number_count;
};
#define PROVENANCE_DEFAULT                                                                                             \
    {                                                                                                                  \
        .index = -1, .time_s = NAN, .strain = {NAN, NAN, NAN}, .length_m = NAN                                         \
    }

/* The same, as read from a file. Owned by the struct. */
struct state_info {
    char stage[NAME_LENGTH], coordinates[NAME_LENGTH], program_version[NAME_LENGTH];
    char *parameters, *inputs; /* JSON text */
    int64_t index;
    double time_s, strain[3], length_m;
    char taken[20];
};
void state_info_free(struct state_info *info); /* accepts a zeroed struct */
/* Error (EXIT_INPUT) when both indices are known and `previous` is not before `now`. */
int state_check_order(const char *previous_path, const struct state_info *previous, const struct state_info *now);

/* ---- writing ----
 * -1 or NULL with a line: the disk, memory (EXIT_FAILED), an input of the provenance that cannot be read. */
struct state_writer;
/* Begin a file with its provenance; state_commit() or state_discard() ends it and frees the writer. */
struct state_writer *state_create(const char *path, const struct provenance *provenance);
/* Write the columns that the table has into group (parents are made: "forces/qsm"). */
int state_write(struct state_writer *writer, const char *group, const struct table_kind *kind, const void *table);
int state_write_text(struct state_writer *writer, const char *group, const char *attribute, const char *text);
int state_write_numbers(struct state_writer *writer, const char *group, const char *attribute, const double *values,
                        size_t count);           /* count 1: a scalar attribute */
int state_commit(struct state_writer *writer);   /* close, fsync, rename; frees the writer whatever happens */
void state_discard(struct state_writer *writer); /* remove the temporary file; NULL is fine */

/* ---- reading ----
 * -1 or NULL with a line that names the file: missing, damaged, of another kind (EXIT_INPUT), or out of memory. Tables
 * are to be freed by table_free(). */
struct state;
struct state *state_open(const char *path); /* refuses other schemas, newer major versions, external links */
void state_close(struct state *state);      /* NULL is fine */
/* Into *info, to be freed by state_info_free(). */
int state_read_info(const struct state *state, struct state_info *info);
int state_has(const struct state *state, const char *group); /* 1, 0, or -1: damaged */
/* Read every known column that the group has; a column in `required` (NULL-terminated; NULL: none) that is missing,
 * and any wrong type, rank or length, is an error that names the file and the column. A table of 0 rows is fine. */
int state_read(const struct state *state, const char *group, const struct table_kind *kind,
               const char *const required[], void *table);
/* Names of the groups inside `group`, sorted; *names is one block to be freed with free(). */
int state_list(const struct state *state, const char *group, char ***names, size_t *count);
/* 0: read; 1: there is no such attribute (target untouched); -1: error. */
int state_read_text(const struct state *state, const char *group, const char *attribute, char *text, size_t size);
int state_read_numbers(const struct state *state, const char *group, const char *attribute, double *values,
                       size_t count);

#endif
