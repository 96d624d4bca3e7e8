/* Which bytes were read: those that are hashed, whatever happens to the file's name meanwhile. */
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "pipeline/files/input_file.h"
#include "pipeline/files/read_record.h"
#include "pipeline/files/sha256.h"
#include "pipeline/speak/error.h"
#include "tests/check.h"

static void put(const char *path, const char *content)
{
    FILE *file = fopen(path, "w");
    assert_non_null(file);
    assert_true(fputs(content, file) >= 0);
    assert_int_equal(fclose(file), 0);
}

/* Another time, so that a change in place shows whatever the clock of the file system. */
static void put_later(const char *path, const char *content)
{
    put(path, content);
    struct timespec times[2] = {{.tv_nsec = UTIME_OMIT}, {.tv_sec = 1000000000}};
    assert_int_equal(utimensat(AT_FDCWD, path, times, 0), 0);
}

static void assert_digest(const char *digest, const char *content)
{
    char wanted[65];
    assert_int_equal(text_sha256(content, wanted), 0);
    assert_string_equal(digest, wanted);
}

static char folder[] = "/tmp/read-record-XXXXXX";

static void path_of(char path[200], const char *name)
{
    snprintf(path, 200, "%s/%s", folder, name);
}

static void read_whole(const char *path, const char *content)
{
    char text[100] = "";
    FILE *file = input_file_open(path, 0);
    assert_non_null(file);
    assert_int_equal(fread(text, 1, sizeof text - 1, file), strlen(content));
    assert_string_equal(text, content);
    fclose(file);
}

static void a_replaced_file_is_named_by_what_was_read(void **state)
{
    char path[200], other[200], digest[65];
    (void)state;
    path_of(path, "photo"), path_of(other, "other");
    put(path, "the photo that was read");
    read_whole(path, "the photo that was read");
    put(other, "another photo");
    assert_int_equal(rename(other, path), 0);
    assert_int_equal(read_record_digest(path, digest), 0);
    assert_digest(digest, "the photo that was read");
}

static void a_file_that_changes_in_place_is_an_error(void **state)
{
    char path[200], digest[65];
    (void)state;
    path_of(path, "grows");
    put(path, "first");
    read_whole(path, "first");
    put_later(path, "second");
    assert_int_equal(read_record_digest(path, digest), -1);
    assert_int_equal(error_status(), EXIT_INPUT);
    assert_non_null(strstr(error_message(), "changed while it was read"));
}

static void two_readings_of_one_name_are_of_one_content(void **state)
{
    char path[200], other[200];
    (void)state;
    path_of(path, "twice"), path_of(other, "other");
    put(path, "one");
    read_whole(path, "one");
    read_whole(path, "one");
    put(other, "two");
    assert_int_equal(rename(other, path), 0);
    assert_null(input_file_open(path, 0));
    assert_non_null(strstr(error_message(), "changed while it was read"));
}

static void a_file_that_was_not_read_is_hashed_as_it_lies_there(void **state)
{
    char path[200], digest[65];
    (void)state;
    path_of(path, "unread");
    put(path, "nobody has opened this");
    assert_int_equal(read_record_digest(path, digest), 0);
    assert_digest(digest, "nobody has opened this");
}

static int begin(void **state)
{
    (void)state;
    read_record_begin();
    return mkdtemp(folder) ? 0 : -1;
}

static int end(void **state)
{
    static const char *const names[] = {"photo", "other", "grows", "twice", "unread"};
    char path[200];
    (void)state;
    for (int k = 0; k < 5; k++) {
        path_of(path, names[k]);
        unlink(path);
    }
    return rmdir(folder);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_replaced_file_is_named_by_what_was_read),
        cmocka_unit_test(a_file_that_changes_in_place_is_an_error),
        cmocka_unit_test(two_readings_of_one_name_are_of_one_content),
        cmocka_unit_test(a_file_that_was_not_read_is_hashed_as_it_lies_there),
    };
    return cmocka_run_group_tests(tests, begin, end);
}
