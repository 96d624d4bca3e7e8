/* Writing state files. Every return code counts: on a full disk H5Dwrite and H5Dclose fail, after which H5Fclose may
 * well return 0. A checksum (Fletcher32) per chunk; no object times, so that equal runs give equal bytes. */
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cjson/cJSON.h>

#include "pipeline/speak/version.h"
#include "pipeline/speak/error.h"
#include "pipeline/scene/scene_part.h"
#include "pipeline/state/state_hdf.h"
#include "pipeline/speak/text.h"
#include "pipeline/files/read_record.h"
#include "pipeline/files/sha256.h"
#include "pipeline/files/json.h"

enum { CHUNK_ROWS = 65536 };

int state_write_failed(struct state_writer *writer, const char *what)
{
    writer->failed = 1;
    return error_failed("%s: %s cannot be written: check the room on the disk, then run again", writer->file.path,
                        what);
}

hid_t state_string_type(size_t size, int utf8)
{
    hid_t type = H5Tcopy(H5T_C_S1);
    if (type < 0)
        return -1;
    if (H5Tset_size(type, size) < 0 || H5Tset_strpad(type, H5T_STR_NULLPAD) < 0 ||
        H5Tset_cset(type, utf8 ? H5T_CSET_UTF8 : H5T_CSET_ASCII) < 0) {
        H5Tclose(type);
        return -1;
    }
    return type;
}

hid_t state_file_type(enum column_type type)
{
    switch (type) {
    case COLUMN_DOUBLE:
        return H5Tcopy(H5T_IEEE_F64LE);
    case COLUMN_INT64:
        return H5Tcopy(H5T_STD_I64LE);
    case COLUMN_UINT32:
        return H5Tcopy(H5T_STD_U32LE);
    case COLUMN_NAME:
        return state_string_type(NAME_LENGTH, 0);
    }
    return -1;
}

hid_t state_memory_type(enum column_type type)
{
    switch (type) {
    case COLUMN_DOUBLE:
        return H5Tcopy(H5T_NATIVE_DOUBLE);
    case COLUMN_INT64:
        return H5Tcopy(H5T_NATIVE_INT64);
    case COLUMN_UINT32:
        return H5Tcopy(H5T_NATIVE_UINT32);
    case COLUMN_NAME:
        return state_string_type(NAME_LENGTH, 0);
    }
    return -1;
}

/* ---- attributes ---- */

/* Replaces an attribute that is there. */
static int write_attribute(hid_t object, const char *name, hid_t file_type, hid_t memory_type, size_t count,
                           const void *values)
{
    int failed = 1;
    hsize_t dims = count;
    hid_t space = count == 1 ? H5Screate(H5S_SCALAR) : H5Screate_simple(1, &dims, NULL);
    if (H5Aexists(object, name) > 0)
        H5Adelete(object, name);
    hid_t attribute = H5Acreate2(object, name, file_type, space, H5P_DEFAULT, H5P_DEFAULT);
    if (attribute >= 0) {
        failed = H5Awrite(attribute, memory_type, values) < 0;
        failed |= H5Aclose(attribute) < 0;
    }
    if (space >= 0)
        H5Sclose(space);
    return failed ? -1 : 0;
}

/* Then the attribute is marked ASCII, which more readers take, else UTF-8. */
static int is_ascii(const char *text)
{
    for (; *text; text++)
        if ((unsigned char)*text > 127)
            return 0;
    return 1;
}

/* Of fixed length: texts of variable length are not safe to read (pipeline/state/state_storage.h). */
static int write_text(hid_t object, const char *name, const char *text)
{
    size_t length = strlen(text);
    hid_t type = state_string_type(length + !length, !is_ascii(text));
    if (type < 0)
        return -1;
    int failed = write_attribute(object, name, type, type, 1, text);
    H5Tclose(type);
    return failed;
}

/* 32 names of NAME_LENGTH bytes, bit 0 first, empty where a bit has no meaning. */
static int write_flag_names(hid_t object, const char *const flag_names[32])
{
    char names[32][NAME_LENGTH] = {{0}};
    for (int bit = 0; bit < 32; bit++)
        if (flag_names[bit])
            memcpy(names[bit], flag_names[bit], strnlen(flag_names[bit], NAME_LENGTH));
    hid_t type = state_string_type(NAME_LENGTH, 0);
    if (type < 0)
        return -1;
    int failed = write_attribute(object, "flag_names", type, type, 32, names);
    H5Tclose(type);
    return failed;
}

