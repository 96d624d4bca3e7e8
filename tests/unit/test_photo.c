/* Photos in every storage that is accepted give exactly the numbers that libtiff was given; everything else is refused
 * with one line and status 3, nothing printed. The directory of a libtiff file stands at its end; files with the
 * directory first are assembled by hand. */
#include "tests/check.h"

#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mount.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <tiffio.h>

#include "pipeline/speak/error.h"
#include "pipeline/scene/photo.h"

static char folder[] = "/tmp/test_photo.XXXXXX";
enum { WIDTH = 70, HEIGHT = 53 };

static char *place(const char *name)
{
    static char path[4][256];
    static int next;
    next = (next + 1) % 4;
    snprintf(path[next], sizeof path[next], "%s/%s", folder, name);
    return path[next];
}

/* ---- photos made through libtiff ---- */

struct variant {
    const char *mode;
    int bits, samples, photometric, compression, predictor, rows, tile;
};
#define PLAIN                                                                                                          \
    {                                                                                                                  \
        "w", 16, 1, PHOTOMETRIC_MINISBLACK, COMPRESSION_NONE, 1, 8, 0                                                  \
    }

/* Sample c of pixel (x, y): 16 or 8 busy bits, another pattern per channel. */
static unsigned sample(const struct variant *v, int x, int y, int c)
{
    unsigned value = (unsigned)(x * 941 + y * 3011 + c * 20011 + x * y * 17) & 0xFFFF;
    return v->bits == 8 ? value >> 8 : value;
}

static void put(const struct variant *v, unsigned char *at, int x, int y)
{
    for (int c = 0; c < v->samples; c++) {
        uint16_t value = (uint16_t)sample(v, x, y, c);
        if (v->bits == 8)
            at[c] = (unsigned char)value;
        else
            memcpy(at + 2 * c, &value, 2);
    }
}

static void write_tags(TIFF *tiff, const struct variant *v)
{
    TIFFSetField(tiff, TIFFTAG_IMAGEWIDTH, WIDTH);
    TIFFSetField(tiff, TIFFTAG_IMAGELENGTH, HEIGHT);
    TIFFSetField(tiff, TIFFTAG_BITSPERSAMPLE, v->bits);
    TIFFSetField(tiff, TIFFTAG_SAMPLESPERPIXEL, v->samples);
    TIFFSetField(tiff, TIFFTAG_PHOTOMETRIC, v->photometric);
    TIFFSetField(tiff, TIFFTAG_PLANARCONFIG, PLANARCONFIG_CONTIG);
    TIFFSetField(tiff, TIFFTAG_COMPRESSION, v->compression);
    if (v->predictor > 1)
        TIFFSetField(tiff, TIFFTAG_PREDICTOR, v->predictor);
}

static void write_strips(TIFF *tiff, const struct variant *v)
{
    unsigned char row[WIDTH * 6];
    TIFFSetField(tiff, TIFFTAG_ROWSPERSTRIP, v->rows);
    for (int y = 0; y < HEIGHT; y++) {
        for (int x = 0; x < WIDTH; x++)
            put(v, row + x * v->samples * v->bits / 8, x, y);
        assert_int_equal(TIFFWriteScanline(tiff, row, (uint32_t)y, 0), 1);
    }
}

static void write_tiles(TIFF *tiff, const struct variant *v)
{
    int pixel = v->samples * v->bits / 8;
    unsigned char *tile = malloc((size_t)(v->tile * v->tile * pixel));
    TIFFSetField(tiff, TIFFTAG_TILEWIDTH, v->tile);
    TIFFSetField(tiff, TIFFTAG_TILELENGTH, v->tile);
    for (int y0 = 0; y0 < HEIGHT; y0 += v->tile)
        for (int x0 = 0; x0 < WIDTH; x0 += v->tile) {
            memset(tile, 0xAA, (size_t)(v->tile * v->tile * pixel));
            for (int y = y0; y < y0 + v->tile && y < HEIGHT; y++)
                for (int x = x0; x < x0 + v->tile && x < WIDTH; x++)
                    put(v, tile + ((y - y0) * v->tile + x - x0) * pixel, x, y);
            assert_true(TIFFWriteTile(tiff, tile, (uint32_t)x0, (uint32_t)y0, 0, 0) > 0);
        }
    free(tile);
}

