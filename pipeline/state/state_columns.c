/* Reading the columns of a state file: type, rank, length and storage are checked before memory is allocated; a dataset
 * whose bytes were never all written (a full disk) is refused, because HDF5 would fill the holes with zeros in silence.
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "pipeline/speak/error.h"
#include "pipeline/state/state_hdf.h"
#include "pipeline/state/state_open.h"
#include "pipeline/state/state_storage.h"

/* Exactly the type that the format tells: a float column or a signed one would be converted without a word, and lose
 * digits or flags. */
static int type_fits(hid_t type, enum column_type wanted)
{
    H5T_class_t class = H5Tget_class(type);
    size_t size = H5Tget_size(type);
    switch (wanted) {
    case COLUMN_DOUBLE:
        return class == H5T_FLOAT && size == 8;
    case COLUMN_INT64:
        return class == H5T_INTEGER && size == 8 && H5Tget_sign(type) == H5T_SGN_2;
    case COLUMN_UINT32:
        return class == H5T_INTEGER && size == 4 && H5Tget_sign(type) == H5T_SGN_NONE;
    case COLUMN_NAME:
        return class == H5T_STRING && H5Tis_variable_str(type) == 0 && size <= NAME_LENGTH;
    }
    return 0;
}

/* As h5py and NumPy call it. */
static const char *type_name(enum column_type type)
{
    static const char *const names[] = {[COLUMN_DOUBLE] = "float64",
                                        [COLUMN_INT64] = "int64",
                                        [COLUMN_UINT32] = "uint32",
                                        [COLUMN_NAME] = "fixed-length strings of at most 16 bytes"};
    return names[type];
}

/* 0, or -1 with an error that names file, column and the type wanted. */
static int check_type(const struct state *state, hid_t dataset, const char *group, const struct column *column)
{
    hid_t type = H5Dget_type(dataset);
    int fits = type >= 0 && type_fits(type, column->type);
    if (type >= 0)
        H5Tclose(type);
    if (!fits)
        return error_input("%s: column /%s/%s is not %s: write it with that type", state->path, group, column->name,
                           type_name(column->type));
    return 0;
}

/* Numbers in other units than the schema's are off by powers of ten, and plausible. Absent units are the schema's. */
static int check_units(const struct state *state, hid_t dataset, const char *group, const struct column *column)
{
    char *units = NULL;
    int status = state_dataset_text(state, dataset, "units", &units);
    if (status == 0 && *units && strcmp(units, column->units))
        status = error_input("%s: column /%s/%s is in '%s', not in '%s': convert it", state->path, group, column->name,
                             units, column->units);
    free(units);
    return status < 0 ? -1 : 0;
}

/* One dimension and at most STATE_MAX_ROWS rows, before memory is asked for. *rows: what the file says. */
static int check_length(const struct state *state, hid_t dataset, const char *group, const char *name, hsize_t *rows)
{
    hid_t space = H5Dget_space(dataset);
    int one = space >= 0 && H5Sis_simple(space) > 0 && H5Sget_simple_extent_ndims(space) == 1 &&
              H5Sget_simple_extent_dims(space, rows, NULL) == 1;
    if (space >= 0)
        H5Sclose(space);
    if (!one)
        return error_input("%s: column /%s/%s is not one-dimensional: write one value per row", state->path, group,
                           name);
    if (*rows > STATE_MAX_ROWS)
        return error_input("%s: column /%s/%s claims %llu rows: the file is damaged, make it again", state->path, group,
                           name, (unsigned long long)*rows);
    return 0;
}

/* The column into new memory, to *array, which the table then owns. HDF5 verifies its checksum on the way. */
static int read_values(const struct state *state, hid_t dataset, const char *group, const struct column *column,
                       hsize_t rows, void **array)
{
    *array = calloc(rows ? rows : 1, column_size(column->type));
    if (!*array)
        return error_memory(column->name);
    if (rows == 0)
        return 0;
    hid_t type = state_memory_type(column->type);
    int failed = type < 0 || H5Dread(dataset, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, *array) < 0;
    if (type >= 0)
        H5Tclose(type);
    if (failed)
        return error_input("%s: column /%s/%s is damaged (its checksum or its bytes are wrong): make the file again",
                           state->path, group, column->name);
    return 0;
}

/* 1: read; 0: absent; -1: error. *rows is set by the first column of a table and must hold for the others. */
static int read_column(const struct state *state, hid_t place, const char *group, const struct column *column,
                       int is_first, size_t *rows, void **array)
{
    hsize_t length = 0;
    int found = state_look(state, place, column->name);
    if (found != 1)
        return found;
    hid_t dataset = H5Dopen2(place, column->name, H5P_DEFAULT);
    if (dataset < 0)
        return error_input("%s: /%s/%s is not a readable column: make the file again", state->path, group,
                           column->name);
    int failed = check_type(state, dataset, group, column) || check_units(state, dataset, group, column) ||
                 check_length(state, dataset, group, column->name, &length) ||
                 state_check_storage(state, dataset, group, column->name, length);
    if (!failed && !is_first && length != *rows)
        failed = error_input("%s: column /%s/%s has %llu rows, others have %zu: make the file again", state->path,
                             group, column->name, (unsigned long long)length, *rows);
    if (!failed)
        failed = read_values(state, dataset, group, column, length, array);
    H5Dclose(dataset);
    if (failed)
        return -1;
    *rows = (size_t)length;
    return 1;
}

/* required NULL: nothing is. */
static int is_required(const char *const required[], const char *name)
{
    for (; required && *required; required++)
        if (!strcmp(*required, name))
            return 1;
    return 0;
}

int state_read(const struct state *state, const char *group, const struct table_kind *kind,
               const char *const required[], void *table)
{
    static const char *const none[] = {NULL};
    size_t rows = 0;
    int first = 1, result = 0;
    table_alloc(kind, table, 0, none);
    hid_t place = state_open_group(state, group);
    if (place < 0)
        return -1;
    for (size_t c = 0; c < kind->column_count && result == 0; c++) {
        const struct column *column = &kind->columns[c];
        int found = read_column(state, place, group, column, first, &rows, table_array(column, table));
        if (found < 0)
            result = -1;
        else if (found == 0 && is_required(required, column->name)) {
            char name[80];
            snprintf(name, sizeof name, "/%.70s", column->name);
            result = state_lacks(state, "column", group, name);
        }
        if (found == 1)
            first = 0;
    }
    H5Gclose(place);
    *(size_t *)((char *)table + kind->count_offset) = rows;
    if (result)
        table_free(kind, table);
    return result;
}