/* ---- groups and datasets ---- */

/* Properties that keep the clock out of the file: the same input gives the same bytes. To be closed; -1 on failure. */
static hid_t without_times(hid_t class)
{
    hid_t properties = H5Pcreate(class);
    if (properties >= 0 && H5Pset_obj_track_times(properties, 0) < 0) {
        H5Pclose(properties);
        return -1;
    }
    return properties;
}

/* To be closed; -1 on failure. */
static hid_t open_or_create_group(hid_t parent, const char *name)
{
    if (H5Lexists(parent, name, H5P_DEFAULT) > 0)
        return H5Gopen2(parent, name, H5P_DEFAULT);
    hid_t properties = without_times(H5P_GROUP_CREATE);
    if (properties < 0)
        return -1;
    hid_t group = H5Gcreate2(parent, name, H5P_DEFAULT, properties, H5P_DEFAULT);
    H5Pclose(properties);
    return group;
}

hid_t state_group(struct state_writer *writer, const char *path)
{
    hid_t group = H5Gopen2(writer->hdf, "/", H5P_DEFAULT);
    char *parts = strdup(path), *rest = NULL;
    for (char *part = parts ? strtok_r(parts, "/", &rest) : NULL; part && group >= 0;
         part = strtok_r(NULL, "/", &rest)) {
        hid_t next = open_or_create_group(group, part);
        H5Gclose(group);
        group = next;
    }
    if (group < 0 || !parts) {
        state_write_failed(writer, path);
        group = -1;
    }
    free(parts);
    return group;
}

/* Chunked with a checksum; an empty dataset has no chunks to protect. */
static hid_t dataset_properties(int rank, const hsize_t *dims)
{
    hsize_t chunk[4];
    hid_t properties = without_times(H5P_DATASET_CREATE);
    if (properties < 0)
        return -1;
    for (int d = 0; d < rank; d++) {
        if (dims[d] == 0)
            return properties;
        chunk[d] = d == 0 && dims[d] > CHUNK_ROWS ? CHUNK_ROWS : dims[d];
    }
    if (H5Pset_chunk(properties, rank, chunk) < 0 || H5Pset_fletcher32(properties) < 0) {
        H5Pclose(properties);
        return -1;
    }
    return properties;
}

hid_t state_dataset(struct state_writer *writer, hid_t group, const char *name, hid_t file_type, hid_t memory_type,
                    int rank, const hsize_t *dims, const void *values)
{
    hid_t properties = dataset_properties(rank, dims);
    hid_t space = H5Screate_simple(rank, dims, NULL);
    hid_t dataset = properties < 0 || space < 0
                        ? -1
                        : H5Dcreate2(group, name, file_type, space, H5P_DEFAULT, properties, H5P_DEFAULT);
    int failed = dataset < 0 || H5Dwrite(dataset, memory_type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values) < 0;
    if (properties >= 0)
        H5Pclose(properties);
    if (space >= 0)
        H5Sclose(space);
    if (!failed)
        return dataset;
    if (dataset >= 0)
        H5Dclose(dataset);
    return state_write_failed(writer, name);
}

int state_hard_link(struct state_writer *writer, const char *target, const char *link)
{
    if (H5Lcreate_hard(writer->hdf, target, writer->hdf, link, H5P_DEFAULT, H5P_DEFAULT) < 0)
        return state_write_failed(writer, link);
    return 0;
}

/* One column with its unit and its meaning as attributes; flags with the names of their bits. */
static int write_column(struct state_writer *writer, hid_t group, const struct table_kind *kind,
                        const struct column *column, const void *values, size_t rows)
{
    hsize_t dims = rows;
    hid_t file_type = state_file_type(column->type), memory_type = state_memory_type(column->type);
    hid_t dataset = state_dataset(writer, group, column->name, file_type, memory_type, 1, &dims, values);
    H5Tclose(file_type);
    H5Tclose(memory_type);
    if (dataset < 0)
        return -1;
    int failed = write_text(dataset, "units", column->units) || write_text(dataset, "long_name", column->long_name);
    if (!strcmp(column->name, "flags") && kind->flag_names)
        failed |= write_flag_names(dataset, kind->flag_names);
    failed |= H5Dclose(dataset) < 0;
    return failed ? state_write_failed(writer, column->name) : 0;
}

