/* Reading state files, which may come from anywhere: every object is reached by hard links inside the file only, its
 * type, rank and length are checked before memory is allocated for it, and a dataset whose bytes were never all
 * written (a full disk) is refused, because HDF5 would fill the holes with zeros in silence. */
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "pipeline/error.h"
#include "pipeline/state_hdf.h"

struct state {
    char *path;
    hid_t hdf;
};

enum { LONGEST_TEXT = 16 << 20 };

/* ---- finding objects ---- */

static int damaged(const struct state *state, const char *name)
{
    return error_input("%s: damaged at '%s': make the file again", state->path, name);
}

/* 1: there, by a hard link; 0: absent; -1: a link that leads elsewhere, or damage: what cannot be looked up is not
 * absent. */
static int look(const struct state *state, hid_t parent, const char *name)
{
    H5L_info_t link;
    htri_t exists = H5Lexists(parent, name, H5P_DEFAULT);
    if (exists == 0)
        return 0;
    if (exists < 0 || H5Lget_info(parent, name, &link, H5P_DEFAULT) < 0)
        return damaged(state, name);
    if (link.type != H5L_TYPE_HARD)
        return error_input("%s: '%s' is a soft or external link: put the data into the file itself", state->path, name);
    return 1;
}

/* Walk down a path of groups. 1: *group is open; 0: absent; -1: error. */
static int find_group(const struct state *state, const char *path, hid_t *group)
{
    char *parts = strdup(path), *rest = NULL;
    int found = 1;
    if (!parts)
        return error_memory(path);
    *group = H5Gopen2(state->hdf, "/", H5P_DEFAULT);
    for (char *part = strtok_r(parts, "/", &rest); part && *group >= 0; part = strtok_r(NULL, "/", &rest)) {
        found = look(state, *group, part);
        hid_t next = found == 1 ? H5Gopen2(*group, part, H5P_DEFAULT) : -1;
        H5Gclose(*group);
        *group = next;
        if (found != 1)
            break;
    }
    free(parts);
    if (found == 1 && *group < 0)
        return error_input("%s: '%s' is not a readable group: make the file again", state->path, path);
    return found;
}

/* Something that a reader needs is not there: say which program wrote the file. */
static int lacks(const struct state *state, const char *kind, const char *group, const char *name)
{
    char stage[32] = "";
    if (state_read_text(state, "/", "stage", stage, sizeof stage) || !stage[0])
        return error_input("%s: has no %s /%s%s: give a file of the right stage", state->path, kind, group, name);
    return error_input("%s: has no %s /%s%s, it was written by %s: give a file of the right stage", state->path, kind,
                       group, name, stage);
}

/* find_group() where the group must be there. */
static hid_t open_group(const struct state *state, const char *path)
{
    hid_t group = -1;
    int found = find_group(state, path, &group);
    if (found == 0)
        return lacks(state, "group", path, "");
    return found == 1 ? group : -1;
}

int state_has(const struct state *state, const char *path)
{
    hid_t group = -1;
    int found = find_group(state, path, &group);
    if (found == 1)
        H5Gclose(group);
    return found;
}

struct names {
    char **list;
    size_t count, capacity;
};

static herr_t collect_name(hid_t group, const char *name, const H5L_info_t *link, void *data)
{
    (void)group;
    struct names *names = data;
    if (link->type != H5L_TYPE_HARD)
        return 0;
    if (names->count == names->capacity) {
        size_t capacity = names->capacity ? 2 * names->capacity : 16;
        char **list = realloc(names->list, capacity * sizeof *list);
        if (!list)
            return -1;
        names->list = list;
        names->capacity = capacity;
    }
    names->list[names->count] = strdup(name);
    return names->list[names->count++] ? 0 : -1;
}

