/* What the library does not check before it reads: HDF5 1.10 copies as many bytes as a file's own records say, wherever
 * they come from. Private to pipeline/. */
#ifndef PIPELINE_STATE_STORAGE_H
#define PIPELINE_STATE_STORAGE_H

#include "pipeline/state/state_open.h"

/* Is all of a one-dimensional column of so many rows there, inside this file? Every chunk must have been written and
 * hold just the bytes of a chunk: none shorter, which HDF5 would fill from other memory. Filters: gzip, shuffle,
 * Fletcher32. -1: no (error set). */
int state_check_storage(const struct state *state, hid_t dataset, const char *group, const char *name, hsize_t rows);

/* May texts of variable length be read? They lie in global heaps, whose objects HDF5 1.10 copies whole into a buffer of
 * 4096 bytes when the text is said to be shorter. -1: some object is longer than that (error set). */
int state_check_heaps(const struct state *state);

#endif