int state_write(struct state_writer *writer, const char *group, const struct table_kind *kind, const void *table)
{
    hid_t place = state_group(writer, group);
    if (place < 0)
        return -1;
    int result = 0;
    for (size_t c = 0; c < kind->column_count && result == 0; c++) {
        const void *values = *table_array(&kind->columns[c], table);
        if (values)
            result = write_column(writer, place, kind, &kind->columns[c], values, table_rows(kind, table));
    }
    if (H5Gclose(place) < 0 && result == 0)
        result = state_write_failed(writer, group);
    return result;
}

int state_write_text(struct state_writer *writer, const char *group, const char *attribute, const char *text)
{
    hid_t place = state_group(writer, group);
    if (place < 0)
        return -1;
    int failed = write_text(place, attribute, text);
    failed |= H5Gclose(place) < 0;
    return failed ? state_write_failed(writer, attribute) : 0;
}

int state_write_numbers(struct state_writer *writer, const char *group, const char *attribute, const double *values,
                        size_t count)
{
    hid_t place = state_group(writer, group);
    if (place < 0)
        return -1;
    int failed = write_attribute(place, attribute, H5T_IEEE_F64LE, H5T_NATIVE_DOUBLE, count, values);
    failed |= H5Gclose(place) < 0;
    return failed ? state_write_failed(writer, attribute) : 0;
}

/* An attribute of the root, 64 bits. */
static int write_integer(struct state_writer *writer, const char *attribute, int64_t value)
{
    hid_t root = state_group(writer, "/");
    if (root < 0)
        return -1;
    int failed = write_attribute(root, attribute, H5T_STD_I64LE, H5T_NATIVE_INT64, 1, &value);
    failed |= H5Gclose(root) < 0;
    return failed ? state_write_failed(writer, attribute) : 0;
}

/* ---- provenance ---- */

/* An entry of the list of inputs: base name, part of the scene or NULL, SHA-256. 0, or -1 without memory. */
static int add_input(cJSON *array, const char *path, const char *part, const char digest[65])
{
    char *name = text_escape(basename(path)); /* JSON is UTF-8, a name need not be */
    cJSON *input = name ? cJSON_CreateObject() : NULL;
    int listed = array && cJSON_AddItemToArray(array, input);
    int whole = listed && cJSON_AddStringToObject(input, "name", name) &&
                (!part || cJSON_AddStringToObject(input, "part", part)) &&
                cJSON_AddStringToObject(input, "sha256", digest);
    if (!listed)
        cJSON_Delete(input);
    free(name);
    return whole ? 0 : error_memory("the list of inputs");
}

/* An input that is a file, by the bytes that were read. */
static int add_file(cJSON *array, const char *path)
{
    char digest[65];
    return read_record_digest(path, digest) ? -1 : add_input(array, path, NULL, digest);
}

/* The hash is that of the stage's part of the scene: what is written elsewhere in it changes nothing here. */
static int add_scene(cJSON *array, const struct scene *scene, const char *stage)
{
    char digest[65], *part = scene_part(scene, stage);
    const char *paths[2];
    int result = part && !text_sha256(part, digest) ? add_input(array, scene->path, stage, digest) : -1;
    free(part);
    size_t count = result ? 0 : scene_part_files(scene, stage, paths);
    for (size_t k = 0; k < count && result == 0; k++)
        result = add_file(array, paths[k]);
    return result;
}

/* JSON array of {name, sha256}, the scene's with the name of the part; to be freed. */
static char *describe_inputs(const struct provenance *provenance)
{
    cJSON *array = cJSON_CreateArray();
    char *text = NULL;
    int result = provenance->scene ? add_scene(array, provenance->scene, provenance->stage) : 0;
    for (size_t k = 0; k < provenance->input_count && result == 0; k++)
        result = add_file(array, provenance->input_paths[k]);
    if (result == 0)
        text = json_print(array);
    cJSON_Delete(array);
    return text;
}

