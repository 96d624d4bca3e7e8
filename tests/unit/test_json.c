/* Strict JSON: what is refused, where the complaint points, and that numbers survive printing. */
#include "tests/check.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "pipeline/speak/error.h"
#include "pipeline/files/json.h"

static struct json *parse(const char *text)
{
    return json_parse(text, strlen(text), "t.json");
}

/* The text is refused as bad input and the line contains `expected`. */
static void check_refused_bytes(const char *text, size_t length, const char *expected)
{
    error_clear();
    struct json *json = json_parse(text, length, "t.json");
    if (json || error_status() != EXIT_INPUT || !strstr(error_message(), expected))
        print_error("text: %s\nexpected: %s\nmessage: %s\n", text, expected, error_message());
    assert_null(json);
    assert_int_equal(error_status(), EXIT_INPUT);
    assert_non_null(strstr(error_message(), expected));
}

static void check_refused(const char *text, const char *expected)
{
    check_refused_bytes(text, strlen(text), expected);
}

static void refuses_what_cjson_lets_through(void **state)
{
    (void)state;
    check_refused("{\"a\": 1,\n \"a\": 2}", "t.json:2:2: the key 'a'");
    check_refused("{\"a\": 1, \"\\u0061\": 2}", "t.json:1:10: the key 'a'");
    check_refused("{\"b\": {\"x\": 1, \"y\": 2, \"x\": 3}}", "t.json:1:24: the key 'x'");
    check_refused("[1e999]", "t.json:1:2: the number is not finite");
    check_refused("[-1e400]", "t.json:1:2: the number is not finite");
    check_refused("[01]", "t.json:1:2: not a JSON number");
    check_refused("[-]", "t.json:1:2: not a JSON number");
    check_refused("[1.]", "not a JSON number");
    check_refused("[.5]", "t.json:1:2: not JSON");
    check_refused("[+1]", "t.json:1:2: not JSON");
    check_refused("[1e]", "not a JSON number");
    check_refused("[0x10]", "t.json:1:3: ','");
    check_refused("[NaN]", "t.json:1:2: not JSON");
    check_refused("[1.0000000000000000000000000000000000000000000000000000000000000001]", "too many digits");
    check_refused("{} x", "t.json:1:4: text after the end");
    check_refused("{}{}", "t.json:1:3: text after the end");
    check_refused("\xEF\xBB\xBF{}", "byte order mark");
}

static void refuses_broken_text(void **state)
{
    (void)state;
    check_refused("", "t.json:1:1: the text ends too early");
    check_refused("  \n ", "t.json:2:2: the text ends too early");
    check_refused("{\"a\": ", "too early");
    check_refused("{\"a\": 1", "t.json:1:1: this bracket is not closed");
    check_refused("[1, [2, 3]", "t.json:1:1: this bracket is not closed");
    check_refused("{\"a\": 1,}", "t.json:1:9: a \"key\" is expected");
    check_refused("[1,]", "t.json:1:4: not JSON");
    check_refused("[1 2]", "t.json:1:4: ','");
    check_refused("[1}", "t.json:1:3: ','");
    check_refused("{a: 1}", "t.json:1:2: a \"key\"");
    check_refused("{\"a\" 1}", "t.json:1:6: ':'");
    check_refused("{'a': 1}", "t.json:1:2: a \"key\"");
    check_refused("// comment\n{}", "t.json:1:1: not JSON");
    check_refused("[tru]", "t.json:1:2: not JSON");
    check_refused("[True]", "t.json:1:2: not JSON");
    check_refused("[\"abc]", "t.json:1:2: the string does not end");
    check_refused("[\"a\nb\"]", "t.json:1:4: a line break");
    check_refused("[\"\\q\"]", "t.json:1:3: unknown escape");
    check_refused("[\"\\u12\"]", "four hexadecimal digits");
    check_refused("[\"\\u0000\"]", "t.json:1:3: \\u0000");
    check_refused_bytes("[\"a\0b\"]", 7, "t.json:1:4: a line break or control character");
    check_refused_bytes("[1]\0", 4, "t.json:1:4: text after the end");
}