/* Keep only groups and pack the strings behind the pointers into one block. */
static char **pack_groups(hid_t group, const struct names *names, size_t *count)
{
    size_t bytes = sizeof(char *);
    for (size_t k = 0; k < names->count; k++)
        bytes += sizeof(char *) + strlen(names->list[k]) + 1;
    char **packed = malloc(bytes);
    if (!packed)
        return NULL;
    char *text = (char *)(packed + names->count + 1);
    *count = 0;
    for (size_t k = 0; k < names->count; k++) {
        hid_t child = H5Oopen(group, names->list[k], H5P_DEFAULT);
        H5I_type_t type = child >= 0 ? H5Iget_type(child) : H5I_BADID;
        if (child >= 0)
            H5Oclose(child);
        if (type == H5I_BADID) {
            free(packed);
            return NULL;
        }
        if (type != H5I_GROUP)
            continue;
        packed[(*count)++] = text;
        text = stpcpy(text, names->list[k]) + 1;
    }
    packed[*count] = NULL;
    return packed;
}

int state_list(const struct state *state, const char *path, char ***list, size_t *count)
{
    struct names names = {0};
    hid_t group = -1;
    *list = NULL;
    *count = 0;
    int found = find_group(state, path, &group);
    if (found < 0)
        return -1;
    if (found == 1) {
        if (H5Literate(group, H5_INDEX_NAME, H5_ITER_INC, NULL, collect_name, &names) >= 0)
            *list = pack_groups(group, &names, count);
        H5Gclose(group);
    } else {
        *list = calloc(1, sizeof **list);
    }
    for (size_t k = 0; k < names.count; k++)
        free(names.list[k]);
    free(names.list);
    return *list ? 0 : error_failed("%s: the groups in '%s' cannot be listed: make the file again", state->path, path);
}

/* ---- columns ---- */

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

static const char *type_name(enum column_type type)
{
    static const char *const names[] = {[COLUMN_DOUBLE] = "float64",
                                        [COLUMN_INT64] = "int64",
                                        [COLUMN_UINT32] = "uint32",
                                        [COLUMN_NAME] = "fixed-length strings of at most 16 bytes"};
    return names[type];
}

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

/* Were all the bytes of a one-dimensional dataset written? Chunks may carry filters, so count them. */
static int is_written(hid_t dataset, hid_t properties, hsize_t rows)
{
    hsize_t chunk_rows = 0, chunks = 0;
    H5D_space_status_t status;
    if (rows == 0)
        return 1;
    if (H5Pget_layout(properties) != H5D_CHUNKED)
        return H5Dget_space_status(dataset, &status) >= 0 && status == H5D_SPACE_STATUS_ALLOCATED;
    hid_t space = H5Dget_space(dataset);
    int counted = space >= 0 && H5Pget_chunk(properties, 1, &chunk_rows) == 1 && chunk_rows > 0 &&
                  H5Dget_num_chunks(dataset, space, &chunks) >= 0;
    if (space >= 0)
        H5Sclose(space);
    return counted && chunks == (rows - 1) / chunk_rows + 1;
}

/* Data inside this file, all of it written. */
static int check_storage(const struct state *state, hid_t dataset, const char *group, const char *name, hsize_t rows)
{
    hid_t properties = H5Dget_create_plist(dataset);
    H5D_layout_t layout = properties >= 0 ? H5Pget_layout(properties) : H5D_LAYOUT_ERROR;
    int inside = layout == H5D_COMPACT || layout == H5D_CHUNKED ||
                 (layout == H5D_CONTIGUOUS && H5Pget_external_count(properties) == 0);
    int written = inside && is_written(dataset, properties, rows);
    if (properties >= 0)
        H5Pclose(properties);
    if (!inside)
        return error_input("%s: column /%s/%s is stored outside the file: put the data into the file", state->path,
                           group, name);
    if (!written)
        return error_input("%s: column /%s/%s was never written completely: make the file again", state->path, group,
                           name);
    return 0;
}

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
    int found = look(state, place, column->name);
    if (found != 1)
        return found;
    hid_t dataset = H5Dopen2(place, column->name, H5P_DEFAULT);
    if (dataset < 0)
        return error_input("%s: /%s/%s is not a readable column: make the file again", state->path, group,
                           column->name);
    int failed = check_type(state, dataset, group, column) ||
                 check_length(state, dataset, group, column->name, &length) ||
                 check_storage(state, dataset, group, column->name, length);
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
    hid_t place = open_group(state, group);
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
            result = lacks(state, "column", group, name);
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

/* ---- attributes ---- */

