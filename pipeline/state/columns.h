/* Tables in memory: a struct with a row count and one array per column, described once by a list of columns. The
 * same list allocates, frees, reads and writes the table, so a column's name, unit and meaning stand in one place.
 *
 *     struct grains { size_t count; double *x, *y; ... };
 *     const struct column GRAIN_COLUMNS[] = {COLUMN(struct grains, x, COLUMN_DOUBLE, "m", "centre, to the right"),
 * ...};
 *
 * An array that is NULL is a column that the table does not have. */
#ifndef PIPELINE_COLUMNS_H
#define PIPELINE_COLUMNS_H

#include <stddef.h>
#include <stdint.h>

enum column_type { COLUMN_DOUBLE, COLUMN_INT64, COLUMN_UINT32, COLUMN_NAME };

enum { NAME_LENGTH = 16 }; /* bytes of a COLUMN_NAME element: ASCII, padded with zeros, as in the file */

struct column {
    const char *name; /* in the file; also the member's name */
    enum column_type type;
    const char *units;     /* "m", "px", "rad", "1", ... */
    const char *long_name; /* one phrase for people */
    size_t offset;         /* of the array's pointer in the struct */
};

#define COLUMN(table, member, type, units, long_name)                                                                  \
    {                                                                                                                  \
#member, type, units, long_name, offsetof(table, member)                                                       \
    }

/* A list of columns and where the struct keeps its row count. */
struct table_kind {
    const struct column *columns;
    size_t column_count;
    size_t count_offset;
    const char *const *flag_names; /* bit -> name, 32 entries, NULL where unused; NULL: no flags column */
};

size_t column_size(enum column_type type); /* bytes of one element */

/* Allocate the named columns (NULL-terminated list; NULL: all) with `rows` rows. Doubles start as NaN, the rest 0.
 * A zeroed struct is an empty table. 0, or -1 with a line (out of memory): the table is left empty. */
int table_alloc(const struct table_kind *kind, void *table, size_t rows, const char *const names[]);
/* Add one column to a table that lacks it (no effect when it is there). 0, or -1 with a line. */
int table_add(const struct table_kind *kind, void *table, const char *name);
/* Free every column and empty the table; accepts a zeroed struct. */
void table_free(const struct table_kind *kind, void *table);
/* Deep copy of every column that `from` has into the empty table `to`. 0, or -1 with a line: out of memory. */
int table_copy(const struct table_kind *kind, void *to, const void *from);
size_t table_rows(const struct table_kind *kind, const void *table);
/* The address of a column's array pointer. */
void **table_array(const struct column *column, const void *table);

/* The value of an optional standard error: absent counts as 0 (exact). */
static inline double column_or_zero(const double *column, size_t row)
{
    return column ? column[row] : 0;
}

#endif