static char *write_variant(const char *name, const struct variant *v)
{
    char *path = place(name);
    TIFF *tiff = TIFFOpen(path, v->mode);
    assert_non_null(tiff);
    write_tags(tiff, v);
    if (v->tile)
        write_tiles(tiff, v);
    else
        write_strips(tiff, v);
    TIFFClose(tiff);
    return path;
}

static unsigned expected(const struct variant *v, enum photo_channel channel, int x, int y)
{
    unsigned value = sample(v, x, y, 0), white = v->bits == 8 ? 255 : 65535;
    if (v->photometric == PHOTOMETRIC_MINISWHITE)
        return white - value;
    if (v->samples == 3 && channel == PHOTO_GREY_OF_RGB)
        return (299 * value + 587 * sample(v, x, y, 1) + 114 * sample(v, x, y, 2) + 500) / 1000;
    return v->samples == 3 ? sample(v, x, y, (int)channel - PHOTO_RED) : value;
}

static void assert_reads(const struct variant *v, enum photo_channel channel)
{
    struct photo photo;
    struct photo_request request = {.channel = channel, .width = WIDTH, .height = HEIGHT};
    char *path = write_variant("variant.tif", v);
    check_done(photo_read(path, &request, &photo));
    assert_int_equal(photo.width, WIDTH);
    assert_int_equal(photo.height, HEIGHT);
    assert_int_equal(photo.bits, v->bits);
    for (int y = 0; y < HEIGHT; y++)
        for (int x = 0; x < WIDTH; x++)
            assert_int_equal(photo_row(&photo, y)[x], expected(v, channel, x, y));
    photo_free(&photo);
}

static void test_grey(void **unused)
{
    (void)unused;
    static const char *const modes[] = {"wl", "wb", "w8", "w8b"}; /* byte orders, BigTIFF */
    static const int codings[][2] = {{COMPRESSION_NONE, 1},          {COMPRESSION_LZW, 1},
                                     {COMPRESSION_LZW, 2},           {COMPRESSION_ADOBE_DEFLATE, 1},
                                     {COMPRESSION_ADOBE_DEFLATE, 2}, {COMPRESSION_DEFLATE, 2}};
    static const int shapes[][2] = {{1, 0}, {8, 0}, {HEIGHT, 0}, {0, 16}, {0, 128}}; /* rows per strip, tile */
    for (int mode = 0; mode < 4; mode++)
        for (int coding = 0; coding < 6; coding++)
            for (int shape = 0; shape < 5; shape++)
                for (int bits = 8; bits <= 16; bits += 8) {
                    struct variant v = {modes[mode],
                                        bits,
                                        1,
                                        PHOTOMETRIC_MINISBLACK,
                                        codings[coding][0],
                                        codings[coding][1],
                                        shapes[shape][0],
                                        shapes[shape][1]};
                    assert_reads(&v, PHOTO_GREY_ONLY);
                }
}

static void test_white_is_zero(void **unused)
{
    (void)unused;
    struct variant v = PLAIN;
    v.photometric = PHOTOMETRIC_MINISWHITE;
    assert_reads(&v, PHOTO_GREY_ONLY);
    v.bits = 8;
    v.tile = 32;
    assert_reads(&v, PHOTO_GREY_ONLY);
}

static void test_rgb(void **unused)
{
    (void)unused;
    for (int bits = 8; bits <= 16; bits += 8)
        for (int tile = 0; tile <= 32; tile += 32)
            for (int predictor = 1; predictor <= 2; predictor++)
                for (enum photo_channel c = PHOTO_RED; c <= PHOTO_GREY_OF_RGB; c++) {
                    struct variant v = {"wb", bits, 3, PHOTOMETRIC_RGB, COMPRESSION_LZW, predictor, 8, tile};
                    assert_reads(&v, c);
                }
    struct variant grey = PLAIN;
    assert_reads(&grey, PHOTO_GREY_OF_RGB); /* "grey" fits a grey photo as well */
}

