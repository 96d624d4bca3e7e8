/* Reading a TIFF: what the header says is checked before anything is allocated, then every strip or tile goes straight
 * to its place. Plain grey strips are decoded into the pixels themselves; there is no second copy of the photo. */
#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "pipeline/files/read_record.h"
#include "pipeline/speak/error.h"
#include "pipeline/scene/photo.h"
#include "pipeline/scene/photo_tiff.h"

struct source {
    const char *path;
    int fd;
    TIFF *tiff;
    struct tiff_messages messages;
    uint64_t file_bytes;
    uint32_t width, height;
    uint16_t bits, samples, compression;
    int white_is_zero;
    enum photo_channel channel; /* of an RGB file */
};

/* No coder of ours expands further: Deflate 1032, LZW about 2700. */
enum { LARGEST_EXPANSION = 4096 };
#define LARGEST_TILE_BYTES ((uint64_t)1 << 28)

/* ---- the header ---- */

static uint16_t tag(const struct source *source, uint32_t name, uint16_t otherwise)
{
    uint16_t value = otherwise;
    return TIFFGetFieldDefaulted(source->tiff, name, &value) ? value : otherwise;
}

static size_t most_pixels = PHOTO_MAX_PIXELS;

void photo_limit_pixels(size_t most)
{
    most_pixels = most < PHOTO_MAX_PIXELS ? most : PHOTO_MAX_PIXELS;
}

static int check_size(struct source *source, const struct photo_request *request)
{
    TIFFGetField(source->tiff, TIFFTAG_IMAGEWIDTH, &source->width);
    TIFFGetField(source->tiff, TIFFTAG_IMAGELENGTH, &source->height);
    if (source->width == 0 || source->height == 0 || source->width > INT_MAX || source->height > INT_MAX ||
        (uint64_t)source->width * source->height > most_pixels)
        return error_input("%s: %u x %u pixels: give a photo of 1 to %zu pixels (--max-pixels)", source->path,
                           source->width, source->height, most_pixels);
    if ((request->width && source->width != (uint32_t)request->width) ||
        (request->height && source->height != (uint32_t)request->height))
        return error_input("%s: has %u x %u pixels, %d x %d are expected (scene: photos.size_px): take photos of one "
                           "size",
                           source->path, source->width, source->height, request->width, request->height);
    return 0;
}

static int check_samples(struct source *source)
{
    uint16_t format = tag(source, TIFFTAG_SAMPLEFORMAT, SAMPLEFORMAT_UINT);
    source->bits = tag(source, TIFFTAG_BITSPERSAMPLE, 1);
    source->samples = tag(source, TIFFTAG_SAMPLESPERPIXEL, 1);
    if (format != SAMPLEFORMAT_UINT)
        return error_input("%s: its numbers are not unsigned integers (SampleFormat %u): save it as unsigned 16-bit "
                           "grey",
                           source->path, format);
    if (source->bits != 8 && source->bits != 16)
        return error_input("%s: has %u bits per sample: save it with 8 or 16", source->path, source->bits);
    if (source->samples != 1 && source->samples != 3)
        return error_input("%s: has %u samples per pixel: save it as grey, or RGB without alpha", source->path,
                           source->samples);
    if (source->samples == 3 && tag(source, TIFFTAG_PLANARCONFIG, PLANARCONFIG_CONTIG) != PLANARCONFIG_CONTIG)
        return error_input("%s: keeps its colours in separate planes: save it with interleaved samples", source->path);
    if (tag(source, TIFFTAG_ORIENTATION, ORIENTATION_TOPLEFT) != ORIENTATION_TOPLEFT)
        return error_input("%s: is stored turned or mirrored (Orientation %u): save it upright", source->path,
                           tag(source, TIFFTAG_ORIENTATION, ORIENTATION_TOPLEFT));
    return 0;
}

