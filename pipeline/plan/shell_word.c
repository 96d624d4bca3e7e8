#include "pipeline/plan/shell_word.h"

#include <string.h>

static const char harmless[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789_.,+@/-";

void shell_word(FILE *stream, const char *text)
{
    if (*text && !text[strspn(text, harmless)]) {
        fputs(text, stream);
        return;
    }
    fputs("$'", stream);
    for (const unsigned char *c = (const unsigned char *)text; *c; c++)
        fprintf(stream, *c < 0x20 || *c == 0x7F || *c == '\'' || *c == '\\' ? "\\%03o" : "%c", *c);
    fputc('\'', stream);
}