/* ---- refused ---- */

static void assert_refused(const char *path, const struct photo_request *request, const char *word)
{
    struct photo photo;
    static const struct photo_request any;
    error_clear();
    assert_int_equal(photo_read(path, request ? request : &any, &photo), -1);
    assert_null(photo.pixels);
    assert_int_equal(error_status(), EXIT_INPUT);
    if (!strstr(error_message(), word) || !strstr(error_message(), path) || strchr(error_message(), '\n'))
        fail_msg("'%s' and '%s' are not both in: %s", path, word, error_message());
}

static void test_refused_formats(void **unused)
{
    (void)unused;
    struct variant v = PLAIN;
    v.samples = 3;
    v.photometric = PHOTOMETRIC_RGB;
    assert_refused(write_variant("rgb.tif", &v), NULL, "photos");
    struct photo_request red = {.channel = PHOTO_RED};
    v = (struct variant)PLAIN;
    assert_refused(write_variant("grey.tif", &v), &red, "red");
    v.compression = COMPRESSION_PACKBITS;
    assert_refused(write_variant("packbits.tif", &v), NULL, "LZW or Deflate");
    struct photo_request size = {.width = WIDTH + 1, .height = HEIGHT};
    v = (struct variant)PLAIN;
    assert_refused(write_variant("size.tif", &v), &size, "71 x 53 are expected");
    photo_limit_pixels(WIDTH * HEIGHT - 1);
    assert_refused(place("size.tif"), NULL, "70 x 53 pixels: give a photo of 1 to 3709 pixels");
    photo_limit_pixels(WIDTH * HEIGHT);
    struct photo photo;
    check_done(photo_read(place("size.tif"), &(struct photo_request){0}, &photo));
    photo_free(&photo);
    photo_limit_pixels(PHOTO_MAX_PIXELS);
}

/* DateTime is kept when it is a time as TIFF writes it, and else taken for none. */
static void test_time(void **unused)
{
    (void)unused;
    static const char *const times[][2] = {{"2018:05:17 14:03:59", "2018:05:17 14:03:59"},
                                           {"2018-05-17 14:03:59", ""},
                                           {"yesterday evening  ", ""},
                                           {"2018:05:17 14:03:59 ", ""}};
    struct variant v = PLAIN;
    for (size_t k = 0; k < sizeof times / sizeof *times; k++) {
        struct photo photo;
        TIFF *tiff = TIFFOpen(place("time.tif"), "w");
        write_tags(tiff, &v);
        TIFFSetField(tiff, TIFFTAG_DATETIME, times[k][0]);
        write_strips(tiff, &v);
        TIFFClose(tiff);
        check_done(photo_read(place("time.tif"), &(struct photo_request){0}, &photo));
        assert_string_equal(photo.taken, times[k][1]);
        photo_free(&photo);
    }
}

/* One tag more or other than a plain photo has. */
static void assert_tag_refused(uint32_t tag, int value, const char *word)
{
    struct variant v = PLAIN;
    char *path = place("tag.tif");
    TIFF *tiff = TIFFOpen(path, "w");
    write_tags(tiff, &v);
    if (tag == TIFFTAG_PHOTOMETRIC && value == PHOTOMETRIC_PALETTE) {
        static uint16_t map[65536];
        TIFFSetField(tiff, TIFFTAG_COLORMAP, map, map, map);
    }
    TIFFSetField(tiff, tag, value);
    write_strips(tiff, &v);
    TIFFClose(tiff);
    assert_refused(path, NULL, word);
}

static void test_refused_tags(void **unused)
{
    (void)unused;
    assert_tag_refused(TIFFTAG_SAMPLEFORMAT, SAMPLEFORMAT_INT, "unsigned");
    assert_tag_refused(TIFFTAG_SAMPLEFORMAT, SAMPLEFORMAT_IEEEFP, "unsigned");
    assert_tag_refused(TIFFTAG_ORIENTATION, ORIENTATION_RIGHTTOP, "upright");
    assert_tag_refused(TIFFTAG_PHOTOMETRIC, PHOTOMETRIC_PALETTE, "neither grey nor RGB");
}

