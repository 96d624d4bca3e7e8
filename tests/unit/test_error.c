/* The one line of a failure keeps its reason and its remedy, however long the path in it is. */
#include "tests/check.h"

#include <string.h>

#include "pipeline/speak/error.h"
#include "pipeline/speak/text.h"

static int ends_with(const char *text, const char *end)
{
    return strlen(text) >= strlen(end) && !strcmp(text + strlen(text) - strlen(end), end);
}

static void long_paths(void **unused)
{
    (void)unused;
    char path[5000];
    for (size_t length = 900; length < 4200; length += 7) {
        memset(path, 'p', length);
        for (size_t k = 100; k + 1 < length; k += 2)
            memcpy(path + k, "é", 2);
        path[0] = '/';
        path[length] = '\0';
        assert_int_equal(error_input("%s: cannot be opened: no such file: check the path", path), -1);
        assert_true(ends_with(error_message(), ": cannot be opened: no such file: check the path"));
        assert_int_equal(strncmp(error_message(), "/pppp", 5), 0);
        for (size_t k = 0, left = strlen(error_message()); length % 2 == 1 && left > 0;) {
            size_t n = text_letter(error_message() + k, left);
            assert_true(n > 0); /* cut between letters */
            k += n, left -= n;
        }
        assert_int_equal(error_context("%s", path), -1);
        assert_true(ends_with(error_message(), ": cannot be opened: no such file: check the path"));
        assert_true(strlen(error_message()) < 1024);
        assert_int_equal(error_status(), EXIT_INPUT);
    }
    assert_int_equal(error_failed("%s", "short"), -1);
    assert_int_equal(error_context("%s", "a"), -1);
    assert_string_equal(error_message(), "a: short");
    error_clear();
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(long_paths)};
    return cmocka_run_group_tests_name("error", tests, NULL, NULL);
}