/* What made this file: program and version, parameters, inputs with their hashes, photo and time. */
static int write_provenance(struct state_writer *writer, const struct provenance *provenance)
{
    char *inputs = describe_inputs(provenance);
    if (!inputs)
        return -1;
    const double *strain = provenance->strain;
    int failed = state_write_text(writer, "/", "schema", STATE_SCHEMA) ||
                 write_integer(writer, "schema_version", STATE_SCHEMA_VERSION) ||
                 state_write_text(writer, "/", "stage", provenance->stage) ||
                 state_write_text(writer, "/", "program_version", film_version) ||
                 state_write_text(writer, "/", "parameters", provenance->parameters ? provenance->parameters : "{}") ||
                 state_write_text(writer, "/", "inputs", inputs) || write_integer(writer, "index", provenance->index) ||
                 state_write_numbers(writer, "/", "time_s", &provenance->time_s, 1);
    if (!failed && provenance->taken && *provenance->taken)
        failed = state_write_text(writer, "/", "taken", provenance->taken);
    if (!failed && provenance->coordinates)
        failed = state_write_text(writer, "/", "coordinates", provenance->coordinates);
    if (!failed && !(isnan(strain[0]) && isnan(strain[1]) && isnan(strain[2])))
        failed = state_write_numbers(writer, "/", "strain", strain, 3);
    if (!failed && !isnan(provenance->length_m))
        failed = state_write_numbers(writer, "/", "length_m", &provenance->length_m, 1);
    for (size_t k = 0; k < provenance->number_count && !failed; k++) {
        const struct state_number *number = &provenance->numbers[k];
        failed = state_write_numbers(writer, "state", number->name, number->values, number->count);
    }
    free(inputs);
    return failed ? -1 : 0;
}

/* ---- the file ---- */

/* After a close that fails on a full disk, HDF5 1.10.8 closes the same file again when the process ends, and crashes on
 * what it has freed: the exit status would be lost. Its exit handler has nothing to do, since every file is closed
 * here; it must be declined before the first call of HDF5. */
__attribute__((constructor)) static void decline_exit_handler(void)
{
    H5dont_atexit();
}

static hid_t create_hdf(const char *path)
{
    hid_t creation = without_times(H5P_FILE_CREATE), access = H5Pcreate(H5P_FILE_ACCESS), hdf = -1;
    /* The format of HDF5 1.10 puts a checksum on every piece of metadata (the older ones on none or few), so that a
     * damaged file is refused instead of misread; and its index of a column in one chunk takes no room. */
    if (creation >= 0 && access >= 0 && H5Pset_fclose_degree(access, H5F_CLOSE_STRONG) >= 0 &&
        H5Pset_file_locking(access, 0, 1) >= 0 && H5Pset_libver_bounds(access, H5F_LIBVER_V110, H5F_LIBVER_V110) >= 0)
        hdf = H5Fcreate(path, H5F_ACC_TRUNC, creation, access);
    if (creation >= 0)
        H5Pclose(creation);
    if (access >= 0)
        H5Pclose(access);
    return hdf;
}

struct state_writer *state_create(const char *path, const struct provenance *provenance)
{
    struct state_writer *writer = calloc(1, sizeof *writer);
    if (!writer) {
        (void)error_memory(path);
        return NULL;
    }
    H5Eset_auto2(H5E_DEFAULT, NULL, NULL);
    writer->hdf = -1;
    if (new_file_begin(&writer->file, path)) {
        free(writer);
        return NULL;
    }
    writer->hdf = create_hdf(writer->file.temporary);
    if (writer->hdf < 0)
        state_write_failed(writer, "the file");
    if (writer->hdf < 0 || write_provenance(writer, provenance)) {
        state_discard(writer);
        return NULL;
    }
    return writer;
}

void state_discard(struct state_writer *writer)
{
    if (!writer)
        return;
    if (writer->hdf >= 0)
        H5Fclose(writer->hdf);
    new_file_discard(&writer->file);
    free(writer);
}

int state_commit(struct state_writer *writer)
{
    int result = writer->failed ? -1 : 0; /* its error line stands */
    if (result == 0 && H5Fflush(writer->hdf, H5F_SCOPE_GLOBAL) < 0)
        result = state_write_failed(writer, "the file");
    if (H5Fclose(writer->hdf) < 0 && result == 0)
        result = state_write_failed(writer, "the file");
    writer->hdf = -1;
    if (result == 0)
        result = new_file_commit(&writer->file);
    state_discard(writer);
    return result;
}