static void refuses_bad_utf8(void **state)
{
    (void)state;
    const char *const bad[] = {
        "\x80",             /* a continuation byte alone */
        "\xC3",             /* cut */
        "\xC0\xAF",         /* overlong '/' */
        "\xE0\x80\xAF",     /* overlong */
        "\xF0\x80\x80\xAF", /* overlong */
        "\xED\xA0\x80",     /* a surrogate in UTF-8 */
        "\xF4\x90\x80\x80", /* above U+10FFFF */
        "\xFF",
    };
    for (size_t k = 0; k < sizeof bad / sizeof *bad; k++) {
        char text[32];
        snprintf(text, sizeof text, "[\"a%s\"]", bad[k]);
        check_refused(text, "t.json:1:4: not UTF-8");
    }
    check_refused("[\"\\uD800\"]", "half of a surrogate pair");
    check_refused("[\"\\uDC00\"]", "half of a surrogate pair");
    check_refused("[\"\\uD800\\u0041\"]", "half of a surrogate pair");
    check_refused("[\"\\uD800x\"]", "half of a surrogate pair");
    struct json *json = parse("[\"\xC3\xA9 \xE2\x82\xAC \xF0\x9F\x98\x80\", \"\\uD83D\\uDE00 \\u00e9\"]");
    assert_non_null(json);
    assert_string_equal(cJSON_GetArrayItem(json_root(json), 0)->valuestring, "\xC3\xA9 \xE2\x82\xAC \xF0\x9F\x98\x80");
    assert_string_equal(cJSON_GetArrayItem(json_root(json), 1)->valuestring, "\xF0\x9F\x98\x80 \xC3\xA9");
    json_free(json);
}

static char *nested(int depth)
{
    char *text = calloc((size_t)depth * 2 + 1, 1);
    memset(text, '[', (size_t)depth);
    memset(text + depth, ']', (size_t)depth);
    return text;
}

static void depth_is_limited(void **state)
{
    (void)state;
    char *allowed = nested(JSON_MAX_DEPTH), *deeper = nested(JSON_MAX_DEPTH + 1), *bomb = nested(100000);
    struct json *json = parse(allowed);
    assert_non_null(json);
    json_free(json);
    check_refused(deeper, "t.json:1:65: more than 64 brackets");
    check_refused(bomb, "t.json:1:65: more than 64 brackets");
    free(allowed);
    free(deeper);
    free(bomb);
}

static void positions_of_items(void **state)
{
    (void)state;
    struct json *json = parse("{\"a\": [1, {\"b\": 2}],\n \"\xC3\xA9\": {}, \"c\": [[], 7,\n   8]}");
    assert_non_null(json);
    const cJSON *root = json_root(json), *c = cJSON_GetObjectItem(root, "c");
    const cJSON *b = cJSON_GetObjectItem(cJSON_GetArrayItem(cJSON_GetObjectItem(root, "a"), 1), "b");
    assert_int_equal(json_error(json, b, "%s", "here"), -1);
    assert_string_equal(error_message(), "t.json:1:17: here");
    json_error_set(json, c, "here");
    assert_string_equal(error_message(), "t.json:2:16: here"); /* the accented letter is one column */
    json_error_set(json, cJSON_GetArrayItem(c, 2), "here");
    assert_string_equal(error_message(), "t.json:3:4: here");
    json_error_set(json, root, "here");
    assert_string_equal(error_message(), "t.json:1:1: here");
    cJSON stranger = {0};
    json_error_set(json, &stranger, "here");
    assert_string_equal(error_message(), "t.json: here");
    assert_int_equal(error_status(), EXIT_INPUT);
    json_free(json);
}