/* 1: open; 0: no such attribute; -1: error. */
static int open_attribute(const struct state *state, const char *group, const char *name, hid_t *attribute)
{
    hid_t place = -1;
    int found = find_group(state, group, &place);
    if (found != 1)
        return found;
    htri_t exists = H5Aexists(place, name);
    if (exists > 0)
        *attribute = H5Aopen(place, name, H5P_DEFAULT);
    if (exists < 0 || (exists > 0 && *attribute < 0))
        found = error_input("%s: attribute '%s' is damaged: make the file again", state->path, name);
    else
        found = exists > 0;
    H5Gclose(place);
    return found;
}

static hssize_t attribute_count(hid_t attribute)
{
    hid_t space = H5Aget_space(attribute);
    if (space < 0)
        return -1;
    hssize_t count = H5Sget_simple_extent_npoints(space);
    H5Sclose(space);
    return count;
}

static char *read_variable_text(hid_t attribute, hid_t type)
{
    char *value = NULL, *text = NULL;
    hid_t memory_type = state_string_type(H5T_VARIABLE, H5Tget_cset(type) == H5T_CSET_UTF8);
    if (memory_type >= 0 && H5Aread(attribute, memory_type, &value) >= 0 && value) {
        text = strdup(value);
        H5free_memory(value);
    }
    if (memory_type >= 0)
        H5Tclose(memory_type);
    return text;
}

static char *read_fixed_text(hid_t attribute, hid_t type)
{
    size_t size = H5Tget_size(type);
    if (size == 0 || size > LONGEST_TEXT)
        return NULL;
    char *text = calloc(size + 1, 1);
    hid_t memory_type = state_string_type(size + 1, H5Tget_cset(type) == H5T_CSET_UTF8);
    if (text && (memory_type < 0 || H5Aread(attribute, memory_type, text) < 0)) {
        free(text);
        text = NULL;
    }
    if (memory_type >= 0)
        H5Tclose(memory_type);
    return text;
}

/* 0: *text is to be freed; 1: no such attribute; -1: error. */
static int read_any_text(const struct state *state, const char *group, const char *name, char **text)
{
    hid_t attribute = -1;
    int found = open_attribute(state, group, name, &attribute);
    if (found != 1)
        return found < 0 ? -1 : 1;
    hid_t type = H5Aget_type(attribute);
    *text = NULL;
    errno = 0;
    if (type >= 0 && H5Tget_class(type) == H5T_STRING && attribute_count(attribute) == 1)
        *text = H5Tis_variable_str(type) > 0 ? read_variable_text(attribute, type) : read_fixed_text(attribute, type);
    if (type >= 0)
        H5Tclose(type);
    H5Aclose(attribute);
    if (!*text && errno == ENOMEM)
        return error_memory(state->path);
    return *text ? 0 : error_input("%s: attribute '%s' is not one text: make the file again", state->path, name);
}

int state_read_text(const struct state *state, const char *group, const char *attribute, char *text, size_t size)
{
    char *whole = NULL;
    int status = read_any_text(state, group, attribute, &whole);
    if (status)
        return status;
    size_t length = strlen(whole);
    if (length < size)
        memcpy(text, whole, length + 1);
    free(whole);
    if (length >= size)
        return error_input("%s: attribute '%s' is longer than %zu bytes: make the file again", state->path, attribute,
                           size - 1);
    return 0;
}

/* Numbers of any real or integer type of at most 8 bytes. */
static int read_any_numbers(const struct state *state, const char *group, const char *name, H5T_class_t other,
                            hid_t memory_type, size_t count, void *values)
{
    hid_t attribute = -1;
    int found = open_attribute(state, group, name, &attribute);
    if (found != 1)
        return found < 0 ? -1 : 1;
    hid_t type = H5Aget_type(attribute);
    H5T_class_t class = type >= 0 ? H5Tget_class(type) : H5T_NO_CLASS;
    int failed = (class != H5T_INTEGER && class != other) || attribute_count(attribute) != (hssize_t)count ||
                 H5Aread(attribute, memory_type, values) < 0;
    if (type >= 0)
        H5Tclose(type);
    H5Aclose(attribute);
    if (failed)
        return error_input("%s: attribute '%s' is not %zu number(s) of the right type: make the file again",
                           state->path, name, count);
    return 0;
}

