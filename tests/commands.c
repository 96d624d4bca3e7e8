#include "tests/commands.h"
#include "pipeline/files/json.h"

#include <ftw.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

enum { SAID = 1 << 16, LINE = 8192 };
char command_out[SAID], command_err[SAID];
static char folder[] = "/tmp/film_commands.XXXXXX";

/* ---- the folder ---- */

int folder_enter(void **state)
{
    (void)state;
    return mkdtemp(folder) && !chdir(folder) ? 0 : -1;
}

static int remove_one(const char *path, const struct stat *info, int kind, struct FTW *place)
{
    (void)info, (void)kind, (void)place;
    return remove(path);
}

int folder_leave(void **state)
{
    (void)state;
    return chdir("/") || nftw(folder, remove_one, 8, FTW_DEPTH | FTW_PHYS) ? -1 : 0;
}

/* ---- running ---- */

static void read_back(const char *path, char text[SAID])
{
    FILE *file = fopen(path, "r");
    assert_non_null(file);
    text[fread(text, 1, SAID - 1, file)] = '\0';
    fclose(file);
}

static int run_line(const char *format, va_list words)
{
    char line[LINE];
    int used = snprintf(line, sizeof line, "%s/bin/", FILM_BINARY_DIR);
    int more = vsnprintf(line + used, sizeof line - (size_t)used, format, words);
    used += more;
    assert_true(more > 0 && used < LINE - 40);
    strcpy(line + used, " </dev/null >.out 2>.err");
    int status = system(line);
    read_back(".out", command_out);
    read_back(".err", command_err);
    assert_true(WIFEXITED(status));
    return WEXITSTATUS(status);
}

int command_run(const char *format, ...)
{
    va_list words;
    va_start(words, format);
    int status = run_line(format, words);
    va_end(words);
    return status;
}

/* What went wrong, before the test fails. */
static void tell(int status, const char *format, va_list words)
{
    char line[LINE];
    vsnprintf(line, sizeof line, format, words);
    print_error("%s: status %d\n%s%s", line, status, command_out, command_err);
}

void command_done(const char *format, ...)
{
    va_list words;
    va_start(words, format);
    int status = run_line(format, words);
    va_end(words);
    int fine = !*command_err || (text_count(command_err, "\n") == 1 && command_err[strlen(command_err) - 1] == '\n' &&
                                 !strncmp(command_err, format, strcspn(format, " ")) && !strstr(format, "--quiet"));
    if (status || !fine) {
        va_start(words, format);
        tell(status, format, words);
        va_end(words);
    }
    assert_int_equal(status, 0);
    assert_true(fine);
}

void command_fails(int expected, const char *says, const char *format, ...)
{
    va_list words;
    va_start(words, format);
    int status = run_line(format, words);
    va_end(words);
    int one_line =
        expected == 2 || (text_count(command_err, "\n") == 1 && command_err[strlen(command_err) - 1] == '\n');
    int named = !strncmp(command_err, format, strcspn(format, " "));
    if (status != expected || *command_out || !strstr(command_err, says) || !one_line || !named) {
        va_start(words, format);
        tell(status, format, words);
        va_end(words);
        print_error("expected status %d and \"%s\"\n", expected, says);
        fail();
    }
}

/* ---- files ---- */

char *file_text(const char *path)
{
    FILE *file = fopen(path, "rb");
    if (!file)
        print_error("%s is not there\n", path);
    assert_non_null(file);
    fseek(file, 0, SEEK_END);
    size_t size = (size_t)ftell(file);
    rewind(file);
    char *text = malloc(size + 1);
    assert_non_null(text);
    assert_int_equal(fread(text, 1, size, file), size);
    text[size] = '\0';
    fclose(file);
    return text;
}

void file_write(const char *path, const char *text)
{
    FILE *file = fopen(path, "w");
    assert_non_null(file);
    assert_true(fputs(text, file) >= 0);
    assert_int_equal(fclose(file), 0);
}

int file_exists(const char *path)
{
    return access(path, F_OK) == 0;
}

size_t text_count(const char *text, const char *word)
{
    size_t count = 0;
    for (const char *at = text; (at = strstr(at, word)); at += strlen(word))
        count++;
    return count;
}

/* ---- JSON ---- */

cJSON *json_of(const char *path, const char *schema)
{
    char *text = file_text(path);
    cJSON *object = cJSON_Parse(text);
    assert_non_null(object);
    if (schema)
        assert_string_equal(json_text_at(object, "schema"), schema);
    free(text);
    return object;
}

static const cJSON *item_at(const cJSON *object, const char *format, va_list path)
{
    char words[200], *rest;
    assert_in_range(vsnprintf(words, sizeof words, format, path), 1, sizeof words - 1);
    for (char *word = strtok_r(words, ".", &rest); word && object; word = strtok_r(NULL, ".", &rest))
        object = cJSON_IsArray(object) ? cJSON_GetArrayItem(object, atoi(word))
                                       : cJSON_GetObjectItemCaseSensitive(object, word);
    return object;
}