static void test_refused_depths(void **unused)
{
    (void)unused;
    static const int depths[] = {1, 4, 12, 32};
    for (int k = 0; k < 4; k++) {
        char *path = place("depth.tif");
        struct variant v = PLAIN;
        unsigned char row[WIDTH * 4] = {0};
        v.bits = depths[k];
        TIFF *tiff = TIFFOpen(path, "w");
        write_tags(tiff, &v);
        for (int y = 0; y < HEIGHT; y++)
            TIFFWriteScanline(tiff, row, (uint32_t)y, 0);
        TIFFClose(tiff);
        assert_refused(path, NULL, "bits per sample");
    }
}

static void test_refused_pages(void **unused)
{
    (void)unused;
    struct variant v = PLAIN;
    char *path = write_variant("pages.tif", &v);
    TIFF *tiff = TIFFOpen(path, "a");
    write_tags(tiff, &v);
    write_strips(tiff, &v);
    TIFFClose(tiff);
    assert_refused(path, NULL, "more than one page");
}

static void write_bytes(const char *path, const void *bytes, size_t length)
{
    FILE *stream = fopen(path, "wb");
    assert_non_null(stream);
    assert_int_equal(fwrite(bytes, 1, length, stream), length);
    fclose(stream);
}

static void test_refused_files(void **unused)
{
    (void)unused;
    assert_refused(place("absent.tif"), NULL, "cannot be opened");
    assert_refused(folder, NULL, "not a file");
    write_bytes(place("empty.tif"), "", 0);
    assert_refused(place("empty.tif"), NULL, "0 bytes");
    write_bytes(place("text.tif"), "hello, I am a photo", 19);
    assert_refused(place("text.tif"), NULL, "not a TIFF");
    write_bytes(place("short.tif"), "II", 2);
    assert_refused(place("short.tif"), NULL, "not a TIFF");
    write_bytes(place("header.tif"), "II*\0\10\0\0\0", 8);
    assert_refused(place("header.tif"), NULL, "copy the photo again");
}

/* Every cut of a file whose directory is at the end. */
static void test_cut_at_end(void **unused)
{
    (void)unused;
    struct variant v = PLAIN;
    char *path = write_variant("cut.tif", &v);
    struct stat status;
    assert_int_equal(stat(path, &status), 0);
    for (long size = status.st_size - 1; size > 0; size -= 97) {
        assert_int_equal(truncate(path, size), 0);
        assert_refused(path, NULL, "");
    }
}

/* ---- directory first, by hand: little-endian classic TIFF, one strip ---- */

static size_t entry(unsigned char *at, unsigned tag, unsigned type, unsigned value)
{
    unsigned char bytes[12] = {(unsigned char)tag, (unsigned char)(tag >> 8), (unsigned char)type, 0, 1};
    for (int k = 0; k < 4; k++)
        bytes[8 + k] = (unsigned char)(value >> (8 * k));
    memcpy(at, bytes, 12);
    return 12;
}

static size_t hand_made(unsigned char *file, unsigned width, unsigned height, unsigned strip_bytes, unsigned coding)
{
    enum { ENTRIES = 9, DATA = 8 + 2 + 12 * ENTRIES + 4 };
    size_t n = 10;
    memcpy(file, "II*\0\10\0\0\0\11\0", 10);
    n += entry(file + n, 256, 4, width);
    n += entry(file + n, 257, 4, height);
    n += entry(file + n, 258, 3, 16);
    n += entry(file + n, 259, 3, coding);
    n += entry(file + n, 262, 3, 1);
    n += entry(file + n, 273, 4, DATA);
    n += entry(file + n, 277, 3, 1);
    n += entry(file + n, 278, 4, height);
    n += entry(file + n, 279, 4, strip_bytes);
    memset(file + n, 0, 4);
    return n + 4;
}

