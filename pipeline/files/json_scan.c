/* A recursive-descent parser of RFC 8259 that makes nothing: it moves a cursor over the text, refuses what is not
 * strict JSON, and notes where values stand. Each scan_...() begins with the cursor on the first byte of its piece
 * and leaves it behind the last; 0, or -1 with an error that has line and column. Depth is limited by
 * JSON_MAX_DEPTH, so the stack is. */
#include "pipeline/files/json_scan.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "pipeline/speak/error.h"
#include "pipeline/files/number.h"
#include "pipeline/speak/text.h"

enum { MAX_NUMBER_LENGTH = 60 }; /* cJSON cuts numbers at 63 characters without a word */

void json_line_column(const char *text, size_t offset, size_t *line, size_t *column)
{
    *line = *column = 1;
    for (size_t k = 0; k < offset; k++) {
        if (text[k] == '\n') {
            ++*line;
            *column = 1;
        } else if (((unsigned char)text[k] & 0xC0) != 0x80) {
            ++*column;
        }
    }
}

/* Always -1: the message at the line and column of `offset`. */
static int scan_error(const struct json_scan *scan, size_t offset, const char *message)
{
    size_t line, column;
    json_line_column(scan->text, offset, &line, &column);
    return error_input("%s:%zu:%zu: %s", scan->name, line, column, message);
}

/* The byte at the cursor, or -1 at the end. */
static int peek(const struct json_scan *scan)
{
    return scan->at < scan->length ? (unsigned char)scan->text[scan->at] : -1;
}

/* The four blanks of RFC 8259; no others, and no comments. */
static void skip_space(struct json_scan *scan)
{
    int c;
    while ((c = peek(scan)) == ' ' || c == '\t' || c == '\n' || c == '\r')
        scan->at++;
}

/* Four hexadecimal digits of \uXXXX at the cursor. */
static int scan_hex(struct json_scan *scan, unsigned *value)
{
    *value = 0;
    for (int k = 0; k < 4; k++) {
        int c = peek(scan), digit;
        if (c >= '0' && c <= '9')
            digit = c - '0';
        else if ((c | 0x20) >= 'a' && (c | 0x20) <= 'f')
            digit = (c | 0x20) - 'a' + 10;
        else
            return scan_error(scan, scan->at, "\\u needs four hexadecimal digits: write for example \\u00b5");
        *value = *value * 16 + (unsigned)digit;
        scan->at++;
    }
    return 0;
}

/* A backslash and what belongs to it. \u0000 is refused, since strings end with a zero in C; halves of surrogate
 * pairs are, since they are no character. */
static int scan_escape(struct json_scan *scan)
{
    size_t start = scan->at++;
    int c = peek(scan);
    if (c < 0)
        return scan_error(scan, start, "the text ends inside a string: close it with \"");
    scan->at++;
    if (c != 'u')
        return strchr("\"\\/bfnrt", c) && c ? 0 : scan_error(scan, start, "unknown escape: write \\\\ for a backslash");
    unsigned high, low = 0;
    if (scan_hex(scan, &high))
        return -1;
    if (high == 0)
        return scan_error(scan, start, "\\u0000 inside a string: leave it out");
    if (high < 0xD800 || high > 0xDFFF)
        return 0;
    if (high <= 0xDBFF && peek(scan) == '\\' && scan->at + 1 < scan->length && scan->text[scan->at + 1] == 'u') {
        scan->at += 2;
        if (scan_hex(scan, &low))
            return -1;
    }
    if (low < 0xDC00 || low > 0xDFFF)
        return scan_error(scan, start, "half of a surrogate pair: write the character itself in UTF-8");
    return 0;
}

/* A string with its quotes: UTF-8, no control characters, known escapes. */
static int scan_string(struct json_scan *scan)
{
    size_t start = scan->at++;
    for (;;) {
        int c = peek(scan);
        if (c < 0)
            return scan_error(scan, start, "the string does not end: close it with \"");
        if (c == '"') {
            scan->at++;
            return 0;
        }
        if (c < 0x20)
            return scan_error(scan, scan->at, "a line break or control character inside a string: close it with \"");
        if (c == '\\') {
            if (scan_escape(scan))
                return -1;
            continue;
        }
        size_t n = text_letter(scan->text + scan->at, scan->length - scan->at);
        if (n == 0)
            return scan_error(scan, scan->at, "not UTF-8: save the file in UTF-8");
        scan->at += n;
    }
}

/* How many decimal digits were passed. */
static size_t skip_digits(struct json_scan *scan)
{
    size_t start = scan->at;
    while (peek(scan) >= '0' && peek(scan) <= '9')
        scan->at++;
    return scan->at - start;
}