double json_at(const cJSON *object, const char *format, ...)
{
    va_list path;
    va_start(path, format);
    const cJSON *item = item_at(object, format, path);
    va_end(path);
    return cJSON_IsNumber(item) ? item->valuedouble : NAN;
}

const char *json_text_at(const cJSON *object, const char *format, ...)
{
    va_list path;
    va_start(path, format);
    const cJSON *item = item_at(object, format, path);
    va_end(path);
    assert_true(cJSON_IsString(item));
    return item->valuestring;
}

int json_is(const cJSON *object, const char *format, ...)
{
    va_list path;
    va_start(path, format);
    const cJSON *item = item_at(object, format, path);
    va_end(path);
    assert_true(cJSON_IsBool(item));
    return cJSON_IsTrue(item);
}

/* ---- pictures ---- */

static uint32_t big_endian(const unsigned char *at)
{
    return (uint32_t)at[0] << 24 | (uint32_t)at[1] << 16 | (uint32_t)at[2] << 8 | at[3];
}

/* CRC-32 of the PNG specification (ISO 3309), bit by bit. */
static uint32_t checksum(const unsigned char *bytes, size_t count)
{
    uint32_t crc = 0xFFFFFFFFu;
    for (size_t k = 0; k < count; k++) {
        crc ^= bytes[k];
        for (int bit = 0; bit < 8; bit++)
            crc = crc & 1 ? crc >> 1 ^ 0xEDB88320u : crc >> 1;
    }
    return ~crc;
}

void check_png(const char *path, long width, long height)
{
    static const unsigned char begins[] = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1A, '\n'};
    FILE *file = fopen(path, "rb");
    unsigned char head[8], *chunk = NULL;
    int ended = 0;
    assert_non_null(file);
    assert_int_equal(fread(head, 1, 8, file), 8);
    assert_memory_equal(head, begins, 8);
    for (int k = 0; !ended; k++) {
        assert_int_equal(fread(head, 1, 4, file), 4);
        size_t length = big_endian(head), whole = length + 8; /* with name and checksum */
        chunk = realloc(chunk, whole);
        assert_non_null(chunk);
        assert_int_equal(fread(chunk, 1, whole, file), whole);
        assert_int_equal(checksum(chunk, length + 4), big_endian(chunk + length + 4));
        if (k == 0) {
            assert_memory_equal(chunk, "IHDR", 4);
            assert_true(width < 0 || width == (long)big_endian(chunk + 4));
            assert_true(height < 0 || height == (long)big_endian(chunk + 8));
        }
        ended = !memcmp(chunk, "IEND", 4);
    }
    assert_int_equal(fgetc(file), EOF);
    free(chunk);
    fclose(file);
}

char *check_svg(const char *path)
{
    char *text = file_text(path), *root = strstr(text, "<svg ");
    assert_non_null(root);
    assert_true(root == text || !strncmp(text, "<?xml", 5));
    assert_int_equal(text_count(text, "<text"), text_count(text, "</text>"));
    assert_int_equal(text_count(text, "<g>") + text_count(text, "<g "), text_count(text, "</g>"));
    const char *end = strstr(root, "</svg>");
    assert_non_null(end);
    assert_int_equal(strspn(end + 6, "\n"), strlen(end + 6));
    return text;
}

size_t svg_strokes(const char *svg, const char *colour, struct svg_stroke *strokes, size_t room)
{
    size_t count = 0;
    for (const char *at = svg; (at = strstr(at, "<path ")); at++) {
        char element[600] = "";
        size_t length = strcspn(at, ">");
        memcpy(element, at, length < sizeof element ? length : sizeof element - 1);
        const char *d = strstr(element, " d=\"M "), *width = strstr(element, "stroke-width");
        struct svg_stroke s;
        if (!d || !width || !strstr(element, colour) || strstr(d, " C ") ||
            sscanf(d, " d=\"M %lf %lf L %lf %lf", &s.x0, &s.y0, &s.x1, &s.y1) != 4)
            continue;
        s.width = strtod(width + strcspn(width, "0123456789"), NULL);
        assert_true(count < room);
        strokes[count++] = s;
    }
    return count;
}

size_t svg_fills(const char *svg, const char *colour, struct svg_point *points, size_t room)
{
    char begin[100];
    size_t count = 0;
    snprintf(begin, sizeof begin, "<path style=\" stroke:none;fill-rule:nonzero;fill:%s", colour);
    for (const char *at = svg; (at = strstr(at, begin)); at++) {
        const char *d = strstr(at, " d=\"M ");
        assert_true(d && count < room);
        assert_int_equal(sscanf(d, " d=\"M %lf %lf", &points[count].x, &points[count].y), 2);
        count++;
    }
    return count;
}
