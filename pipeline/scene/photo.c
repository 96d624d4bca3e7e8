#include "pipeline/scene/photo.h"

#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "pipeline/speak/error.h"
#include "pipeline/files/new_file.h"
#include "pipeline/scene/photo_tiff.h"

int photo_alloc(struct photo *photo, int width, int height)
{
    memset(photo, 0, sizeof *photo);
    if (width <= 0 || height <= 0 || (size_t)width * (size_t)height > PHOTO_MAX_PIXELS)
        return error_input("a photo of %d x %d pixels: give sizes from 1 up, at most 2^30 pixels", width, height);
    photo->pixels = malloc((size_t)width * (size_t)height * sizeof *photo->pixels);
    if (!photo->pixels)
        return error_failed("out of memory: %zu MB for the pixels of a photo: use a machine with more memory",
                            (size_t)width * (size_t)height * sizeof *photo->pixels / 1000000);
    photo->width = width;
    photo->height = height;
    photo->bits = 16;
    return 0;
}

void photo_free(struct photo *photo)
{
    free(photo->pixels);
    memset(photo, 0, sizeof *photo);
}

/* ---- libtiff's messages ---- */

/* The first message is the cause; later ones follow from it. For libtiff: 1 means handled. */
static int keep_error(TIFF *tiff, void *data, const char *module, const char *format, va_list arguments)
{
    struct tiff_messages *messages = data;
    (void)tiff;
    (void)module;
    if (!messages->error[0])
        vsnprintf(messages->error, sizeof messages->error, format, arguments);
    return 1; /* handled: the global handler stays silent */
}

/* Unknown tags of cameras and the like. */
static int ignore_warning(TIFF *tiff, void *data, const char *module, const char *format, va_list arguments)
{
    (void)tiff;
    (void)data;
    (void)module;
    (void)format;
    (void)arguments;
    return 1;
}

TIFF *tiff_open(const char *path, int fd, const char *mode, tmsize_t max_alloc, struct tiff_messages *messages)
{
    memset(messages, 0, sizeof *messages);
    TIFFOpenOptions *options = TIFFOpenOptionsAlloc();
    if (!options) {
        messages->out_of_memory = 1;
        return NULL;
    }
    TIFFOpenOptionsSetMaxSingleMemAlloc(options, max_alloc);
    TIFFOpenOptionsSetErrorHandlerExtR(options, keep_error, messages);
    TIFFOpenOptionsSetWarningHandlerExtR(options, ignore_warning, NULL);
    TIFF *tiff = fd < 0 ? TIFFOpenExt(path, mode, options) : TIFFFdOpenExt(fd, path, mode, options);
    TIFFOpenOptionsFree(options);
    return tiff;
}

/* ---- writing ---- */

/* 0 when libtiff refuses one. */
static int set_tags(TIFF *tiff, const struct photo *photo, uint32_t rows_per_strip)
{
    return TIFFSetField(tiff, TIFFTAG_IMAGEWIDTH, (uint32_t)photo->width) &&
           TIFFSetField(tiff, TIFFTAG_IMAGELENGTH, (uint32_t)photo->height) &&
           TIFFSetField(tiff, TIFFTAG_BITSPERSAMPLE, 16) && TIFFSetField(tiff, TIFFTAG_SAMPLESPERPIXEL, 1) &&
           TIFFSetField(tiff, TIFFTAG_PHOTOMETRIC, PHOTOMETRIC_MINISBLACK) &&
           TIFFSetField(tiff, TIFFTAG_COMPRESSION, COMPRESSION_ADOBE_DEFLATE) &&
           TIFFSetField(tiff, TIFFTAG_PREDICTOR, PREDICTOR_HORIZONTAL) &&
           TIFFSetField(tiff, TIFFTAG_PLANARCONFIG, PLANARCONFIG_CONTIG) &&
           TIFFSetField(tiff, TIFFTAG_ROWSPERSTRIP, rows_per_strip);
}

/* The pixels in strips of whole rows. 0, or -1: libtiff's message is kept by keep_error(). */
static int write_strips(TIFF *tiff, const struct photo *photo)
{
    int rows = (1 << 18) / photo->width; /* strips of about half a megabyte */
    if (rows < 1)
        rows = 1;
    if (!set_tags(tiff, photo, (uint32_t)rows))
        return -1;
    for (int y = 0, strip = 0; y < photo->height; y += rows, strip++) {
        int count = rows < photo->height - y ? rows : photo->height - y;
        tmsize_t bytes = (tmsize_t)count * photo->width * (tmsize_t)sizeof(uint16_t);
        if (TIFFWriteEncodedStrip(tiff, (uint32_t)strip, (void *)photo_row(photo, y), bytes) != bytes)
            return -1;
    }
    return TIFFFlush(tiff) ? 0 : -1;
}

int photo_write(const char *path, const struct photo *photo)
{
    struct new_file file;
    struct tiff_messages messages;
    if (photo->width <= 0 || photo->height <= 0 || !photo->pixels)
        return error_input("%s: an empty photo cannot be written: give it pixels", path);
    if (new_file_begin(&file, path))
        return -1;
    TIFF *tiff = tiff_open(file.temporary, -1, "wl", (tmsize_t)1 << 30, &messages);
    int failed = !tiff || write_strips(tiff, photo);
    if (tiff)
        TIFFClose(tiff);
    if (failed || messages.error[0]) {
        new_file_discard(&file);
        return error_failed("%s: cannot be written (%s): check the room on the disk, then run again", path,
                            *messages.error ? messages.error : "libtiff gives no reason");
    }
    return new_file_commit(&file);
}
