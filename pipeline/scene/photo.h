/* A photo: 16-bit grey pixels in memory. 8-bit files are kept at their own values (0-255), see `bits`. */
#ifndef PIPELINE_PHOTO_H
#define PIPELINE_PHOTO_H

#include <stddef.h>
#include <stdint.h>

struct photo {
    int width, height;
    int bits;         /* per sample in the file: 8 or 16 */
    uint16_t *pixels; /* row-major, width * height */
    char taken[20];   /* what the camera's clock said, "2018:05:17 14:03:59" (TIFF DateTime); "": not in the file */
};

enum photo_channel { PHOTO_GREY_ONLY, PHOTO_RED, PHOTO_GREEN, PHOTO_BLUE, PHOTO_GREY_OF_RGB };

/* What the reader accepts. */
struct photo_request {
    int width, height;          /* 0: any; else another size is an error */
    enum photo_channel channel; /* PHOTO_GREY_ONLY: an RGB file is an error that names the scene's key photos.channel;
                                   PHOTO_GREY_OF_RGB: (299 R + 587 G + 114 B + 500) / 1000 */
};
#define PHOTO_MAX_PIXELS ((size_t)1 << 30)
/* From now on this process refuses photos of more pixels than this (--max-pixels), before any memory is asked for. */
void photo_limit_pixels(size_t most);

/* Read page 1 of a TIFF: 8- or 16-bit grey (MinIsBlack or MinIsWhite, the latter inverted) or RGB as requested; strips
 * or tiles; none, LZW or Deflate with or without predictor; both byte orders; BigTIFF. Everything else, more than one
 * page, a short strip: an error before the pixels are allocated where the header tells, status EXIT_INPUT. 0, or -1
 * with a line and nothing to be freed; else photo_free(). */
int photo_read(const char *path, const struct photo_request *request, struct photo *photo);
/* 16-bit grey TIFF, Deflate with horizontal predictor, atomically (temporary, fsync, rename); byte-identical reruns.
 * 0, or -1 with a line (EXIT_FAILED): the file cannot be written. */
int photo_write(const char *path, const struct photo *photo);
/* A 16-bit photo whose pixels are not set yet, to be freed by photo_free(). 0, or -1 with a line: a size below 1 or
 * above PHOTO_MAX_PIXELS (EXIT_INPUT), out of memory. */
int photo_alloc(struct photo *photo, int width, int height);
void photo_free(struct photo *photo); /* accepts a zeroed struct */

/* The pixels of row y, 0 <= y < height; borrowed. */
static inline const uint16_t *photo_row(const struct photo *photo, int y)
{
    return photo->pixels + (size_t)y * (size_t)photo->width;
}

#endif
