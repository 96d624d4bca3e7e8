/* A table is any struct with a row count and an array pointer per column; a list of struct column says at which
 * offset each lies. All that walks over columns (allocating, copying, reading, writing, exporting) does so through
 * that list, so that a new column is one line in it. */
#include "pipeline/state/columns.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "pipeline/speak/error.h"

size_t column_size(enum column_type type)
{
    switch (type) {
    case COLUMN_DOUBLE:
        return sizeof(double);
    case COLUMN_INT64:
        return sizeof(int64_t);
    case COLUMN_UINT32:
        return sizeof(uint32_t);
    case COLUMN_NAME:
        return NAME_LENGTH;
    }
    return 0;
}

void **table_array(const struct column *column, const void *table)
{
    return (void **)((char *)table + column->offset);
}

/* The struct's own member. */
static size_t *row_count(const struct table_kind *kind, const void *table)
{
    return (size_t *)((char *)table + kind->count_offset);
}

size_t table_rows(const struct table_kind *kind, const void *table)
{
    return *row_count(kind, table);
}

/* Whole numbers and names begin as zeros, doubles as NaN: a value that nobody sets is not known, and must not look
 * like 0. Never of zero bytes, as NULL stands for "no such column". -1 without memory. */
static int array_alloc(const struct column *column, void *table, size_t rows)
{
    void **array = table_array(column, table);
    *array = calloc(rows ? rows : 1, column_size(column->type));
    if (!*array)
        return error_failed("out of memory: %zu rows of column %s: use a machine with more memory", rows, column->name);
    if (column->type == COLUMN_DOUBLE)
        for (size_t k = 0; k < rows; k++)
            ((double *)*array)[k] = NAN;
    return 0;
}

/* names NULL: every column. */
static int is_listed(const char *name, const char *const names[])
{
    if (!names)
        return 1;
    for (; *names; names++)
        if (!strcmp(*names, name))
            return 1;
    return 0;
}

int table_alloc(const struct table_kind *kind, void *table, size_t rows, const char *const names[])
{
    for (size_t c = 0; c < kind->column_count; c++)
        *table_array(&kind->columns[c], table) = NULL;
    *row_count(kind, table) = rows;
    for (size_t c = 0; c < kind->column_count; c++)
        if (is_listed(kind->columns[c].name, names) && array_alloc(&kind->columns[c], table, rows)) {
            table_free(kind, table);
            return -1;
        }
    return 0;
}

int table_add(const struct table_kind *kind, void *table, const char *name)
{
    for (size_t c = 0; c < kind->column_count; c++)
        if (!strcmp(kind->columns[c].name, name))
            return *table_array(&kind->columns[c], table)
                       ? 0
                       : array_alloc(&kind->columns[c], table, table_rows(kind, table));
    return error_failed("no column is named '%s': report this as a defect", name);
}

void table_free(const struct table_kind *kind, void *table)
{
    for (size_t c = 0; c < kind->column_count; c++) {
        void **array = table_array(&kind->columns[c], table);
        free(*array);
        *array = NULL;
    }
    *row_count(kind, table) = 0;
}

int table_copy(const struct table_kind *kind, void *to, const void *from)
{
    size_t rows = table_rows(kind, from);
    for (size_t c = 0; c < kind->column_count; c++)
        *table_array(&kind->columns[c], to) = NULL;
    *row_count(kind, to) = rows;
    for (size_t c = 0; c < kind->column_count; c++) {
        const struct column *column = &kind->columns[c];
        if (!*table_array(column, from))
            continue;
        if (array_alloc(column, to, rows)) {
            table_free(kind, to);
            return -1;
        }
        if (rows)
            memcpy(*table_array(column, to), *table_array(column, from), rows * column_size(column->type));
    }
    return 0;
}