static void test_directory_first(void **unused)
{
    (void)unused;
    unsigned char file[400] = {0};
    char *path = place("first.tif");
    struct photo photo;
    struct photo_request any = {0};
    size_t header = hand_made(file, 5, 7, 70, 1), length = header + 70;
    for (size_t k = header; k < length; k++)
        file[k] = (unsigned char)k;
    write_bytes(path, file, length);
    check_done(photo_read(path, &any, &photo));
    for (int k = 0; k < 35; k++)
        assert_int_equal(photo.pixels[k], file[header + 2 * (size_t)k] | file[header + 2 * (size_t)k + 1] << 8);
    photo_free(&photo);
    for (size_t cut = 1; cut < length; cut++) {
        write_bytes(path, file, length - cut);
        assert_refused(path, NULL, "");
    }
    hand_made(file, 5, 7, 0, 1); /* the byte count 0 is an old way to say "the rest of the file" */
    write_bytes(path, file, length);
    check_done(photo_read(path, &any, &photo));
    assert_int_equal(photo.pixels[34], file[length - 2] | file[length - 1] << 8);
    photo_free(&photo);
    write_bytes(path, file, length - 1);
    assert_refused(path, NULL, "");
}

static char *file_bytes(const char *path, size_t *length)
{
    FILE *stream = fopen(path, "rb");
    assert_non_null(stream);
    fseek(stream, 0, SEEK_END);
    *length = (size_t)ftell(stream);
    rewind(stream);
    char *bytes = malloc(*length + 1);
    assert_int_equal(fread(bytes, 1, *length, stream), *length);
    fclose(stream);
    return bytes;
}

/* The byte count of one of several plain strips says less than its rows need. */
static void test_short_plain_strip(void **unused)
{
    (void)unused;
    struct variant v = PLAIN;
    char *path = write_variant("strips.tif", &v), *found = NULL;
    const uint16_t counts[] = {1120, 1120, 1120, 1120, 1120, 1120, 700};
    size_t length;
    char *bytes = file_bytes(path, &length);
    for (size_t k = 0; k + sizeof counts <= length && !found; k++)
        if (!memcmp(bytes + k, counts, sizeof counts))
            found = bytes + k;
    assert_non_null(found);
    const uint16_t less = 1118;
    memcpy(found + 6, &less, 2);
    write_bytes(path, bytes, length);
    assert_refused(path, NULL, "strip 3 is short");
    free(bytes);
}

/* A Deflate or LZW strip that ends early is an error and not a photo with a black foot. */
static void test_short_coded_strip(void **unused)
{
    (void)unused;
    static const int codings[] = {COMPRESSION_LZW, COMPRESSION_ADOBE_DEFLATE};
    for (int k = 0; k < 2; k++) {
        struct variant v = PLAIN;
        v.compression = codings[k];
        v.rows = HEIGHT;
        char *path = write_variant("coded.tif", &v), *cut = place("coded-cut.tif");
        TIFF *tiff = TIFFOpen(path, "r");
        uint32_t stored = (uint32_t)TIFFRawStripSize(tiff, 0);
        unsigned char *file = malloc(stored + 400);
        assert_int_equal(TIFFReadRawStrip(tiff, 0, file + 122, stored), stored);
        TIFFClose(tiff);
        size_t header = hand_made(file, WIDTH, HEIGHT, stored, (unsigned)codings[k]);
        assert_int_equal(header, 122);
        write_bytes(cut, file, header + stored);
        struct photo photo;
        struct photo_request any = {0};
        check_done(photo_read(cut, &any, &photo));
        photo_free(&photo);
        for (uint32_t less = 50; less < stored; less += 501) {
            hand_made(file, WIDTH, HEIGHT, stored - less, (unsigned)codings[k]);
            write_bytes(cut, file, header + stored - less);
            assert_refused(cut, NULL, "strip 0 cannot be decoded");
        }
        free(file);
    }
}

/* Sizes that nobody has are refused by the header: the program's memory does not grow. */
static void test_absurd_sizes(void **unused)
{
    (void)unused;
    static const unsigned sizes[][2] = {{0, 7},          {7, 0},         {0xFFFFFFFF, 0xFFFFFFFF},
                                        {0x80000000, 1}, {65536, 65536}, {32000, 32000}};
    for (int coding = 1; coding <= 8; coding += 7)
        for (int k = 0; k < 6; k++) {
            unsigned char file[400] = {0};
            size_t length = hand_made(file, sizes[k][0], sizes[k][1], 200, (unsigned)coding) + 200;
            struct rusage before, after;
            getrusage(RUSAGE_SELF, &before);
            write_bytes(place("absurd.tif"), file, length);
            assert_refused(place("absurd.tif"), NULL, "");
            getrusage(RUSAGE_SELF, &after);
            check_at_most((double)(after.ru_maxrss - before.ru_maxrss), 16384); /* kB; the last one claims 2 GB */
        }
}

