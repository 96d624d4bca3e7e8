/* How this program talks to libtiff: per-handle messages that print nothing, bounded allocations. Private to
 * pipeline/. */
#ifndef PIPELINE_PHOTO_TIFF_H
#define PIPELINE_PHOTO_TIFF_H

#include <tiffio.h>

struct tiff_messages {
    char error[256];   /* the first one; "" when there was none */
    int out_of_memory; /* then error is "" */
};

/* Open with libtiff's mode, for reading through that descriptor (which TIFFClose() closes; fd < 0: the path); NULL on
 * failure, messages->error then says why. Allocations above max_alloc bytes made by libtiff on its own behalf fail. */
TIFF *tiff_open(const char *path, int fd, const char *mode, tmsize_t max_alloc, struct tiff_messages *messages);

#endif
