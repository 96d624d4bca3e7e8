/* What has no end, or is never written, is not read: pipes, devices, folders, files that are too long. */
#include "tests/check.h"

#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "pipeline/speak/error.h"
#include "pipeline/files/input_file.h"
#include "pipeline/files/json.h"
#include "pipeline/packing/loads.h"
#include "pipeline/state/state.h"
#include "pipeline/files/sha256.h"

static const char name[] = "test_input_file.tmp";

/* Every reader of text; none of them waits. */
static void check_refused(const char *path, const char *what)
{
    char digest[65];
    struct walls walls = {0};
    alarm(20);
    assert_null(input_file_open(path, 0));
    assert_non_null(strstr(error_message(), what));
    assert_null(json_read(path));
    assert_non_null(strstr(error_message(), what));
    assert_int_equal(loads_apply(path, 0, 1, &walls), -1);
    assert_non_null(strstr(error_message(), what));
    assert_int_equal(file_sha256(path, digest), -1);
    assert_non_null(strstr(error_message(), what));
    assert_non_null(strstr(error_message(), path));
    assert_int_equal(error_status(), EXIT_INPUT);
    alarm(0);
    error_clear();
}

static void what_has_no_end(void **unused)
{
    (void)unused;
    unlink(name);
    check_refused("no-such-file", "No such file");
    check_refused("/dev/zero", "is a pipe or a device");
    assert_int_equal(symlink("/dev/zero", name), 0);
    check_refused(name, "is a pipe or a device");
    unlink(name);
    assert_int_equal(mkfifo(name, 0600), 0);
    check_refused(name, "is a pipe or a device");
    unlink(name);
    check_refused("/tmp", "is a folder");
}

/* A line that would fill the memory: a file of zeros that takes no room on the disk. */
static void what_is_too_long(void **unused)
{
    (void)unused;
    struct walls walls = {0};
    FILE *file = fopen(name, "w");
    assert_non_null(file);
    assert_int_equal(ftruncate(fileno(file), (off_t)1 << 40), 0);
    fclose(file);
    assert_int_equal(loads_apply(name, 0, 1, &walls), -1);
    assert_non_null(strstr(error_message(), "is this the right file?"));
    assert_null(json_read(name));
    assert_non_null(strstr(error_message(), "is this the right file?"));
    assert_int_equal(truncate(name, 100), 0);
    assert_non_null(file = input_file_open(name, 100));
    fclose(file);
    assert_null(input_file_open(name, 99));
    unlink(name);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(what_has_no_end), cmocka_unit_test(what_is_too_long)};
    return cmocka_run_group_tests_name("input_file", tests, NULL, NULL);
}