static void unknown_keys_get_a_suggestion(void **state)
{
    (void)state;
    static const char *const keys[] = {"gravity_m_per_s2", "scale_m_per_px", "mu", NULL};
    struct json *json = parse("{\"mu\": 1,\n  \"graivty_m_per_s2\": 0}");
    assert_int_equal(json_check_keys(json, json_root(json), keys), -1);
    assert_string_equal(error_message(),
                        "t.json:2:3: unknown key 'graivty_m_per_s2': did you mean 'gravity_m_per_s2'?");
    json_free(json);
    json = parse("{\"scale\": 1}");
    assert_int_equal(json_check_keys(json, json_root(json), keys), -1);
    assert_non_null(strstr(error_message(), "did you mean 'scale_m_per_px'?"));
    json_free(json);
    json = parse("{\"Mu\": 1}"); /* the case of letters counts */
    assert_int_equal(json_check_keys(json, json_root(json), keys), -1);
    assert_non_null(strstr(error_message(), "did you mean 'mu'?"));
    json_free(json);
    json = parse("{\"temperature\": 1}");
    assert_int_equal(json_check_keys(json, json_root(json), keys), -1);
    assert_non_null(strstr(error_message(), "the keys here are: gravity_m_per_s2, scale_m_per_px, mu"));
    json_free(json);
    json = parse("[1]");
    assert_int_equal(json_check_keys(json, json_root(json), keys), -1);
    assert_string_equal(error_message(), "t.json:1:1: a group is expected here: write {\"key\": value}");
    json_free(json);
    json = parse("{\"mu\": 1}");
    check_done(json_check_keys(json, json_root(json), keys));
    json_free(json);
}

static void members_are_typed(void **state)
{
    (void)state;
    struct json *json =
        parse("{\"n\": 0.25, \"i\": 3, \"t\": true, \"s\": \"x\", \"v\": [1, 2], \"o\": {}, \"half\": 2.5, "
              "\"huge\": 1e300}");
    const cJSON *root = json_root(json), *item = NULL;
    static const char *const words[] = {"w", "x", NULL};
    double n = 7, v[2] = {0};
    long i = 7;
    int flag = 7, choice = 7;
    const char *s = NULL;
    assert_int_equal(json_number(json, root, "absent", 0, 1, &n), 0);
    check_near(n, 7, 0);
    assert_int_equal(json_number(json, root, "N", 0, 1, &n), 0); /* case counts */
    assert_int_equal(json_number(json, root, "n", 0, 1, &n), 1);
    check_near(n, 0.25, 0);
    assert_int_equal(json_number(json, root, "n", 0.5, 1, &n), -1);
    assert_string_equal(error_message(),
                        "t.json:1:7: 'n' must be a number in its range: give one of at least 0.5 and at most 1");
    assert_int_equal(json_number(json, root, "s", 0, 1, &n), -1);
    assert_int_equal(json_integer(json, root, "i", 0, 5, &i), 1);
    assert_int_equal(i, 3);
    assert_int_equal(json_integer(json, root, "i", 4, 5, &i), -1);
    assert_int_equal(json_integer(json, root, "half", 0, 5, &i), -1);
    assert_int_equal(json_integer(json, root, "huge", -9223372036854775807L, 9223372036854775807L, &i), -1);
    assert_int_equal(json_integer(json, root, "s", 0, 5, &i), -1);
    assert_int_equal(json_boolean(json, root, "t", &flag), 1);
    assert_int_equal(flag, 1);
    assert_int_equal(json_boolean(json, root, "i", &flag), -1);
    assert_int_equal(json_string(json, root, "s", &s), 1);
    assert_string_equal(s, "x");
    assert_int_equal(json_string(json, root, "i", &s), -1);
    assert_int_equal(json_numbers(json, root, "v", 2, v), 1);
    check_near(v[1], 2, 0);
    assert_int_equal(json_numbers(json, root, "v", 3, v), -1);
    assert_int_equal(json_numbers(json, root, "n", 1, v), -1);
    assert_int_equal(json_object(json, root, "o", &item), 1);
    assert_int_equal(json_object(json, root, "v", &item), -1);
    assert_int_equal(json_array(json, root, "v", &item), 1);
    assert_int_equal(json_array(json, root, "o", &item), -1);
    assert_int_equal(json_choice(json, root, "s", words, &choice), 1);
    assert_int_equal(choice, 1);
    assert_int_equal(json_choice(json, root, "n", words, &choice), -1);
    assert_non_null(strstr(error_message(), "give one of: w, x"));
    json_free(json);
}

