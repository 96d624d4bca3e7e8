/* Text is escaped so that it can stand between tags and inside attributes in either quotes; control characters, which
 * HTML forbids, are left out. A page is some MB: it is made in memory and written as one file. */
#include "report/page/html.h"

#include <math.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include "pipeline/speak/error.h"

int html_begin(struct html *html)
{
    memset(html, 0, sizeof *html);
    html->stream = open_memstream(&html->text, &html->length);
    return html->stream ? 0 : error_memory("a page");
}

int html_end(struct html *html)
{
    int failed = ferror(html->stream);
    failed |= fclose(html->stream) != 0;
    html->stream = NULL;
    return failed ? error_memory("a page") : 0;
}

void html_free(struct html *html)
{
    if (html->stream)
        fclose(html->stream);
    free(html->text);
    memset(html, 0, sizeof *html);
}

void html_text(struct html *html, const char *text)
{
    for (; *text; text++)
        switch (*text) {
        case '&':
            fputs("&amp;", html->stream);
            break;
        case '<':
            fputs("&lt;", html->stream);
            break;
        case '>':
            fputs("&gt;", html->stream);
            break;
        case '"':
            fputs("&quot;", html->stream);
            break;
        case '\'':
            fputs("&#39;", html->stream);
            break;
        default:
            if ((unsigned char)*text >= 0x20)
                fputc(*text, html->stream);
        }
}

void html_format(struct html *html, const char *format, ...)
{
    char text[1000];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    html_text(html, text);
}

void html_cell(struct html *html, const char *text)
{
    fputs("<td class=\"left\">", html->stream);
    html_text(html, text);
    fputs("</td>", html->stream);
}

void html_number(struct html *html, double value, int digits)
{
    if (isfinite(value))
        fprintf(html->stream, "<td>%.*g</td>", digits, value == 0 ? 0.0 : value); /* no "-0" */
    else
        fputs("<td>–</td>", html->stream);
}

/* RFC 4648: three bytes are four digits of 6 bits; "=" fills the last four. */
static void put_base64(FILE *stream, const unsigned char *bytes, size_t length)
{
    static const char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    for (size_t k = 0; k < length; k += 3) {
        size_t left = length - k;
        unsigned group = (unsigned)bytes[k] << 16 | (left > 1 ? (unsigned)bytes[k + 1] << 8 : 0) |
                         (left > 2 ? (unsigned)bytes[k + 2] : 0);
        fputc(digits[group >> 18], stream);
        fputc(digits[group >> 12 & 63], stream);
        fputc(left > 1 ? digits[group >> 6 & 63] : '=', stream);
        fputc(left > 2 ? digits[group & 63] : '=', stream);
    }
}

void html_picture(struct html *html, const char *media, const unsigned char *bytes, size_t length, const char *caption)
{
    fprintf(html->stream, "<figure><img alt=\"");
    html_text(html, caption);
    fprintf(html->stream, "\" src=\"data:%s;base64,", media);
    put_base64(html->stream, bytes, length);
    fputs("\"><figcaption>", html->stream);
    html_text(html, caption);
    fputs("</figcaption></figure>\n", html->stream);
}
