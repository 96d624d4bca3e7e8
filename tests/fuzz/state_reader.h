/* Every reader of state files on one file: each table read or refused with one line, the whole packing usable. */
#ifndef TESTS_FUZZ_STATE_READER_H
#define TESTS_FUZZ_STATE_READER_H

#include <stddef.h>
#include <stdint.h>

void read_state_file(const char *path);
/* The input as a file with a name of its own: HDF5 asks for the real path, which fuzz_file() does not have. */
const char *fuzz_named_file(const uint8_t *data, size_t size);

#endif
