/* Opening a state file, and what it says of itself. Columns are read in state_columns.c, attributes in
 * state_attributes.c; both find their objects through state_find.c. */
#include <fcntl.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "pipeline/files/read_record.h"
#include "pipeline/speak/error.h"
#include "pipeline/state/state_hdf.h"
#include "pipeline/state/state_open.h"

/* The file is of this program and of a version that it reads. 0, or -1 with an error. */
static int check_schema(const struct state *state)
{
    char schema[32] = "";
    int64_t version = 0;
    if (state_read_text(state, "/", "schema", schema, sizeof schema) < 0)
        return -1;
    if (strcmp(schema, STATE_SCHEMA))
        return error_input("%s: is not a state file (its schema is '%s'): give a .hdf file of this program",
                           state->path, schema);
    int status = state_attribute_integer(state, "schema_version", &version);
    if (status < 0)
        return -1;
    if (status == 1 || version < 1)
        return error_input("%s: has no schema_version: make the file again", state->path);
    if (version > STATE_SCHEMA_VERSION)
        return error_input("%s: schema_version %lld is newer than this program knows (%d): use a newer program",
                           state->path, (long long)version, STATE_SCHEMA_VERSION);
    return 0;
}

void state_own_name(const struct state *state, char name[64])
{
    snprintf(name, 64, "/proc/self/fd/%d", state->fd);
}

/* Regular files only; noted in the record of what was read, through the same descriptor. 0, or -1 with an error. */
static int open_file(struct state *state)
{
    struct stat status;
    state->fd = open(state->path, O_RDONLY | O_CLOEXEC | O_NOCTTY | O_NONBLOCK);
    if (state->fd < 0 || fstat(state->fd, &status))
        return error_input("%s: cannot be opened: check the path", state->path);
    if (!S_ISREG(status.st_mode))
        return error_input("%s: is not a file: name a state file (.hdf)", state->path);
    return read_record_note(state->path, state->fd);
}

/* Through the descriptor's own name, so that HDF5 reads the very file that was hashed. -1 with an error. */
static hid_t open_hdf(const struct state *state)
{
    char name[64];
    state_own_name(state, name);
    H5Eset_auto2(H5E_DEFAULT, NULL, NULL);
    H5PLset_loading_state(0); /* no foreign code for foreign filters */
    hid_t access = H5Pcreate(H5P_FILE_ACCESS), hdf = -1;
    /* No lock: files are replaced whole, and some disks have none. */
    if (access >= 0 && H5Pset_fclose_degree(access, H5F_CLOSE_STRONG) >= 0 && H5Pset_file_locking(access, 0, 1) >= 0)
        hdf = H5Fopen(name, H5F_ACC_RDONLY, access);
    if (access >= 0)
        H5Pclose(access);
    if (hdf < 0)
        (void)error_input("%s: is not a whole HDF5 file: name a state file (.hdf), or make it again", state->path);
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
    state->hdf = -1;
    if (open_file(state) || (state->hdf = open_hdf(state)) < 0 || check_schema(state)) {
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
    if (state->fd >= 0)
        close(state->fd);
    free(state->path);
    free(state);
}

void state_info_free(struct state_info *info)
{
    free(info->parameters);
    free(info->inputs);
    memset(info, 0, sizeof *info);
}

int state_check_order(const char *previous_path, const struct state_info *previous, const struct state_info *now)
{
    if (previous->index < 0 || now->index < 0 || previous->index < now->index)
        return 0;
    return error_input("%s: is photo %lld, not before photo %lld: give the state before as --previous", previous_path,
                       (long long)previous->index, (long long)now->index);
}

int state_read_info(const struct state *state, struct state_info *info)
{
    memset(info, 0, sizeof *info);
    info->index = -1;
    info->time_s = info->length_m = info->strain[0] = info->strain[1] = info->strain[2] = NAN;
    if (state_read_text(state, "/", "stage", info->stage, sizeof info->stage) < 0 ||
        state_read_text(state, "/", "coordinates", info->coordinates, sizeof info->coordinates) < 0 ||
        state_read_text(state, "/", "taken", info->taken, sizeof info->taken) < 0 ||
        state_read_text(state, "/", "program_version", info->program_version, sizeof info->program_version) < 0 ||
        state_attribute_text(state, "/", "parameters", &info->parameters) < 0 ||
        state_attribute_text(state, "/", "inputs", &info->inputs) < 0 ||
        state_attribute_integer(state, "index", &info->index) < 0 ||
        state_read_numbers(state, "/", "time_s", &info->time_s, 1) < 0 ||
        state_read_numbers(state, "/", "strain", info->strain, 3) < 0 ||
        state_read_numbers(state, "/", "length_m", &info->length_m, 1) < 0) {
        state_info_free(info);
        return -1;
    }
    return 0;
}
