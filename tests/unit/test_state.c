/* State files: what is written comes back, equal runs give equal bytes, nothing half-written stays, and files that
 * are not what they claim are refused before anything is read. Hostile files are made with HDF5 directly. */
#include "tests/check.h"

#include <dirent.h>
#include <fcntl.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mount.h>
#include <sys/stat.h>
#include <unistd.h>

#include <hdf5.h>

#include "pipeline/speak/version.h"
#include "pipeline/speak/error.h"
#include "pipeline/packing/grains.h"
#include "pipeline/state/state.h"
#include "pipeline/packing/walls.h"
#include "pipeline/files/sha256.h"

/* HDF5 1.10.8 itself keeps a block when it meets a damaged file. */
const char *__lsan_default_suppressions(void);
const char *__lsan_default_suppressions(void)
{
    return "leak:libhdf5";
}

static char folder[] = "/tmp/test_state.XXXXXX";

static char *place(const char *name)
{
    static char path[4][256];
    static int next;
    next = (next + 1) % 4;
    snprintf(path[next], sizeof path[next], "%s/%s", folder, name);
    return path[next];
}

static int files_in(const char *where)
{
    int count = 0;
    DIR *listing = opendir(where);
    assert_non_null(listing);
    for (struct dirent *entry; (entry = readdir(listing));)
        count += strcmp(entry->d_name, ".") && strcmp(entry->d_name, "..");
    closedir(listing);
    return count;
}

static void make_grains(struct grains *grains, size_t rows)
{
    static const char *const names[] = {"x", "y", "radius", "mass", "inertia", "flags", NULL};
    check_done(table_alloc(&GRAINS, grains, rows, names));
    for (size_t k = 0; k < rows; k++) {
        grains->x[k] = 1e-3 * (double)k;
        grains->y[k] = k % 7 ? -1.0 / (double)(k + 1) : NAN;
        grains->radius[k] = 4e-3;
        grains->flags[k] = (uint32_t)k & 0xF00FF;
    }
}

static int write_grains(const char *path, const struct grains *grains)
{
    const char *inputs[] = {FILM_SOURCE_DIR "/CMakeLists.txt"};
    struct provenance provenance = PROVENANCE_DEFAULT;
    provenance.stage = "contacts";
    provenance.parameters = "{\"lambda\":1}";
    provenance.input_paths = inputs;
    provenance.input_count = 1;
    provenance.index = 12;
    provenance.time_s = 60;
    provenance.coordinates = "si";
    provenance.strain[0] = 0.25;
    provenance.length_m = 0.06;
    struct state_writer *writer = state_create(path, &provenance);
    double stress[4] = {1, 2, 3, 4}, kn = 1.5;
    if (!writer)
        return -1;
    if (state_write(writer, "grains", &GRAINS, grains) ||
        state_write_numbers(writer, "forces/qsm", "stress", stress, 4) ||
        state_write_numbers(writer, "forces/qsm", "kn", &kn, 1) ||
        state_write_text(writer, "forces/qsm", "start", "zero") ||
        state_write_text(writer, "forces/cem", "start", "")) {
        state_discard(writer);
        return -1;
    }
    return state_commit(writer);
}

static void read_back(const char *path, size_t rows)
{
    struct grains grains;
    static const char *const required[] = {"x", "flags", NULL};
    struct state *state = state_open(path);
    assert_non_null(state);
    check_done(state_read(state, "grains", &GRAINS, required, &grains));
    assert_int_equal(grains.count, rows);
    assert_null(grains.s_x);
    for (size_t k = 0; k < rows; k++) {
        check_near(grains.x[k], 1e-3 * (double)k, 0);
        if (k % 7)
            check_near(grains.y[k], -1.0 / (double)(k + 1), 0);
        else
            assert_true(isnan(grains.y[k]));
        assert_int_equal(grains.flags[k], (uint32_t)k & 0xF00FF);
    }
    table_free(&GRAINS, &grains);
    state_close(state);
}

static void test_round_trip(void **unused)
{
    (void)unused;
    const size_t sizes[] = {0, 1, 500, 200000}; /* none, one, one chunk, several */
    for (size_t s = 0; s < 4; s++) {
        struct grains grains;
        make_grains(&grains, sizes[s]);
        check_done(write_grains(place("round.hdf"), &grains));
        read_back(place("round.hdf"), sizes[s]);
        table_free(&GRAINS, &grains);
    }
    assert_int_equal(files_in(folder), 1);
}