/* 17 significant digits bring every double back (IEEE 754, binary64). */
static void printed_numbers_come_back(void **state)
{
    (void)state;
    double values[1000] = {0.1, 1.0 / 3, DBL_MIN, DBL_MAX, -DBL_MAX, 0x1p-1074, 123456789012345678.0, 6.0e-5};
    const size_t count = sizeof values / sizeof *values;
    uint64_t random = 1;
    for (size_t k = 8; k < count; k++)
        values[k] = ldexp(check_uniform(&random) - 0.5, (int)(check_uniform(&random) * 2000) - 1000);
    cJSON *list = cJSON_CreateArray();
    for (size_t k = 0; k < count; k++)
        cJSON_AddItemToArray(list, cJSON_CreateNumber(values[k]));
    char *text = json_print(list);
    assert_non_null(text);
    struct json *json = json_parse(text, strlen(text), "printed");
    assert_non_null(json);
    size_t k = 0;
    for (const cJSON *item = json_root(json)->child; item; item = item->next)
        assert_true(item->valuedouble == values[k++]);
    assert_int_equal(k, count);
    json_free(json);
    free(text);
    cJSON_Delete(list);
}

static void printing(void **state)
{
    (void)state;
    struct json *json = parse(" { \"a\" : [ 1 , -0.5, true , null ], \"\\u00e9\\n\\\"\" : { } } ");
    char *text = json_print(json_root(json));
    assert_string_equal(text, "{\"a\":[1,-0.5,true,null],\"\xC3\xA9\\u000a\\\"\":{}}");
    free(text);
    json_free(json);
    cJSON *infinite = cJSON_CreateNumber(INFINITY);
    assert_null(json_print(infinite));
    cJSON_Delete(infinite);
}

static void files(void **state)
{
    (void)state;
    error_clear();
    assert_null(json_read("no-such-folder/no-such-file.json"));
    assert_int_equal(error_status(), EXIT_INPUT);
    assert_non_null(strstr(error_message(), "no-such-folder/no-such-file.json: No such file"));
    assert_null(json_read("/"));
    assert_int_equal(error_status(), EXIT_INPUT);
    char name[] = "test_json_XXXXXX";
    int descriptor = mkstemp(name);
    assert_true(descriptor >= 0);
    FILE *file = fdopen(descriptor, "w");
    fputs("[", file);
    for (int k = 0; k < 20000; k++) /* longer than any buffer */
        fprintf(file, "%s%d", k ? "," : "", k);
    fputs("]", file);
    fclose(file);
    struct json *json = json_read(name);
    unlink(name);
    assert_non_null(json);
    assert_int_equal(cJSON_GetArraySize(json_root(json)), 20000);
    json_free(json);
    json_free(NULL);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(refuses_what_cjson_lets_through),
        cmocka_unit_test(refuses_broken_text),
        cmocka_unit_test(refuses_bad_utf8),
        cmocka_unit_test(depth_is_limited),
        cmocka_unit_test(positions_of_items),
        cmocka_unit_test(unknown_keys_get_a_suggestion),
        cmocka_unit_test(members_are_typed),
        cmocka_unit_test(printed_numbers_come_back),
        cmocka_unit_test(printing),
        cmocka_unit_test(files),
    };
    return cmocka_run_group_tests_name("json", tests, NULL, NULL);
}
