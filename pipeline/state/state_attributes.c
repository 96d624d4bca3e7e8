/* Reading the attributes of a state file: texts of fixed or variable length, numbers of any real or integer type. */
#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "pipeline/speak/error.h"
#include "pipeline/state/state_hdf.h"
#include "pipeline/state/state_open.h"
#include "pipeline/state/state_storage.h"

enum { LONGEST_TEXT = 16 << 20 };

/* Of a group or a dataset. 1: open; 0: no such attribute; -1: error. */
static int open_attribute_of(const struct state *state, hid_t place, const char *name, hid_t *attribute)
{
    htri_t exists = H5Aexists(place, name);
    if (exists > 0)
        *attribute = H5Aopen(place, name, H5P_DEFAULT);
    if (exists < 0 || (exists > 0 && *attribute < 0))
        return error_input("%s: attribute '%s' is damaged: make the file again", state->path, name);
    return exists > 0;
}

static int open_attribute(const struct state *state, const char *group, const char *name, hid_t *attribute)
{
    hid_t place = -1;
    int found = state_find_group(state, group, &place);
    if (found != 1)
        return found;
    found = open_attribute_of(state, place, name, attribute);
    H5Gclose(place);
    return found;
}

/* Number of elements; -1 when the file does not tell. */
static hssize_t attribute_count(hid_t attribute)
{
    hid_t space = H5Aget_space(attribute);
    if (space < 0)
        return -1;
    hssize_t count = H5Sget_simple_extent_npoints(space);
    H5Sclose(space);
    return count;
}

/* As h5py writes texts, for example. */
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

/* A text of fixed length, zero-terminated, to be freed; NULL: too long, unreadable, or no memory. */
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

/* Closes the attribute. */
static int take_text(const struct state *state, hid_t attribute, const char *name, char **text)
{
    hid_t type = H5Aget_type(attribute);
    *text = NULL;
    errno = 0;
    int variable = type >= 0 && H5Tis_variable_str(type) > 0, unsafe = variable && state_check_heaps(state);
    if (type >= 0 && H5Tget_class(type) == H5T_STRING && attribute_count(attribute) == 1 && !unsafe)
        *text = variable ? read_variable_text(attribute, type) : read_fixed_text(attribute, type);
    if (type >= 0)
        H5Tclose(type);
    H5Aclose(attribute);
    if (unsafe)
        return -1;
    if (!*text && errno == ENOMEM)
        return error_memory(state->path);
    return *text ? 0 : error_input("%s: attribute '%s' is not one text: make the file again", state->path, name);
}

int state_attribute_text(const struct state *state, const char *group, const char *name, char **text)
{
    hid_t attribute = -1;
    int found = open_attribute(state, group, name, &attribute);
    return found == 1 ? take_text(state, attribute, name, text) : found < 0 ? -1 : 1;
}

int state_dataset_text(const struct state *state, hid_t dataset, const char *name, char **text)
{
    hid_t attribute = -1;
    int found = open_attribute_of(state, dataset, name, &attribute);
    return found == 1 ? take_text(state, attribute, name, text) : found < 0 ? -1 : 1;
}

int state_read_text(const struct state *state, const char *group, const char *attribute, char *text, size_t size)
{
    char *whole = NULL;
    int status = state_attribute_text(state, group, attribute, &whole);
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

int state_attribute_integer(const struct state *state, const char *attribute, int64_t *value)
{
    return read_any_numbers(state, "/", attribute, H5T_INTEGER, H5T_NATIVE_INT64, 1, value);
}