/* ---- writing ---- */

static void test_write(void **unused)
{
    (void)unused;
    struct photo photo, read;
    struct photo_request any = {0};
    size_t length[2];
    char *bytes[2];
    check_done(photo_alloc(&photo, 613, 1033)); /* several strips, an odd last one */
    for (size_t k = 0; k < 613 * 1033; k++)
        photo.pixels[k] = (uint16_t)(k * 40503 + (k >> 9));
    check_done(photo_write(place("written.tif"), &photo));
    check_done(photo_write(place("again.tif"), &photo));
    check_done(photo_read(place("written.tif"), &any, &read));
    assert_int_equal(read.bits, 16);
    assert_memory_equal(read.pixels, photo.pixels, 613 * 1033 * 2);
    bytes[0] = file_bytes(place("written.tif"), &length[0]);
    bytes[1] = file_bytes(place("again.tif"), &length[1]);
    assert_int_equal(length[0], length[1]);
    assert_memory_equal(bytes[0], bytes[1], length[0]);
    free(bytes[0]);
    free(bytes[1]);
    photo_free(&read);
    assert_int_equal(photo_write(place("absent/a.tif"), &photo), -1);
    assert_int_equal(error_status(), EXIT_FAILED);
    photo_free(&photo);
    assert_int_equal(photo_alloc(&photo, 0, 5), -1);
    assert_int_equal(photo_alloc(&photo, 65536, 65536), -1);
    photo_free(&photo);
}

static void test_full_disk(void **unused)
{
    (void)unused;
    char *small = place("small"), path[300];
    mkdir(small, 0700);
    if (mount("tmpfs", small, "tmpfs", 0, "size=256k")) {
        rmdir(small);
        print_message("skipped: a small file system cannot be mounted here\n");
        skip();
    }
    struct photo photo;
    uint64_t state = 1;
    check_done(photo_alloc(&photo, 512, 512));
    for (size_t k = 0; k < 512 * 512; k++)
        photo.pixels[k] = (uint16_t)(65536 * check_uniform(&state));
    snprintf(path, sizeof path, "%s/full.tif", small);
    assert_int_equal(photo_write(path, &photo), -1);
    assert_int_equal(error_status(), EXIT_FAILED);
    assert_int_equal(rmdir(small), -1); /* a mount point; and empty: */
    DIR *listing = opendir(small);
    int entries = 0;
    while (readdir(listing))
        entries++;
    closedir(listing);
    assert_int_equal(entries, 2);
    photo_free(&photo);
    umount(small);
    rmdir(small);
}

static int make_folder(void **unused)
{
    (void)unused;
    TIFFSetWarningHandler(NULL);
    return mkdtemp(folder) ? 0 : -1;
}

static int remove_folder(void **unused)
{
    (void)unused;
    char command[300];
    snprintf(command, sizeof command, "umount '%s/small' 2>/dev/null; rm -rf '%s'", folder, folder);
    return system(command);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_grey),
        cmocka_unit_test(test_white_is_zero),
        cmocka_unit_test(test_rgb),
        cmocka_unit_test(test_refused_formats),
        cmocka_unit_test(test_refused_tags),
        cmocka_unit_test(test_time),
        cmocka_unit_test(test_refused_depths),
        cmocka_unit_test(test_refused_pages),
        cmocka_unit_test(test_refused_files),
        cmocka_unit_test(test_cut_at_end),
        cmocka_unit_test(test_directory_first),
        cmocka_unit_test(test_short_coded_strip),
        cmocka_unit_test(test_short_plain_strip),
        cmocka_unit_test(test_absurd_sizes),
        cmocka_unit_test(test_write),
        cmocka_unit_test(test_full_disk),
    };
    return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