int state_read_numbers(const struct state *state, const char *group, const char *attribute, double *values,
                       size_t count)
{
    return read_any_numbers(state, group, attribute, H5T_FLOAT, H5T_NATIVE_DOUBLE, count, values);
}

static int read_integer(const struct state *state, const char *attribute, int64_t *value)
{
    return read_any_numbers(state, "/", attribute, H5T_INTEGER, H5T_NATIVE_INT64, 1, value);
}

/* ---- the file ---- */

static int check_schema(const struct state *state)
{
    char schema[32] = "";
    int64_t version = 0;
    if (state_read_text(state, "/", "schema", schema, sizeof schema) < 0)
        return -1;
    if (strcmp(schema, STATE_SCHEMA))
        return error_input("%s: is not a state file (its schema is '%s'): give a .hdf file of this program",
                           state->path, schema);
    int status = read_integer(state, "schema_version", &version);
    if (status < 0)
        return -1;
    if (status == 1 || version < 1)
        return error_input("%s: has no schema_version: make the file again", state->path);
    if (version > STATE_SCHEMA_VERSION)
        return error_input("%s: schema_version %lld is newer than this program knows (%d): use a newer program",
                           state->path, (long long)version, STATE_SCHEMA_VERSION);
    return 0;
}

static hid_t open_hdf(const char *path)
{
    struct stat status;
    if (access(path, R_OK) || stat(path, &status))
        return error_input("%s: cannot be opened: check the path", path);
    if (!S_ISREG(status.st_mode))
        return error_input("%s: is not a file: name a state file (.hdf)", path);
    H5Eset_auto2(H5E_DEFAULT, NULL, NULL);
    H5PLset_loading_state(0); /* no foreign code for foreign filters */
    hid_t access = H5Pcreate(H5P_FILE_ACCESS), hdf = -1;
    if (access >= 0 && H5Pset_fclose_degree(access, H5F_CLOSE_STRONG) >= 0)
        hdf = H5Fopen(path, H5F_ACC_RDONLY, access);
    if (access >= 0)
        H5Pclose(access);
    if (hdf < 0)
        (void)error_input("%s: is not a whole HDF5 file: name a state file (.hdf), or make it again", path);
    return hdf;
}

struct state *state_open(const char *path)
{
    struct state *state = calloc(1, sizeof *state);
    if (!state || !(state->path = strdup(path))) {
        free(state);
        (void)error_memory(path);
        return NULL;
    }
    state->hdf = open_hdf(path);
    if (state->hdf < 0 || check_schema(state)) {
        state_close(state);
        return NULL;
    }
    return state;
}

void state_close(struct state *state)
{
    if (!state)
        return;
    if (state->hdf >= 0)
        H5Fclose(state->hdf);
    free(state->path);
    free(state);
}

void state_info_free(struct state_info *info)
{
    free(info->parameters);
    free(info->inputs);
    memset(info, 0, sizeof *info);
}

int state_read_info(const struct state *state, struct state_info *info)
{
    memset(info, 0, sizeof *info);
    info->index = -1;
    info->time_s = info->length_m = info->strain[0] = info->strain[1] = info->strain[2] = NAN;
    if (state_read_text(state, "/", "stage", info->stage, sizeof info->stage) < 0 ||
        state_read_text(state, "/", "coordinates", info->coordinates, sizeof info->coordinates) < 0 ||
        state_read_text(state, "/", "program_version", info->program_version, sizeof info->program_version) < 0 ||
        read_any_text(state, "/", "parameters", &info->parameters) < 0 ||
        read_any_text(state, "/", "inputs", &info->inputs) < 0 || read_integer(state, "index", &info->index) < 0 ||
        state_read_numbers(state, "/", "time_s", &info->time_s, 1) < 0 ||
        state_read_numbers(state, "/", "strain", info->strain, 3) < 0 ||
        state_read_numbers(state, "/", "length_m", &info->length_m, 1) < 0) {
        state_info_free(info);
        return -1;
    }
    return 0;
}