static void test_attributes(void **unused)
{
    (void)unused;
    struct grains grains;
    make_grains(&grains, 3);
    check_done(write_grains(place("attributes.hdf"), &grains));
    table_free(&GRAINS, &grains);
    struct state *state = state_open(place("attributes.hdf"));
    struct state_info info;
    check_done(state_read_info(state, &info));
    assert_string_equal(info.stage, "contacts");
    assert_string_equal(info.coordinates, "si");
    assert_string_equal(info.program_version, film_version);
    assert_string_equal(info.parameters, "{\"lambda\":1}");
    assert_non_null(strstr(info.inputs, "\"name\":\"CMakeLists.txt\""));
    assert_int_equal(info.index, 12);
    check_near(info.time_s, 60, 0);
    check_near(info.length_m, 0.06, 0);
    check_near(info.strain[0], 0.25, 0);
    assert_true(isnan(info.strain[1]));
    state_info_free(&info);

    double stress[4] = {0}, kn = 0;
    char text[16] = "kept";
    check_done(state_read_numbers(state, "forces/qsm", "stress", stress, 4));
    check_near(stress[3], 4, 0);
    check_done(state_read_numbers(state, "forces/qsm", "kn", &kn, 1));
    check_near(kn, 1.5, 0);
    assert_int_equal(state_read_text(state, "forces/qsm", "absent", text, sizeof text), 1);
    assert_string_equal(text, "kept");
    check_done(state_read_text(state, "forces/qsm", "start", text, sizeof text));
    assert_string_equal(text, "zero");
    check_done(state_read_text(state, "forces/cem", "start", text, sizeof text));
    assert_string_equal(text, "");
    assert_int_equal(state_read_numbers(state, "forces/qsm", "stress", stress, 3), -1);
    assert_int_equal(state_read_text(state, "forces/qsm", "start", text, 4), -1);

    char **names;
    size_t count;
    check_done(state_list(state, "forces", &names, &count));
    assert_int_equal(count, 2);
    assert_string_equal(names[0], "cem");
    assert_string_equal(names[1], "qsm");
    free(names);
    check_done(state_list(state, "nothing", &names, &count));
    assert_int_equal(count, 0);
    free(names);
    assert_int_equal(state_has(state, "forces/qsm"), 1);
    assert_int_equal(state_has(state, "forces/map"), 0);
    state_close(state);
}