static int check_colour(struct source *source, const struct photo_request *request)
{
    static const char *const names[] = {"grey", "red", "green", "blue", "grey"};
    uint16_t photometric = UINT16_MAX;
    if (!TIFFGetField(source->tiff, TIFFTAG_PHOTOMETRIC, &photometric))
        return error_input("%s: does not say what its numbers mean (no PhotometricInterpretation): save it again as "
                           "grey",
                           source->path);
    int grey = photometric == PHOTOMETRIC_MINISBLACK || photometric == PHOTOMETRIC_MINISWHITE;
    if (!(grey && source->samples == 1) && !(photometric == PHOTOMETRIC_RGB && source->samples == 3))
        return error_input("%s: is neither grey nor RGB (PhotometricInterpretation %u): save it as 16-bit grey",
                           source->path, photometric);
    if (!grey && request->channel == PHOTO_GREY_ONLY)
        return error_input("%s: is an RGB photo: name a channel in the scene (\"photos\": {\"channel\": \"red\", "
                           "\"green\", \"blue\" or \"grey\"})",
                           source->path);
    if (grey && request->channel != PHOTO_GREY_ONLY && request->channel != PHOTO_GREY_OF_RGB)
        return error_input("%s: is a grey photo and has no channel '%s': correct photos.channel in the scene",
                           source->path, names[request->channel]);
    source->white_is_zero = photometric == PHOTOMETRIC_MINISWHITE;
    source->channel = request->channel;
    return 0;
}

static int check_coding(struct source *source)
{
    source->compression = tag(source, TIFFTAG_COMPRESSION, COMPRESSION_NONE);
    int plain = source->compression == COMPRESSION_NONE;
    if (!plain && source->compression != COMPRESSION_LZW && source->compression != COMPRESSION_ADOBE_DEFLATE &&
        source->compression != COMPRESSION_DEFLATE)
        return error_input("%s: has compression %u: save it with none, LZW or Deflate", source->path,
                           source->compression);
    uint16_t predictor = plain ? PREDICTOR_NONE : tag(source, TIFFTAG_PREDICTOR, PREDICTOR_NONE);
    if (predictor != PREDICTOR_NONE && predictor != PREDICTOR_HORIZONTAL)
        return error_input("%s: has predictor %u: save it without or with the horizontal one", source->path, predictor);
    return 0;
}

static uint64_t segment_bytes(const struct source *source, uint32_t segment)
{
    if (TIFFIsTiled(source->tiff))
        return TIFFTileSize64(source->tiff);
    uint32_t rows = source->height;
    TIFFGetFieldDefaulted(source->tiff, TIFFTAG_ROWSPERSTRIP, &rows);
    if (rows > source->height)
        rows = source->height;
    uint64_t first = (uint64_t)segment * rows, left = source->height - first;
    return (left < rows ? left : rows) * TIFFScanlineSize64(source->tiff);
}

/* Every strip or tile lies inside the file and can hold what it should. */
static int check_segments(const struct source *source)
{
    const char *what = TIFFIsTiled(source->tiff) ? "tile" : "strip";
    uint32_t count = TIFFIsTiled(source->tiff) ? TIFFNumberOfTiles(source->tiff) : TIFFNumberOfStrips(source->tiff);
    uint64_t stored = 0, bytes = (uint64_t)source->width * source->height * source->samples * (source->bits / 8);
    if (count == 0 || (TIFFIsTiled(source->tiff) &&
                       (TIFFTileSize64(source->tiff) == 0 || TIFFTileSize64(source->tiff) > LARGEST_TILE_BYTES)))
        return error_input("%s: its %ss have impossible sizes: save it again", source->path, what);
    for (uint32_t k = 0; k < count; k++) {
        uint64_t offset = TIFFGetStrileOffset(source->tiff, k), length = TIFFGetStrileByteCount(source->tiff, k);
        if (offset > source->file_bytes || length > source->file_bytes - offset)
            return error_input("%s: %s %u of %u lies beyond the end of the file: the file was cut short, copy it again",
                               source->path, what, k, count);
        if (length == 0 || (source->compression == COMPRESSION_NONE && length < segment_bytes(source, k)))
            return error_input("%s: %s %u is short: copy the photo again", source->path, what, k);
        stored += length;
    }
    if (stored < bytes / LARGEST_EXPANSION)
        return error_input("%s: %llu bytes cannot hold %u x %u pixels: save it again", source->path,
                           (unsigned long long)stored, source->width, source->height);
    return 0;
}

