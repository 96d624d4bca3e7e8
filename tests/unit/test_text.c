/* Text from outside: letters, what a terminal or a picture gets, names that come back exactly. */
#include "tests/check.h"

#include <stdlib.h>
#include <string.h>

#include "pipeline/speak/text.h"

/* Every code point by the table of RFC 3629, and what is none: each second byte, surrogates, overlong, cut. */
static void letters(void **unused)
{
    (void)unused;
    char text[4];
    for (unsigned long c = 0; c < 0x120000; c++) {
        size_t n = c < 0x80 ? 1 : c < 0x800 ? 2 : c < 0x10000 ? 3 : 4;
        if (n == 1)
            text[0] = (char)c;
        else
            text[0] = (char)(0xF00 >> n | c >> 6 * (n - 1));
        for (size_t k = 1; k < n; k++)
            text[k] = (char)(0x80 | (c >> 6 * (n - 1 - k) & 0x3F));
        int valid = c < 0xD800 || (c > 0xDFFF && c < 0x110000);
        assert_int_equal(text_letter(text, n), valid ? n : 0);
        if (n > 1)
            assert_int_equal(text_letter(text, n - 1), 0);
    }
    static const char *const none[] = {"\x80", "\xBF", "\xC0\x80", "\xC1\xBF", "\xE0\x9F\xBF", "\xF0\x8F\xBF\xBF",
                                       "\xFE", "\xFF", "\xC3("};
    for (size_t k = 0; k < sizeof none / sizeof *none; k++)
        assert_int_equal(text_letter(none[k], strlen(none[k])), 0);
}

static void check_clean(const char *text, size_t size, const char *expected)
{
    char room[100], *printed = NULL;
    size_t length;
    text_clean(text, room, size);
    assert_string_equal(room, expected);
    FILE *stream = open_memstream(&printed, &length);
    text_print(stream, text);
    fclose(stream);
    if (size == sizeof room)
        assert_string_equal(printed, expected);
    free(printed);
}

static void what_is_shown(void **unused)
{
    (void)unused;
    check_clean("a.tif é 日 😀", 100, "a.tif é 日 😀");
    check_clean("\x1B[31m\n\t\x7F", 100, "?[31m???");
    check_clean("\xC2\x9B"
                "31m\xC2\x80\xC2\xA0",
                100, "?31m?\xC2\xA0"); /* the last is a space that does not break */
    check_clean("\xE9.hdf\xE6\x97", 100, "?.hdf??");
    check_clean("éé", 4, "é"); /* cut after a whole letter */
    check_clean("éé", 5, "éé");
    check_clean("", 1, "");
}

static void names_come_back(void **unused)
{
    (void)unused;
    static const char *const pairs[][2] = {
        {"a é.tif", "a é.tif"}, {"\xE9.tif", "%E9.tif"}, {"%E9.tif", "%25E9.tif"}, {"100%", "100%25"}, {"", ""}};
    for (size_t k = 0; k < sizeof pairs / sizeof *pairs; k++) {
        char *escaped = text_escape(pairs[k][0]);
        assert_string_equal(escaped, pairs[k][1]);
        text_unescape(escaped);
        assert_string_equal(escaped, pairs[k][0]);
        free(escaped);
    }
    char old[] = "100%.tif %4"; /* a list of before there were escapes */
    text_unescape(old);
    assert_string_equal(old, "100%.tif %4");
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(letters), cmocka_unit_test(what_is_shown),
                                       cmocka_unit_test(names_come_back)};
    return cmocka_run_group_tests_name("text", tests, NULL, NULL);
}
