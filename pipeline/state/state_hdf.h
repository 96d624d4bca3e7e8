/* What the files that write and read state files share: HDF5 types and the writer's insides. Private to pipeline/. */
#ifndef PIPELINE_STATE_HDF_H
#define PIPELINE_STATE_HDF_H

#include <hdf5.h>

#include "pipeline/state/columns.h"
#include "pipeline/files/new_file.h"
#include "pipeline/state/state.h"

#define STATE_SCHEMA "film.state"
enum { STATE_SCHEMA_VERSION = 1 };
/* More rows than any packing has; bounds what a broken file can make a reader allocate. */
#define STATE_MAX_ROWS ((hsize_t)100000000)

struct state_writer {
    struct new_file file;
    hid_t hdf;
    int failed; /* after a failure nothing can be committed */
};

/* Types in the file and in memory; to be closed with H5Tclose (they are copies). */
hid_t state_file_type(enum column_type type);
hid_t state_memory_type(enum column_type type);
hid_t state_string_type(size_t size, int utf8);

/* Always -1: the writer can no longer be committed; "path: what: remedy". */
int state_write_failed(struct state_writer *writer, const char *what);
/* Open a group by its path, making every missing part; negative on failure (error set). "/" is the root. */
hid_t state_group(struct state_writer *writer, const char *path);
/* Write one dataset of any rank under an open group; returns it open, negative on failure (error set). */
hid_t state_dataset(struct state_writer *writer, hid_t group, const char *name, hid_t file_type, hid_t memory_type,
                    int rank, const hsize_t *dims, const void *values);
/* Make `link` (a path) another name of the object `target` (a path); its group exists. */
int state_hard_link(struct state_writer *writer, const char *target, const char *link);

#endif