/* The stricter number of JSON: no leading zero, digits on both sides of the point. */
static int number_has_form(struct json_scan *scan)
{
    if (peek(scan) == '-')
        scan->at++;
    int zero = peek(scan) == '0';
    size_t digits = skip_digits(scan);
    if (digits == 0 || (zero && digits > 1))
        return 0;
    if (peek(scan) == '.') {
        scan->at++;
        if (skip_digits(scan) == 0)
            return 0;
    }
    if (peek(scan) == 'e' || peek(scan) == 'E') {
        scan->at++;
        if (peek(scan) == '+' || peek(scan) == '-')
            scan->at++;
        if (skip_digits(scan) == 0)
            return 0;
    }
    return 1;
}

/* A number of JSON's form, not longer than cJSON can take, and finite as a double. */
static int scan_number(struct json_scan *scan)
{
    char digits[MAX_NUMBER_LENGTH + 1];
    double value;
    size_t start = scan->at;
    if (!number_has_form(scan))
        return scan_error(scan, start, "not a JSON number: write for example 0.5, -2 or 1e-3");
    size_t length = scan->at - start;
    if (length > MAX_NUMBER_LENGTH)
        return scan_error(scan, start, "too many digits: 17 are enough");
    memcpy(digits, scan->text + start, length);
    digits[length] = '\0';
    if (number_parse(digits, &value))
        return scan_error(scan, start, "the number is not finite: give one below 1.7e308");
    return 0;
}

/* true, false or null. Whatever is no value of another kind ends here, too, with the error for it. */
static int scan_word(struct json_scan *scan)
{
    static const char *const words[] = {"true", "false", "null"};
    for (int k = 0; k < 3; k++) {
        size_t n = strlen(words[k]);
        if (scan->length - scan->at >= n && !memcmp(scan->text + scan->at, words[k], n)) {
            scan->at += n;
            return 0;
        }
    }
    if (scan->at == scan->length)
        return scan_error(scan, scan->at, "the text ends too early: is the file complete?");
    return scan_error(scan, scan->at, "not JSON: a value is a number, \"text\", true, false, null, [...] or {...}");
}

/* Note one value; the list doubles when it is full. -1 without memory. */
static int add_place(struct json_scan *scan, size_t key, size_t value)
{
    if (scan->count == scan->capacity) {
        size_t capacity = scan->capacity ? 2 * scan->capacity : 64;
        struct json_place *places = realloc(scan->places, capacity * sizeof *places);
        if (!places)
            return error_memory(scan->name);
        scan->places = places;
        scan->capacity = capacity;
    }
    scan->places[scan->count++] = (struct json_place){key, value};
    return 0;
}

static int scan_value(struct json_scan *scan, size_t key);

/* "key" : at the cursor; *key is its place. */
static int scan_key(struct json_scan *scan, size_t *key)
{
    skip_space(scan);
    *key = scan->at;
    if (peek(scan) != '"')
        return scan_error(scan, scan->at, "a \"key\" is expected here: is there a comma too many or a quote missing?");
    if (scan_string(scan))
        return -1;
    skip_space(scan);
    if (peek(scan) != ':')
        return scan_error(scan, scan->at, "':' is expected after a key: write \"key\": value");
    scan->at++;
    skip_space(scan);
    return 0;
}

/* The inside of [...] or {...}, the cursor on the opening bracket. */
static int scan_members(struct json_scan *scan, char close)
{
    size_t open = scan->at++;
    if (++scan->depth > JSON_MAX_DEPTH)
        return scan_error(scan, open, "more than 64 brackets inside each other: use fewer");
    skip_space(scan);
    for (int first = 1; peek(scan) != close || !first; first = 0) {
        skip_space(scan);
        size_t key = scan->at;
        if ((close == '}' && scan_key(scan, &key)) || scan_value(scan, close == '}' ? key : scan->at))
            return -1;
        skip_space(scan);
        if (peek(scan) == close)
            break;
        if (peek(scan) < 0)
            return scan_error(scan, open, "this bracket is not closed: is the file complete?");
        if (peek(scan) != ',')
            return scan_error(scan, scan->at, "',' is expected here: separate values by commas");
        scan->at++;
    }
    scan->at++;
    scan->depth--;
    return 0;
}

static int scan_value(struct json_scan *scan, size_t key)
{
    if (add_place(scan, key, scan->at))
        return -1;
    int c = peek(scan);
    if (c == '{')
        return scan_members(scan, '}');
    if (c == '[')
        return scan_members(scan, ']');
    if (c == '"')
        return scan_string(scan);
    if (c == '-' || (c >= '0' && c <= '9'))
        return scan_number(scan);
    return scan_word(scan);
}

int json_scan(struct json_scan *scan)
{
    if (scan->length >= 3 && !memcmp(scan->text, "\xEF\xBB\xBF", 3))
        return scan_error(scan, 0, "the file begins with a byte order mark: save it as UTF-8 without one");
    skip_space(scan);
    if (scan_value(scan, scan->at))
        return -1;
    skip_space(scan);
    if (scan->at < scan->length)
        return scan_error(scan, scan->at, "text after the end of the document: remove it");
    return 0;
}
