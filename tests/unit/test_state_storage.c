/* State files whose records lie about their bytes, made with HDF5 directly: a reader that believes them reads or writes
 * memory that is not its own. And harmless files of other programs, which must be read. */
#include "tests/check.h"

#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <unistd.h>
#include <zlib.h>

#include <hdf5.h>

#include "pipeline/speak/error.h"
#include "pipeline/packing/grains.h"
#include "pipeline/state/state.h"

enum { ROWS = 5 };
static char path[] = "/tmp/test_state_storage.XXXXXX";

static int make_place(void **unused)
{
    (void)unused;
    int file = mkstemp(path);
    return file < 0 ? -1 : close(file);
}

static int remove_place(void **unused)
{
    (void)unused;
    return unlink(path);
}

/* A text attribute as h5py writes it: of variable length. */
static void write_text(hid_t object, const char *name, const char *text)
{
    hid_t type = H5Tcopy(H5T_C_S1), space = H5Screate(H5S_SCALAR);
    H5Tset_size(type, H5T_VARIABLE);
    hid_t attribute = H5Acreate2(object, name, type, space, H5P_DEFAULT, H5P_DEFAULT);
    assert_true(H5Awrite(attribute, type, &text) >= 0);
    H5Aclose(attribute);
    H5Sclose(space);
    H5Tclose(type);
}