static int check_header(struct source *source, const struct photo_request *request)
{
    if (!TIFFLastDirectory(source->tiff))
        return error_input("%s: has more than one page: save each photo as a file of its own", source->path);
    return check_size(source, request) || check_samples(source) || check_colour(source, request) ||
                   check_coding(source) || check_segments(source)
               ? -1
               : 0;
}

/* "YYYY:MM:DD HH:MM:SS", whose order as text is that of time; anything else is taken for no time. */
static void read_time(const struct source *source, char taken[20])
{
    static const char form[] = "0000:00:00 00:00:00";
    const char *text = NULL;
    if (!TIFFGetField(source->tiff, TIFFTAG_DATETIME, &text) || !text || strlen(text) != strlen(form))
        return;
    for (size_t k = 0; form[k]; k++)
        if (form[k] == '0' ? text[k] < '0' || text[k] > '9' : text[k] != form[k])
            return;
    memcpy(taken, text, sizeof form);
}

/* ---- the pixels ---- */

static uint16_t grey_of(unsigned red, unsigned green, unsigned blue)
{
    return (uint16_t)((299 * red + 587 * green + 114 * blue + 500) / 1000);
}

/* One row of decoded samples to pixels. */
static void take_row(const struct source *source, const void *samples, uint16_t *pixels, size_t count)
{
    const uint8_t *bytes = samples;
    const uint16_t *words = samples;
    size_t step = source->samples,
           at = step == 3 && source->channel != PHOTO_GREY_OF_RGB ? (size_t)(source->channel - PHOTO_RED) : 0;
    for (size_t k = 0; k < count; k++, at += step) {
        if (step == 3 && source->channel == PHOTO_GREY_OF_RGB)
            pixels[k] = source->bits == 8 ? grey_of(bytes[at], bytes[at + 1], bytes[at + 2])
                                          : grey_of(words[at], words[at + 1], words[at + 2]);
        else
            pixels[k] = source->bits == 8 ? bytes[at] : words[at];
    }
}

static int short_segment(const struct source *source, const char *what, uint32_t k)
{
    return error_input("%s: %s %u cannot be decoded (%s): copy the photo again", source->path, what, k,
                       source->messages.error[0] ? source->messages.error : "too few bytes");
}

/* Grey strips. 16 bits: decoded in place. 8 bits: decoded into the upper half of the strip's own memory, then widened
 * from the front, where a write never passes the byte still to be read. */
static int read_grey_strips(const struct source *source, struct photo *photo)
{
    uint32_t count = TIFFNumberOfStrips(source->tiff);
    uint16_t *pixels = photo->pixels;
    for (uint32_t k = 0; k < count; k++) {
        tmsize_t bytes = (tmsize_t)segment_bytes(source, k);
        size_t samples = (size_t)bytes / (source->bits / 8);
        uint8_t *decoded = (uint8_t *)pixels + (source->bits == 8 ? samples : 0);
        if (TIFFReadEncodedStrip(source->tiff, k, decoded, bytes) != bytes)
            return short_segment(source, "strip", k);
        if (source->bits == 8)
            for (size_t s = 0; s < samples; s++)
                pixels[s] = decoded[s];
        pixels += samples;
    }
    return 0;
}

static int read_rgb_strips(const struct source *source, struct photo *photo)
{
    void *row = malloc((size_t)TIFFScanlineSize64(source->tiff));
    int result = row ? 0 : error_memory("a row of a photo");
    for (uint32_t y = 0; y < source->height && result == 0; y++) {
        if (TIFFReadScanline(source->tiff, row, y, 0) < 0)
            result = short_segment(source, "row", y);
        else
            take_row(source, row, photo->pixels + (size_t)y * source->width, source->width);
    }
    free(row);
    return result;
}

static void place_tile(const struct source *source, const uint8_t *tile, uint32_t x0, uint32_t y0, uint32_t width,
                       uint32_t height, struct photo *photo)
{
    size_t row_bytes = (size_t)width * source->samples * (source->bits / 8);
    uint32_t columns = width < source->width - x0 ? width : source->width - x0;
    uint32_t rows = height < source->height - y0 ? height : source->height - y0;
    for (uint32_t y = 0; y < rows; y++)
        take_row(source, tile + y * row_bytes, photo->pixels + (size_t)(y0 + y) * source->width + x0, columns);
}

