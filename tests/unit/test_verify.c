/* report verify: whose inputs are as recorded, and what a stranger's file may write into that list. */
#include "tests/check.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include <hdf5.h>

#include "pipeline/speak/error.h"
#include "pipeline/packing/grains.h"
#include "pipeline/scene/scene.h"
#include "pipeline/state/state.h"
#include "report/compare/verify.h"

static char folder[] = "/tmp/test_verify.XXXXXX";
static char inner[64], input[96], state_path[96];

static void put(const char *path, const char *text)
{
    FILE *file = fopen(path, "w");
    assert_non_null(file);
    fputs(text, file);
    fclose(file);
}

static void make_state(void)
{
    static const char *const names[] = {"x_px", "y_px", "radius_px", "flags", NULL};
    const char *inputs[] = {input};
    struct photo_grains grains = {0};
    struct provenance provenance = PROVENANCE_DEFAULT;
    provenance.stage = "findgrains";
    provenance.coordinates = "seen";
    provenance.input_paths = inputs;
    provenance.input_count = 1;
    check_done(table_alloc(&PHOTO_GRAINS, &grains, 1, names));
    struct state_writer *writer = state_create(state_path, &provenance);
    assert_non_null(writer);
    check_done(state_write(writer, "grains", &PHOTO_GRAINS, &grains));
    check_done(state_commit(writer));
    table_free(&PHOTO_GRAINS, &grains);
}

/* The state with another list of inputs; NULL: with none. */
static void set_inputs(const char *text)
{
    make_state();
    hid_t file = H5Fopen(state_path, H5F_ACC_RDWR, H5P_DEFAULT), space = H5Screate(H5S_SCALAR);
    assert_true(H5Adelete(file, "inputs") >= 0);
    if (text) {
        hid_t type = H5Tcopy(H5T_C_S1);
        H5Tset_size(type, strlen(text) + 1);
        hid_t attribute = H5Acreate2(file, "inputs", type, space, H5P_DEFAULT, H5P_DEFAULT);
        assert_true(H5Awrite(attribute, type, text) >= 0);
        H5Aclose(attribute), H5Tclose(type);
    }
    H5Sclose(space), H5Fclose(file);
}

/* What is said of two copies of the state, to be freed. */
static char *verify_twice(struct verify_count *found)
{
    char *const paths[] = {state_path, state_path};
    char *text = NULL;
    size_t length = 0;
    FILE *stream = open_memstream(&text, &length);
    struct scene scene = {.folder = folder};
    check_done(verify_files(&scene, paths, 2, stream, found));
    fclose(stream);
    return text;
}

static void test_as_recorded(void **unused)
{
    (void)unused;
    struct verify_count found;
    make_state();
    char *text = verify_twice(&found);
    assert_string_equal(text, "");
    assert_int_equal(found.inputs, 2);
    assert_int_equal(found.wrong, 0);
    free(text);
    put(input, "other");
    text = verify_twice(&found);
    assert_int_equal(found.wrong, 2);
    assert_non_null(strstr(text, "is not what the file was made from"));
    free(text);
    put(input, "abc");
}

/* Each of both files is named, and says what is wrong. */
static void check_complaint(const char *inputs, const char *word)
{
    struct verify_count found;
    set_inputs(inputs);
    char *text = verify_twice(&found), *second = strchr(text, '\n');
    assert_int_equal(found.files, 2);
    assert_int_equal(found.wrong, 2);
    assert_non_null(second);
    if (strncmp(text, state_path, strlen(state_path)) || !strstr(text, word) || !strstr(second, word))
        fail_msg("'%s' is not in: %s", word, text);
    free(text);
}

static void test_nothing_recorded(void **unused)
{
    (void)unused;
    check_complaint(NULL, "records no inputs");
    check_complaint("[]", "records no inputs");
    check_complaint("5", "records no inputs");
    check_complaint("{}", "records no inputs");
    check_complaint("[5]", "not readable");
    check_complaint("[{\"name\": \"input\"}]", "not readable");
}

#define DIGEST "\"sha256\": \"0000000000000000000000000000000000000000000000000000000000000000\"}]"

/* Names lead nowhere else: not to devices that never end, not to files beside the folder, not to the terminal. */
static void test_names_of_strangers(void **unused)
{
    (void)unused;
    check_complaint("[{\"name\": \"../../../../../dev/zero\", " DIGEST, "not readable");
    check_complaint("[{\"name\": \"/dev/zero\", " DIGEST, "not readable");
    check_complaint("[{\"name\": \"..\", " DIGEST, "not readable");
    check_complaint("[{\"name\": \"\", " DIGEST, "not readable");
    check_complaint("[{\"name\": \"..%2F..%2Fdev%2Fzero\", " DIGEST, "not readable");
    check_complaint("[{\"name\": \"%2E%2E\", " DIGEST, "not readable");
    check_complaint("[{\"name\": \"\\u001b[31mred\", " DIGEST, ": ?[31mred is not there any more");
    check_complaint("[{\"name\": \"\xc2\x9b"
                    "31mred\", " DIGEST,
                    ": ?31mred is not there any more");
    check_complaint("[{\"name\": \"absent\", " DIGEST, "is not there any more");
    char link[96];
    snprintf(link, sizeof link, "%s/zero", inner);
    assert_int_equal(symlink("/dev/zero", link), 0);
    check_complaint("[{\"name\": \"zero\", " DIGEST, "is a pipe or a device");
}

static int make_folder(void **unused)
{
    (void)unused;
    if (!mkdtemp(folder))
        return -1;
    snprintf(inner, sizeof inner, "%s/inner", folder);
    snprintf(input, sizeof input, "%s/input", inner);
    snprintf(state_path, sizeof state_path, "%s/0000.grains.hdf", inner);
    if (mkdir(inner, 0700))
        return -1;
    put(input, "abc");
    return 0;
}

static int remove_folder(void **unused)
{
    (void)unused;
    char command[300];
    snprintf(command, sizeof command, "rm -rf '%s'", folder);
    return system(command);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_as_recorded),
        cmocka_unit_test(test_nothing_recorded),
        cmocka_unit_test(test_names_of_strangers),
    };
    return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
