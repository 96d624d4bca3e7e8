/* What libFuzzer, and replay.c in its place, calls with one input. */
#ifndef TESTS_FUZZ_TARGET_H
#define TESTS_FUZZ_TARGET_H

#include <stddef.h>
#include <stdint.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

/* The input as a file for readers that take a path; the same name for the life of the process. */
const char *fuzz_file(const uint8_t *data, size_t size);

#endif
