/* Global heaps (HDF5 File Format Specification 3.0, III.E), in the bytes of the file: "GCOL", version 1, three zeros,
 * size of the collection; then objects of 16 bytes of header (index, references, reserved, size) and their bytes,
 * padded to 8. An object of index 0 is what is left free. */
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "pipeline/speak/error.h"
#include "pipeline/state/state_storage.h"

/* HDF5 1.10 converts texts in a buffer of at least so many bytes (H5Tvlen.c). */
enum { LONGEST_OBJECT = 4096, HEADER = 16, WINDOW = 1 << 20 };

/* At most 8 bytes. */
static uint64_t little_endian(const unsigned char *bytes, int count)
{
    uint64_t value = 0;
    while (count-- > 0)
        value = value << 8 | bytes[count];
    return value;
}

/* The collection that begins at `start`: is each object short enough? */
static int collection_is_safe(FILE *file, long start, uint64_t size)
{
    unsigned char header[HEADER];
    for (uint64_t at = HEADER; at + HEADER <= size;) {
        if (fseek(file, start + (long)at, SEEK_SET) || fread(header, 1, sizeof header, file) != sizeof header)
            return 1; /* beyond the end: HDF5 refuses it */
        uint64_t bytes = little_endian(header + 8, 8);
        if (little_endian(header, 2) == 0)
            return 1;
        if (bytes > LONGEST_OBJECT)
            return 0;
        at += HEADER + (bytes + 7) / 8 * 8;
    }
    return 1;
}

/* Every place of the window that looks like the head of a collection. */
static int window_is_safe(FILE *file, const unsigned char *window, size_t length, long start)
{
    static const unsigned char head[8] = {'G', 'C', 'O', 'L', 1, 0, 0, 0};
    for (const unsigned char *at = window; (at = memmem(at, (size_t)(window + length - at), head, sizeof head)); at++) {
        if (window + length - at < HEADER)
            break;
        if (!collection_is_safe(file, start + (at - window), little_endian(at + 8, 8)))
            return 0;
    }
    return 1;
}

/* The whole file, window by window. */
static int file_is_safe(FILE *file)
{
    unsigned char *window = malloc(WINDOW);
    int safe = window != NULL;
    size_t length = 1;
    for (long start = 0; safe && length; start += WINDOW - HEADER) { /* windows overlap by a head */
        length = fseek(file, start, SEEK_SET) ? 0 : fread(window, 1, WINDOW, file);
        safe = window_is_safe(file, window, length, start);
    }
    free(window);
    return safe;
}

int state_check_heaps(const struct state *state)
{
    size_t addresses = 0, lengths = 0;
    hid_t properties = H5Fget_create_plist(state->hdf);
    int known = properties >= 0 && H5Pget_sizes(properties, &addresses, &lengths) >= 0 && lengths == 8;
    if (properties >= 0)
        H5Pclose(properties);
    char name[64];
    state_own_name(state, name);
    FILE *file = known ? fopen(name, "rb") : NULL;
    int safe = file && file_is_safe(file) && !ferror(file);
    if (file)
        fclose(file);
    return safe ? 0
                : error_input("%s: has texts of variable length that cannot be read safely: write attributes as texts "
                              "of fixed length",
                              state->path);
}
