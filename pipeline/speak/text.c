#include "pipeline/speak/text.h"

#include <stdlib.h>
#include <string.h>

size_t text_letter(const char *text, size_t left)
{
    const unsigned char *p = (const unsigned char *)text;
    size_t n = p[0] < 0x80 ? 1 : p[0] < 0xE0 ? 2 : p[0] < 0xF0 ? 3 : 4;
    if (n == 1)
        return 1;
    if (p[0] < 0xC2 || p[0] > 0xF4 || n > left)
        return 0;
    for (size_t k = 1; k < n; k++)
        if ((p[k] & 0xC0) != 0x80)
            return 0;
    if ((p[0] == 0xE0 && p[1] < 0xA0) || (p[0] == 0xED && p[1] > 0x9F) || (p[0] == 0xF0 && p[1] < 0x90) ||
        (p[0] == 0xF4 && p[1] > 0x8F))
        return 0;
    return n;
}

/* ---- for people ---- */

/* The next letter as it is shown, without '\0' at its end; *text moves on. 0 at the end. */
static size_t next_shown(const char **text, size_t *left, char letter[4])
{
    if (*left == 0)
        return 0;
    const unsigned char *p = (const unsigned char *)*text;
    size_t n = text_letter(*text, *left), used = n ? n : 1;
    int shown = n && !(p[0] < 0x20 || p[0] == 0x7F || (p[0] == 0xC2 && p[1] < 0xA0));
    memcpy(letter, shown ? *text : "?", shown ? n : 1);
    *text += used;
    *left -= used;
    return shown ? n : 1;
}

void text_clean(const char *text, char *room, size_t size)
{
    size_t left = strlen(text), length = 0, n;
    char letter[4];
    while ((n = next_shown(&text, &left, letter)) > 0 && length + n < size) {
        memcpy(room + length, letter, n);
        length += n;
    }
    room[length] = '\0';
}

void text_print(FILE *stream, const char *text)
{
    size_t left = strlen(text), n;
    char letter[4];
    while ((n = next_shown(&text, &left, letter)) > 0)
        fwrite(letter, 1, n, stream);
}

/* ---- exactly ---- */

char *text_escape(const char *name)
{
    size_t left = strlen(name);
    char *escaped = malloc(3 * left + 1), *to = escaped;
    while (escaped && left > 0) {
        size_t n = text_letter(name, left), used = n ? n : 1;
        if (n == 0 || *name == '%') {
            to += sprintf(to, "%%%02X", (unsigned)(unsigned char)*name);
        } else {
            memcpy(to, name, n);
            to += n;
        }
        name += used;
        left -= used;
    }
    if (escaped)
        *to = '\0';
    return escaped;
}

static int digit_of(char c)
{
    return c >= '0' && c <= '9' ? c - '0' : c >= 'A' && c <= 'F' ? c - 'A' + 10 : -1;
}

void text_unescape(char *name)
{
    char *to = name;
    for (const char *from = name; *from; to++) {
        int high = *from == '%' ? digit_of(from[1]) : -1, low = high < 0 ? -1 : digit_of(from[2]);
        *to = low < 0 ? *from : (char)(16 * high + low);
        from += low < 0 ? 1 : 3;
    }
    *to = '\0';
}