/* A text beyond the 64 kB of an object header. */
static void test_long_text(void **unused)
{
    (void)unused;
    size_t length = 100000;
    char *text = malloc(length + 1);
    memset(text, 'a', length);
    text[length] = '\0';
    struct provenance provenance = PROVENANCE_DEFAULT;
    provenance.stage = "report";
    provenance.parameters = text;
    struct state_writer *writer = state_create(place("long.hdf"), &provenance);
    assert_non_null(writer);
    check_done(state_commit(writer));
    struct state *state = state_open(place("long.hdf"));
    struct state_info info;
    check_done(state_read_info(state, &info));
    assert_string_equal(info.parameters, text);
    state_info_free(&info);
    state_close(state);
    free(text);
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

static void test_equal_bytes(void **unused)
{
    (void)unused;
    struct grains grains;
    size_t length[2];
    char *bytes[2];
    make_grains(&grains, 1000);
    check_done(write_grains(place("first.hdf"), &grains));
    sleep(1); /* object times have a resolution of a second */
    check_done(write_grains(place("second.hdf"), &grains));
    table_free(&GRAINS, &grains);
    bytes[0] = file_bytes(place("first.hdf"), &length[0]);
    bytes[1] = file_bytes(place("second.hdf"), &length[1]);
    assert_int_equal(length[0], length[1]);
    assert_memory_equal(bytes[0], bytes[1], length[0]);
    free(bytes[0]);
    free(bytes[1]);
}

/* The file as other HDF5 readers see it. */
static void test_layout(void **unused)
{
    (void)unused;
    struct grains grains;
    make_grains(&grains, 9);
    check_done(write_grains(place("layout.hdf"), &grains));
    table_free(&GRAINS, &grains);
    hid_t file = H5Fopen(place("layout.hdf"), H5F_ACC_RDONLY, H5P_DEFAULT);
    hid_t column = H5Dopen2(file, "/grains/flags", H5P_DEFAULT), plist = H5Dget_create_plist(column);
    assert_int_equal(H5Pget_nfilters(plist), 1);
    assert_true(H5Pget_filter_by_id2(plist, H5Z_FILTER_FLETCHER32, NULL, NULL, NULL, 0, NULL, NULL) >= 0);
    assert_true(H5Aexists(column, "units") > 0 && H5Aexists(column, "long_name") > 0);
    hid_t attribute = H5Aopen(column, "flag_names", H5P_DEFAULT), type = H5Aget_type(attribute);
    char names[32][16];
    assert_int_equal(H5Tget_size(type), 16);
    assert_int_equal(H5Tget_strpad(type), H5T_STR_NULLPAD);
    assert_true(H5Aread(attribute, type, names) >= 0);
    assert_string_equal(names[18], "rattler");
    assert_string_equal(names[31], "");
    H5Tclose(type);
    H5Aclose(attribute);
    H5Pclose(plist);
    H5Dclose(column);
    H5Fclose(file);
}

static void test_names(void **unused)
{
    (void)unused;
    struct walls walls = {0}, read;
    struct provenance provenance = PROVENANCE_DEFAULT;
    provenance.stage = "contacts";
    check_done(table_alloc(&WALLS, &walls, 2, NULL));
    memcpy(walls.name[0], "bottom", 6);
    memcpy(walls.name[1], "sixteen-letters!", 16);
    struct state_writer *writer = state_create(place("names.hdf"), &provenance);
    check_done(state_write(writer, "walls", &WALLS, &walls));
    check_done(state_commit(writer));
    struct state *state = state_open(place("names.hdf"));
    check_done(state_read(state, "walls", &WALLS, NULL, &read));
    assert_memory_equal(read.name[0], walls.name[0], 16);
    assert_memory_equal(read.name[1], walls.name[1], 16);
    state_close(state);
    table_free(&WALLS, &walls);
    table_free(&WALLS, &read);
}

/* ---- files that must be refused ---- */

static hid_t hostile_file(const char *path, const char *schema, int64_t version)
{
    hid_t file = H5Fcreate(path, H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
    hid_t scalar = H5Screate(H5S_SCALAR), text = H5Tcopy(H5T_C_S1);
    H5Tset_size(text, strlen(schema) + 1);
    hid_t attribute = H5Acreate2(file, "schema", text, scalar, H5P_DEFAULT, H5P_DEFAULT);
    H5Awrite(attribute, text, schema);
    H5Aclose(attribute);
    attribute = H5Acreate2(file, "schema_version", H5T_STD_I64LE, scalar, H5P_DEFAULT, H5P_DEFAULT);
    H5Awrite(attribute, H5T_NATIVE_INT64, &version);
    H5Aclose(attribute);
    H5Sclose(scalar);
    H5Tclose(text);
    H5Gclose(H5Gcreate2(file, "/grains", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT));
    return file;
}

static void put_column(hid_t file, const char *name, hid_t type, int rank, hsize_t rows, int write)
{
    hsize_t dims[2] = {rows, 2};
    static double zeros[2000];
    hid_t space = H5Screate_simple(rank, dims, NULL), plist = H5Pcreate(H5P_DATASET_CREATE);
    hid_t column;
    if (!write) { /* chunks that are never allocated: a small file that claims much */
        hsize_t chunk = 5;
        H5Pset_chunk(plist, 1, &chunk);
    }
    column = H5Dcreate2(file, name, type, space, H5P_DEFAULT, plist, H5P_DEFAULT);
    if (write)
        H5Dwrite(column, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, zeros);
    H5Dclose(column);
    H5Pclose(plist);
    H5Sclose(space);
}

static void assert_refused(const char *path, const char *word)
{
    static const char *const required[] = {"x", "y", NULL};
    struct grains grains;
    error_clear();
    struct state *state = state_open(path);
    int result = state ? state_read(state, "grains", &GRAINS, required, &grains) : -1;
    state_close(state);
    assert_int_equal(result, -1);
    assert_int_equal(error_status(), EXIT_INPUT);
    if (!strstr(error_message(), word) || !strstr(error_message(), path))
        fail_msg("'%s' and '%s' are not both in: %s", path, word, error_message());
}

static void test_refused_columns(void **unused)
{
    (void)unused;
    char *path = place("hostile.hdf");
    hid_t file = hostile_file(path, "film.state", 1);
    H5Fclose(file);
    assert_refused(path, "no column /grains/x");

    file = hostile_file(path, "film.state", 1);
    put_column(file, "/grains/x", H5T_IEEE_F32LE, 1, 10, 1);
    H5Fclose(file);
    assert_refused(path, "not float64");

    file = hostile_file(path, "film.state", 1);
    put_column(file, "/grains/x", H5T_IEEE_F64LE, 2, 10, 1);
    H5Fclose(file);
    assert_refused(path, "one-dimensional");

    file = hostile_file(path, "film.state", 1);
    put_column(file, "/grains/x", H5T_IEEE_F64LE, 1, 10, 1);
    put_column(file, "/grains/y", H5T_IEEE_F64LE, 1, 11, 1);
    H5Fclose(file);
    assert_refused(path, "11 rows");

    file = hostile_file(path, "film.state", 1);
    put_column(file, "/grains/x", H5T_IEEE_F64LE, 1, 10, 0);
    H5Fclose(file);
    assert_refused(path, "never written");

    file = hostile_file(path, "film.state", 1);
    put_column(file, "/grains/x", H5T_IEEE_F64LE, 1, (hsize_t)1 << 60, 0);
    H5Fclose(file);
    assert_refused(path, "damaged");

    file = hostile_file(path, "film.state", 1);
    H5Gclose(H5Gcreate2(file, "/grains/x", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT));
    H5Fclose(file);
    assert_refused(path, "not a readable column");
}

static void test_refused_links(void **unused)
{
    (void)unused;
    char *path = place("links.hdf"), *other = place("other.hdf");
    hid_t file = hostile_file(other, "film.state", 1);
    put_column(file, "/grains/x", H5T_IEEE_F64LE, 1, 10, 1);
    H5Fclose(file);
    file = hostile_file(path, "film.state", 1);
    H5Lcreate_external("other.hdf", "/grains/x", file, "/grains/x", H5P_DEFAULT, H5P_DEFAULT);
    H5Fclose(file);
    assert_refused(path, "link");

    file = hostile_file(path, "film.state", 1);
    H5Lcreate_soft("/nowhere", file, "/grains/x", H5P_DEFAULT, H5P_DEFAULT);
    H5Fclose(file);
    assert_refused(path, "link");

    file = hostile_file(path, "film.state", 1); /* raw data in another file */
    hsize_t rows = 4;
    hid_t space = H5Screate_simple(1, &rows, NULL), plist = H5Pcreate(H5P_DATASET_CREATE);
    H5Pset_external(plist, "/etc/passwd", 0, 32);
    hid_t column = H5Dcreate2(file, "/grains/x", H5T_IEEE_F64LE, space, H5P_DEFAULT, plist, H5P_DEFAULT);
    H5Dclose(column);
    H5Pclose(plist);
    H5Sclose(space);
    H5Fclose(file);
    assert_refused(path, "outside");
}

static void test_refused_files(void **unused)
{
    (void)unused;
    char *path = place("refused.hdf");
    H5Fclose(hostile_file(path, "film.state", 2));
    assert_refused(path, "newer");
    H5Fclose(hostile_file(path, "film.state", 0));
    assert_refused(path, "schema_version");
    H5Fclose(hostile_file(path, "other.state", 1));
    assert_refused(path, "other.state");
    FILE *stream = fopen(path, "wb");
    fclose(stream);
    assert_refused(path, "HDF5");
    stream = fopen(path, "wb");
    fputs("not a state file", stream);
    fclose(stream);
    assert_refused(path, "HDF5");
    assert_refused(place("absent.hdf"), "cannot be opened");
}

/* One changed byte in a column's data is found by its checksum; a file cut short is not read. */
static void test_damage(void **unused)
{
    (void)unused;
    struct grains grains;
    size_t length;
    char *path = place("damaged.hdf");
    make_grains(&grains, 1000);
    check_done(write_grains(path, &grains));
    char *bytes = file_bytes(path, &length), *found = NULL;
    for (size_t k = 0; k + 80 < length && !found; k++)
        if (!memcmp(bytes + k, grains.x, 80))
            found = bytes + k;
    assert_non_null(found);
    found[500] ^= 1;
    FILE *stream = fopen(path, "wb");
    fwrite(bytes, 1, length, stream);
    fclose(stream);
    assert_refused(path, "/grains/x is damaged");
    found[500] ^= 1;
    stream = fopen(path, "wb");
    fwrite(bytes, 1, length / 2, stream);
    fclose(stream);
    assert_refused(path, "HDF5");
    free(bytes);
    table_free(&GRAINS, &grains);
}

/* ---- writing that fails ---- */

static void test_discard(void **unused)
{
    (void)unused;
    struct grains grains;
    struct provenance provenance = PROVENANCE_DEFAULT;
    provenance.stage = "contacts";
    make_grains(&grains, 10);
    check_done(write_grains(place("kept.hdf"), &grains));
    int before = files_in(folder);
    struct state_writer *writer = state_create(place("kept.hdf"), &provenance);
    assert_non_null(writer);
    check_done(state_write(writer, "grains", &GRAINS, &grains));
    state_discard(writer);
    state_discard(NULL);
    assert_int_equal(files_in(folder), before);
    read_back(place("kept.hdf"), 10); /* the old file stands */
    table_free(&GRAINS, &grains);
}

static void test_bad_targets(void **unused)
{
    (void)unused;
    struct provenance provenance = PROVENANCE_DEFAULT;
    const char *absent = "/absent/input.tif";
    provenance.stage = "contacts";
    int before = files_in(folder);
    assert_null(state_create(place("no-such-folder/a.hdf"), &provenance));
    assert_int_equal(error_status(), EXIT_FAILED);
    assert_null(state_create(folder, &provenance));
    assert_null(state_create("/dev/null", &provenance));
    provenance.input_paths = &absent;
    provenance.input_count = 1;
    assert_null(state_create(place("unmade.hdf"), &provenance));
    assert_non_null(strstr(error_message(), absent));
    assert_int_equal(files_in(folder), before);
}

/* On a full disk the write fails, whichever HDF5 call notices, and no file appears. */
static void test_full_disk(void **unused)
{
    (void)unused;
    char *small = place("small"), path[300];
    mkdir(small, 0700);
    if (mount("tmpfs", small, "tmpfs", 0, "size=1m")) {
        rmdir(small);
        print_message("skipped: a small file system cannot be mounted here\n");
        skip();
    }
    snprintf(path, sizeof path, "%s/full.hdf", small);
    int failures = 0;
    for (size_t rows = 5000; rows <= 160000; rows *= 2) { /* 0.2 to 7 MB: data cached and not cached by HDF5 */
        struct grains grains;
        make_grains(&grains, rows);
        unlink(path);
        if (write_grains(path, &grains)) {
            failures++;
            assert_int_equal(error_status(), EXIT_FAILED);
            assert_int_equal(files_in(small), 0);
        } else {
            read_back(path, rows);
        }
        table_free(&GRAINS, &grains);
    }
    assert_in_range(failures, 3, 5);
    umount(small);
    rmdir(small);
}

/* "abc": FIPS 180-2, appendix B.1. */
static void test_sha256(void **unused)
{
    (void)unused;
    char digest[65];
    FILE *stream = fopen(place("abc"), "wb");
    fputs("abc", stream);
    fclose(stream);
    check_done(file_sha256(place("abc"), digest));
    assert_string_equal(digest, "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
    assert_int_equal(file_sha256(place("absent"), digest), -1);
    assert_int_equal(file_sha256("/dev/zero", digest), -1); /* has no end */
    assert_int_equal(error_status(), EXIT_INPUT);
    assert_int_equal(mkfifo(place("pipe"), 0600), 0);
    assert_int_equal(file_sha256(place("pipe"), digest), -1);
    assert_int_equal(error_status(), EXIT_INPUT);
    unlink(place("pipe"));
    assert_int_equal(error_status(), EXIT_INPUT);
}

static int make_folder(void **unused)
{
    (void)unused;
    H5Eset_auto2(H5E_DEFAULT, NULL, NULL);
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
        cmocka_unit_test(test_round_trip),    cmocka_unit_test(test_attributes),
        cmocka_unit_test(test_long_text),     cmocka_unit_test(test_equal_bytes),
        cmocka_unit_test(test_layout),        cmocka_unit_test(test_names),
        cmocka_unit_test(test_refused_files), cmocka_unit_test(test_refused_columns),
        cmocka_unit_test(test_refused_links), cmocka_unit_test(test_damage),
        cmocka_unit_test(test_discard),       cmocka_unit_test(test_bad_targets),
        cmocka_unit_test(test_full_disk),     cmocka_unit_test(test_sha256),
    };
    return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