static int read_tiles(const struct source *source, struct photo *photo)
{
    uint32_t width = 0, height = 0, across, count = TIFFNumberOfTiles(source->tiff);
    tmsize_t bytes = (tmsize_t)TIFFTileSize64(source->tiff);
    TIFFGetField(source->tiff, TIFFTAG_TILEWIDTH, &width);
    TIFFGetField(source->tiff, TIFFTAG_TILELENGTH, &height);
    across = source->width / width + (source->width % width != 0);
    uint8_t *tile = malloc((size_t)bytes);
    int result = tile ? 0 : error_memory("a tile of a photo");
    for (uint32_t k = 0; k < count && result == 0; k++) {
        if (TIFFReadEncodedTile(source->tiff, k, tile, bytes) != bytes)
            result = short_segment(source, "tile", k);
        else
            place_tile(source, tile, k % across * width, k / across * height, width, height, photo);
    }
    free(tile);
    return result;
}

static int read_pixels(const struct source *source, struct photo *photo)
{
    if (photo_alloc(photo, (int)source->width, (int)source->height))
        return error_context("%s", source->path);
    photo->bits = source->bits;
    read_time(source, photo->taken);
    int result = TIFFIsTiled(source->tiff) ? read_tiles(source, photo)
                 : source->samples == 1    ? read_grey_strips(source, photo)
                                           : read_rgb_strips(source, photo);
    if (result) {
        photo_free(photo);
        return -1;
    }
    if (source->white_is_zero) {
        uint16_t white = source->bits == 8 ? 255 : 65535;
        for (size_t k = 0; k < (size_t)source->width * source->height; k++)
            photo->pixels[k] = (uint16_t)(white - photo->pixels[k]);
    }
    return 0;
}

/* ---- the file ---- */

static int looks_like_tiff(const unsigned char magic[4])
{
    return !memcmp(magic, "II*\0", 4) || !memcmp(magic, "MM\0*", 4) || !memcmp(magic, "II+\0", 4) ||
           !memcmp(magic, "MM\0+", 4);
}

static int check_file(struct source *source)
{
    struct stat status;
    unsigned char magic[4] = {0};
    if (fstat(source->fd, &status))
        return error_input("%s: cannot be opened: %s: check the path", source->path, strerror(errno));
    if (!S_ISREG(status.st_mode))
        return error_input("%s: is not a file: name a TIFF photo", source->path);
    if (status.st_size == 0)
        return error_input("%s: is empty (0 bytes): copy the photo again", source->path);
    source->file_bytes = (uint64_t)status.st_size;
    if (pread(source->fd, magic, sizeof magic, 0) != sizeof magic || !looks_like_tiff(magic))
        return error_input("%s: is not a TIFF: export the photo as 16-bit grey TIFF", source->path);
    return read_record_note(source->path, source->fd);
}

/* Not mapped into memory: a file that shrinks under us is then an error and not a signal. libtiff's own blocks hold
 * compressed strips and tables, which lie in the file. */
static int open_tiff(struct source *source)
{
    const char *path = source->path;
    source->tiff = tiff_open(path, source->fd, "rm", (tmsize_t)(4 * source->file_bytes + (1 << 24)), &source->messages);
    if (!source->tiff && source->messages.out_of_memory)
        return error_memory(path);
    if (!source->tiff)
        return error_input("%s: is not a readable TIFF, or was cut short (%s): copy the photo again", path,
                           *source->messages.error ? source->messages.error : "libtiff gives no reason");
    return 0;
}

int photo_read(const char *path, const struct photo_request *request, struct photo *photo)
{
    struct source source = {.path = path, .fd = open(path, O_RDONLY | O_CLOEXEC | O_NOCTTY | O_NONBLOCK)};
    memset(photo, 0, sizeof *photo);
    if (source.fd < 0)
        return error_input("%s: cannot be opened: %s: check the path and its permissions", path, strerror(errno));
    if (check_file(&source) || open_tiff(&source)) {
        close(source.fd);
        return -1;
    }
    int result = check_header(&source, request) || read_pixels(&source, photo) ? -1 : 0;
    TIFFClose(source.tiff);
    return result;
}