/* A file with the attributes of a state and an empty group /grains. */
static hid_t begin_file(void)
{
    H5Eset_auto2(H5E_DEFAULT, NULL, NULL);
    hid_t file = H5Fcreate(path, H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
    assert_true(file >= 0);
    write_text(file, "schema", "film.state");
    hid_t space = H5Screate(H5S_SCALAR);
    hid_t attribute = H5Acreate2(file, "schema_version", H5T_STD_I64LE, space, H5P_DEFAULT, H5P_DEFAULT);
    int64_t version = 1;
    H5Awrite(attribute, H5T_NATIVE_INT64, &version);
    H5Aclose(attribute);
    H5Sclose(space);
    H5Gclose(H5Gcreate2(file, "grains", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT));
    return file;
}

/* The column /grains/x in one chunk of `chunk` rows, with what `filter` adds to its properties. */
static hid_t make_column(hid_t file, hsize_t chunk, void (*filter)(hid_t properties))
{
    hsize_t rows = ROWS, most = H5S_UNLIMITED;
    hid_t space = H5Screate_simple(1, &rows, chunk ? &most : NULL), properties = H5Pcreate(H5P_DATASET_CREATE);
    if (chunk)
        H5Pset_chunk(properties, 1, &chunk);
    if (filter)
        filter(properties);
    hid_t dataset = H5Dcreate2(file, "grains/x", H5T_IEEE_F64LE, space, H5P_DEFAULT, properties, H5P_DEFAULT);
    assert_true(dataset >= 0);
    H5Pclose(properties);
    H5Sclose(space);
    return dataset;
}

static const double values[ROWS] = {1, -2, 3.5, 1e300, 0};

static void write_values(hid_t dataset)
{
    assert_true(H5Dwrite(dataset, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values) >= 0);
}

static void end_file(hid_t file, hid_t dataset)
{
    H5Dclose(dataset);
    H5Fclose(file);
}

/* Read /grains; 0 or -1. */
static int read_back(struct grains *grains)
{
    *grains = (struct grains){0};
    error_clear();
    struct state *state = state_open(path);
    int status = state ? state_read(state, "grains", &GRAINS, NULL, grains) : -1;
    state_close(state);
    return status;
}

static void check_refused(const char *words)
{
    struct grains grains;
    assert_int_equal(read_back(&grains), -1);
    assert_int_equal(error_status(), EXIT_INPUT);
    if (!strstr(error_message(), words))
        fail_msg("'%s' does not say '%s'", error_message(), words);
}

static void check_read(void)
{
    struct grains grains;
    check_done(read_back(&grains));
    assert_int_equal(grains.count, ROWS);
    assert_memory_equal(grains.x, values, sizeof values);
    table_free(&GRAINS, &grains);
}

static void gzip(hid_t properties)
{
    H5Pset_deflate(properties, 6);
}

static void everything(hid_t properties)
{
    H5Pset_fletcher32(properties);
    H5Pset_shuffle(properties);
    H5Pset_deflate(properties, 6);
    H5Pset_fletcher32(properties);
}

static void checksum(hid_t properties)
{
    H5Pset_fletcher32(properties);
}

static void nbit(hid_t properties)
{
    H5Pset_nbit(properties);
}

static void scaled(hid_t properties)
{
    H5Pset_scaleoffset(properties, H5Z_SO_FLOAT_DSCALE, 3);
}

static void early(hid_t properties)
{
    H5Pset_alloc_time(properties, H5D_ALLOC_TIME_EARLY);
}

static void test_other_programs(void **unused)
{
    (void)unused;
    static void (*const filters[])(hid_t) = {NULL, gzip, everything, checksum};
    static const hsize_t chunks[] = {0, ROWS, 2, 100000};
    for (size_t f = 0; f < 4; f++)
        for (size_t c = 0; c < 4; c++) {
            if (f && !chunks[c])
                continue; /* filters need chunks */
            hid_t file = begin_file(), dataset = make_column(file, chunks[c], filters[f]);
            write_values(dataset);
            end_file(file, dataset);
            check_read();
        }
}

/* 8 bytes where a chunk has 40: as they are, and in a gzip stream; and a stream of 80. */
static void test_short_chunks(void **unused)
{
    (void)unused;
    unsigned char stream[200];
    static const unsigned char bytes[2 * sizeof values] = {1, 2, 3};
    static const size_t lengths[] = {8, sizeof values - 1, sizeof bytes};
    const hsize_t start = 0;
    for (size_t k = 0; k < 3; k++) {
        uLongf length = sizeof stream;
        assert_int_equal(compress(stream, &length, bytes, lengths[k]), Z_OK);
        hid_t file = begin_file(), dataset = make_column(file, ROWS, gzip);
        assert_true(H5Dwrite_chunk(dataset, H5P_DEFAULT, 0, &start, length, stream) >= 0);
        end_file(file, dataset);
        check_refused("a chunk is not as long as it should be");
    }
    hid_t file = begin_file(), dataset = make_column(file, ROWS, checksum);
    assert_true(H5Dwrite_chunk(dataset, H5P_DEFAULT, 0, &start, 8, bytes) >= 0);
    end_file(file, dataset);
    check_refused("a chunk is not as long as it should be");
    file = begin_file(), dataset = make_column(file, ROWS, gzip); /* said to be without its filter */
    assert_true(H5Dwrite_chunk(dataset, H5P_DEFAULT, 1, &start, 8, bytes) >= 0);
    end_file(file, dataset);
    check_refused("a chunk is not as long as it should be");
}

static void test_other_filters(void **unused)
{
    (void)unused;
    static void (*const filters[])(hid_t) = {nbit, scaled};
    for (size_t f = 0; f < 2; f++) {
        hid_t file = begin_file(), dataset = make_column(file, ROWS, filters[f]);
        write_values(dataset);
        end_file(file, dataset);
        check_refused("has a filter that is not known here");
    }
}

static void test_never_written(void **unused)
{
    (void)unused;
    hid_t file = begin_file();
    end_file(file, make_column(file, 0, early));
    check_refused("was never written completely");
    file = begin_file();
    end_file(file, make_column(file, 2, NULL));
    check_refused("was never written completely");
}

static void test_absurd_chunk(void **unused)
{
    (void)unused;
    static const unsigned char nothing[1000] = {0};
    unsigned char stream[2000];
    uLongf length = sizeof stream;
    const hsize_t start = 0;
    compress(stream, &length, nothing, sizeof nothing);
    hid_t file = begin_file(), dataset = make_column(file, 500000000, gzip);
    assert_true(H5Dwrite_chunk(dataset, H5P_DEFAULT, 0, &start, length, stream) >= 0);
    end_file(file, dataset);
    check_refused("has absurd chunks");
}

/* The one place in the file where these four bytes are followed by the address of a global heap: overwrite them. */
static void forge_length(uint32_t is, uint32_t becomes)
{
    FILE *file = fopen(path, "r+b");
    assert_non_null(file);
    fseek(file, 0, SEEK_END);
    size_t size = (size_t)ftell(file), at = 0;
    unsigned char *bytes = malloc(size);
    rewind(file);
    assert_int_equal(fread(bytes, 1, size, file), size);
    for (at = 0; at + 16 < size; at++) {
        uint32_t length;
        uint64_t heap;
        memcpy(&length, bytes + at, sizeof length);
        memcpy(&heap, bytes + at + 4, sizeof heap);
        if (length == is && heap < size - 4 && !memcmp(bytes + heap, "GCOL", 4))
            break;
    }
    assert_true(at + 16 < size);
    fseek(file, (long)at, SEEK_SET);
    fwrite(&becomes, sizeof becomes, 1, file);
    fclose(file);
    free(bytes);
}

/* A text of 200000 letters whose record says 8: HDF5 1.10 copies all of it into a buffer of 4096. */
static void test_long_text_said_to_be_short(void **unused)
{
    (void)unused;
    enum { LENGTH = 200000 };
    char *text = malloc(LENGTH + 1);
    memset(text, 'A', LENGTH);
    text[LENGTH] = '\0';
    hid_t file = begin_file(), dataset = make_column(file, 0, NULL);
    write_values(dataset);
    write_text(file, "stage", text);
    end_file(file, dataset);
    forge_length(LENGTH, 8);
    check_refused("texts of variable length that cannot be read safely");
    free(text);
}

static void compact(hid_t properties)
{
    H5Pset_layout(properties, H5D_COMPACT);
}

/* A compact column, which lies in the header of its dataset behind its length of two bytes: 40, said to be 16. HDF5
 * 1.10 reads five numbers all the same, three of them from the heap. */
static void test_compact_column_too_short(void **unused)
{
    (void)unused;
    unsigned char record[2 + sizeof values] = {sizeof values, 0}, bytes[1 << 16];
    memcpy(record + 2, values, sizeof values);
    hid_t file = begin_file(), dataset = make_column(file, 0, compact);
    write_values(dataset);
    end_file(file, dataset);
    check_read();
    FILE *stream = fopen(path, "r+b");
    assert_non_null(stream);
    size_t size = fread(bytes, 1, sizeof bytes, stream);
    unsigned char *found = memmem(bytes, size, record, sizeof record);
    assert_non_null(found);
    fseek(stream, found - bytes, SEEK_SET);
    fputc(16, stream);
    fclose(stream);
    check_refused("is shorter than its rows");
}

/* Somebody else holds a lock: files are replaced whole, so it says nothing about this one. */
static void test_locked(void **unused)
{
    (void)unused;
    hid_t file = begin_file(), dataset = make_column(file, ROWS, NULL);
    write_values(dataset);
    end_file(file, dataset);
    int other = open(path, O_RDWR);
    assert_int_equal(flock(other, LOCK_EX | LOCK_NB), 0);
    check_read();
    close(other);
}

static void test_newer_version(void **unused)
{
    (void)unused;
    hid_t file = begin_file(), dataset = make_column(file, ROWS, NULL);
    write_values(dataset);
    hid_t version = H5Aopen(file, "schema_version", H5P_DEFAULT);
    const int64_t two = 2;
    assert_true(H5Awrite(version, H5T_NATIVE_INT64, &two) >= 0);
    H5Aclose(version);
    end_file(file, dataset);
    check_refused("schema_version 2 is newer than this program knows");
}

static void test_linked_methods(void **unused)
{
    (void)unused;
    hid_t file = begin_file(), dataset = make_column(file, 0, NULL);
    write_values(dataset);
    H5Gclose(H5Gcreate2(file, "forces", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT));
    H5Lcreate_soft("/grains", file, "forces/qsm", H5P_DEFAULT, H5P_DEFAULT);
    end_file(file, dataset);
    struct state *state = state_open(path);
    char **names = NULL;
    size_t count = 0;
    assert_non_null(state);
    assert_int_equal(state_list(state, "forces", &names, &count), -1);
    assert_non_null(strstr(error_message(), "has a soft or external link"));
    assert_int_equal(error_status(), EXIT_INPUT);
    state_close(state);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_other_programs), cmocka_unit_test(test_short_chunks),
        cmocka_unit_test(test_other_filters),  cmocka_unit_test(test_never_written),
        cmocka_unit_test(test_absurd_chunk),   cmocka_unit_test(test_long_text_said_to_be_short),
        cmocka_unit_test(test_linked_methods), cmocka_unit_test(test_locked),
        cmocka_unit_test(test_newer_version),  cmocka_unit_test(test_compact_column_too_short),
    };
    return cmocka_run_group_tests_name("state storage", tests, make_place, remove_place);
}
